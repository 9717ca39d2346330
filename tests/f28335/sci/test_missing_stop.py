"""Where the search for a start bit goes on behind a missing stop bit.

Stop bits are drawn one column an SCICLK; columns 4, 5 and 6 are voted on.
"""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, levels


def words(head: str, stop_bit: str, options: dict[str, str | int | bool] | None = None, **fields: int) -> list[int]:
    """What the FIFO holds in the end. head: start to the last bit before the stop bit, as bits."""
    rig = SciRig(options, fifo=True, **fields)
    rig.send_samples("".join(mark * 8 for mark in levels(head)) + levels(stop_bit) + "1" * 120)
    assert rig.get("FE") == 1
    return rig.received(mask=0x80FF)


@pytest.mark.rule("SCI-121", "SCI-029")
@pytest.mark.parametrize(
    ("stop_bit", "second"),
    [
        ("11000000", [0xFF]),  # columns 3 to 6 are low: four, and the last one is the last that is voted on
        ("11000001", [0xFF]),
        ("11100000", []),  # three by then: this low is no start bit, however long it is
        ("11001000", []),
        ("01000001", [0xFF]),  # columns 6, 7 and 8 of the address bit, and one of the stop bit
        ("10010001", []),  # these three alone
        ("00000000", [0xFF]),  # low from there on: bit 0 of the second character lies behind the stop bit
        ("0000000000", [0xFE]),
    ],
)
def test_in_address_bit_mode_a_start_bit_found_before_the_vote_survives_it(stop_bit: str, second: list[int]):
    """The erratum's early search looks at samples from column 6 of the address bit on."""
    assert words("0 11010010 0", stop_bit, ADDRIDLE_MODE=1) == [0x804B, *second]


@pytest.mark.rule("SCI-029", "SCI-038")
@pytest.mark.parametrize("hunt", [6, 7, 8])
@pytest.mark.parametrize(
    ("stop_bit", "second"),
    [
        ("00000000 0000", (0, 0, 0)),  # never high: the low of the missing stop bit goes on
        ("11100000 0000", (0, 0, 0)),
        ("11100100 0001", (1, 1, 1)),  # high in column 6, low from 7 on: five samples, or four from column 8 on
        ("11100100 0011", (1, 1, 0)),
        ("11100100 0111", (0, 0, 0)),
        ("11100010 0001", (1, 1, 1)),  # high in column 7
        ("11100010 0011", (0, 0, 0)),
        ("11100001 0000", (1, 1, 1)),  # high in column 8
        ("11100001 0001", (0, 0, 0)),
    ],
)
def test_a_high_sample_behind_the_vote_makes_the_next_low_a_start_bit(
    hunt: int, stop_bit: str, second: tuple[int, int, int]
):
    got = words("0 11010010", stop_bit, {"start_hunt_point": hunt})
    assert got == [0x804B, *[0xFF] * second[hunt - 6]]
