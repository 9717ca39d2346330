"""The margin of I2CDXR feels each cycle of the firmware: a write that is later has so much less, a later poll has not.

poll   |....|....|....|       every PASS cycles, counted from the write before
XRDY   ____|‾‾‾‾‾‾‾‾‾‾        by the bus, whenever the write before was made
write        w                next poll, and code: 0 to PASS - 1 cycles later than it might be
"""

from __future__ import annotations

from itertools import count

import pytest

from tests.scene.late_code import WRITE, cycle, kept, late

SDIR_PASS, PASS = 10, 17  # cycles of a pass of the waits: SDIR is one read, XRDY and SCD are two
BYTES, WRITES = 6, 7  # of a reply: XRDY asks for one byte more than the head reads
ROUND = "0.008"  # s: the first round and no more


def moved(cycles: int, number: int | None = None) -> list[int]:
    """By how many cycles the margin of each byte of a round moves, with so many before each write or before one."""
    writes = count()
    _, plain = late(WRITE, 0, seconds=ROUND)
    _, later = late(WRITE, cycles, seconds=ROUND, when=lambda: number in (None, next(writes)))
    length = cycle(plain)
    steps = [(b - a) / length for a, b in zip(kept(plain, MARGIN), kept(later, MARGIN), strict=True)]
    assert len(steps) == 3 * BYTES
    assert all(abs(step - round(step)) * length <= 1 for step in steps)  # whole cycles, to the tick
    return [round(step) for step in steps]


MARGIN = "I2CDXR margin"


@pytest.mark.parametrize("byte", range(BYTES))
@pytest.mark.parametrize("reply", range(3))
def test_twenty_cycles_before_one_write_move_its_margin_by_exactly_twenty(reply: int, byte: int):
    steps = moved(20, reply * WRITES + byte)
    place = reply * BYTES + byte
    assert steps[: place + 1] == [0] * place + [-20]
    assert all(abs(step) < PASS for step in steps[place + 1 :])  # polls of later waits begin at another phase


def test_twenty_cycles_before_each_write_move_each_by_twenty_and_by_what_its_poll_finds_sooner_or_later():
    """A poll finds its flag 0 to PASS - 1 cycles late, with the delay and without: so much may be between the two."""
    steps = moved(20)
    assert steps[0] == -20
    for place, step in enumerate(steps):
        found = -step - 20
        assert abs(found) < (PASS if place % BYTES else SDIR_PASS)


def test_what_a_poll_finds_sooner_or_later_follows_from_the_write_before():
    """Polls keep their distance to the write before, so what they move by differs from that by whole passes."""
    steps = moved(20)
    for reply in range(3):
        first, *others = steps[reply * BYTES : (reply + 1) * BYTES]
        for before, step in zip([first, *others], others, strict=False):
            assert (step + 20 - before) % PASS == 0


@pytest.mark.parametrize("passes", [1, 20])
def test_whole_passes_before_each_write_move_each_margin_by_exactly_so_much(passes: int):
    assert moved(passes * PASS) == [-passes * PASS] * 3 * BYTES
