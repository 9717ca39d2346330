"""The search for a start bit after a missing stop bit.

Stop bits are written with one column per SCICLK; the majority vote uses columns 4, 5 and 6.
"""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, levels


def words(head: str, stop_bit: str, options: dict[str, str | int | bool] | None = None, **fields: int) -> list[int]:
    """Return the words in the FIFO after a frame and an idle line.

    head: the bits of the frame before its stop bit.
    stop_bit: the samples of the stop bit and those after it.
    """
    rig = SciRig(options, fifo=True, **fields)
    rig.send_samples("".join(mark * 8 for mark in levels(head)) + levels(stop_bit) + "1" * 120)
    assert rig.get("FE") == 1
    return rig.received(mask=0x80FF)


@pytest.mark.rule("SCI-121", "SCI-029")
@pytest.mark.parametrize(
    ("stop_bit", "second"),
    [
        ("11000000", [0xFF]),  # columns 3 to 6 are low: four samples, of which the last is the last of the vote
        ("11000001", [0xFF]),
        ("11100000", []),  # only three low samples until the vote: this low is no start bit, however long it is
        ("11001000", []),
        ("01000001", [0xFF]),  # four low samples: columns 6, 7 and 8 of the address bit, and column 1 of the stop bit
        ("10010001", []),  # three low samples: columns 6, 7 and 8 of the address bit
        ("00000000", [0xFF]),  # the low goes on, but bit 0 of the second character is after this stop bit
        ("0000000000", [0xFE]),
    ],
)
def test_in_address_bit_mode_a_start_bit_detected_before_the_vote_is_accepted(stop_bit: str, second: list[int]):
    """The early search of the erratum begins with the sample in column 6 of the address bit."""
    assert words("0 11010010 0", stop_bit, ADDRIDLE_MODE=1) == [0x804B, *second]


@pytest.mark.rule("SCI-029", "SCI-038")
@pytest.mark.parametrize("hunt", [6, 7, 8])
@pytest.mark.parametrize(
    ("stop_bit", "second"),
    [
        ("00000000 0000", (0, 0, 0)),  # never high after the vote: the low of the missing stop bit continues
        ("11100000 0000", (0, 0, 0)),
        ("11100100 0001", (1, 1, 1)),  # high in column 6, low from column 7 on: five samples, or four from column 8 on
        ("11100100 0011", (1, 1, 0)),
        ("11100100 0111", (0, 0, 0)),
        ("11100010 0001", (1, 1, 1)),  # high in column 7
        ("11100010 0011", (0, 0, 0)),
        ("11100001 0000", (1, 1, 1)),  # high in column 8
        ("11100001 0001", (0, 0, 0)),
    ],
)
def test_after_a_high_sample_after_the_vote_the_next_low_is_a_start_bit(
    hunt: int, stop_bit: str, second: tuple[int, int, int]
):
    got = words("0 11010010", stop_bit, {"start_hunt_point": hunt})
    assert got == [0x804B, *[0xFF] * second[hunt - 6]]
