"""The delay from which the firmware of `imu_hil_400k` holds SCL, at the worst phase.

SDIR      ___|‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾      set just after a poll of the wait: a pass is lost
CPU       |poll|poll|  service routine |code| delay |w
SCL       ‾|____________________________________________|==== held from here on
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pytest

from tests.scene.late_code import WRITE, kept, late

CASE = "imu_hil_400k"
READ = "0.00523"  # s: up to the STOP of the first read, which begins at 5 ms
MOST = {  # longest delay of each write in cycles, by the time of the host's first frame
    "4.0309 ms": 350,  # its service routine begins 1 us after SDIR of that read
    "9 ms": 516,  # after the read
}
PASS = 10  # cycles, of the wait for SDIR
CYCLE = 20  # ticks, to within 30 ppm
TICK = Fraction(1, 3 * 10**9)


def first_read(frame: str, cycles: int, ticks: int) -> tuple[int, int]:
    """Return the margin of the first byte and how long SCL is held, in ticks. ticks: delay of the head's start."""
    first = (Fraction(5, 1000) + ticks * TICK) * 10**9
    changes = (f"controller.first={float(first):.4f} ns", f"host.first={frame}", "host.jitter=0 ms")
    _, scene = late(WRITE, cycles, CASE, READ, changes=changes)
    return kept(scene, "I2CDXR margin")[0], max(kept(scene, "stretch"))


@cache
def worst(frame: str) -> int:
    """Return the delay of the head, in ticks, at which SDIR just misses a poll; the margin grows until the next."""
    soonest, _ = first_read(frame, 0, 0)
    missed, found = PASS * CYCLE + 1, 0
    while missed - found > 1:
        between = (missed + found) // 2
        margin, _ = first_read(frame, 0, between)
        if margin - between > soonest - PASS * CYCLE // 2:
            found = between
        else:
            missed = between
    return missed


@pytest.mark.parametrize("frame", MOST)
def test_the_longest_allowed_delay_holds_scl_at_no_phase(frame: str):
    """Each cycle of a poll is at its worst: within a cycle the margin grows until the next one samples the edge."""
    for cycles in range(PASS):
        margin, held = first_read(frame, MOST[frame], worst(frame) + cycles * CYCLE)
        assert margin >= 0 and held == 0


@pytest.mark.parametrize("frame", MOST)
def test_a_cycle_more_leaves_a_tick_and_two_more_hold_scl_at_the_worst_phase(frame: str):
    assert first_read(frame, MOST[frame] + 1, worst(frame)) == (1, 0)
    margin, held = first_read(frame, MOST[frame] + 2, worst(frame))
    assert margin < 0 and held == -margin < 2 * CYCLE
