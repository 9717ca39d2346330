"""The figures of docs/proof.md, on fewer rounds."""

from __future__ import annotations

import pytest

from tests.proof.dimensions import AFTER, BEFORE, Ran, far, gaps, ran
from tests.scene.runs import TIMING

SAME_CLOCKS = ("unit.dsp.ppm=0", "controller.ppm=0", "host.ppm=0", "host.error=0")
FIXED_COST = ("unit.dsp.settings.beyond_estimate=240 us",)
FAR = 5000  # cycles between the writes of a made-up round


def made(*entries: int, schedule: int = 0, phase: int = 3, end: int = 0) -> Ran:
    """A round with writes at 0, FAR and 2 * FAR + schedule."""
    return Ran(phase, entries, ((0, "W A"), (FAR, "W B"), (2 * FAR + schedule, "W A")), end)


@pytest.mark.parametrize("entry", [AFTER - 1, FAR - BEFORE + 1, FAR, FAR + AFTER - 1])
def test_a_request_beside_a_write_is_near(entry: int):
    assert far([made(entry)]).share == 100


@pytest.mark.parametrize("entry", [AFTER, FAR - BEFORE, FAR + AFTER, 3 * FAR])
def test_other_requests_are_far(entry: int):
    assert far([made(entry)]).share == 0


def test_equal_keys_with_other_schedules_contradict():
    """The second entry comes a whole number of passes later; the third is of another phase."""
    found = far([made(1000), made(1010, schedule=1), made(1010, schedule=2, phase=4)])
    assert (found.revisits, found.contradictions, found.schedules) == (1, 1, {2: 1, 1: 1})


def test_another_end_phase_contradicts():
    assert far([made(1000), made(1000, end=1)]).contradictions == 1


def test_gaps_are_counted_for_each_write():
    assert gaps([made(), made(schedule=1), made(schedule=1)]) == 3


def test_with_equal_clocks_the_schedule_follows_from_phase_and_segment():
    rounds = ran(TIMING / "imu_hil.toml", 400, 1, 1, [*SAME_CLOCKS, *FIXED_COST])
    found = far(rounds)
    assert len(rounds) == 400 and len({one.phase for one in rounds}) == 10
    assert found.revisits > 50 and found.contradictions == 0 and set(found.schedules) == {1}


def test_without_requests_and_with_equal_clocks_a_round_has_one_schedule_for_each_phase():
    rounds = ran(TIMING / "imu_hil.toml", 100, 0, 1, [*SAME_CLOCKS, *FIXED_COST])
    assert len({(one.phase, one.schedule) for one in rounds}) == len({one.phase for one in rounds}) == 10


def test_with_the_shipped_clocks_a_round_has_more_schedules():
    rounds = ran(TIMING / "imu_hil.toml", 100, 0, 1, FIXED_COST)
    assert len({one.schedule for one in rounds}) > 15
