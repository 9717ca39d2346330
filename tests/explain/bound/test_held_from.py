"""`bound` names the cycle from which SCL is held: with one less it never is, with one more it is at the worst phase.

SDIR      ___|‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾      set just behind a read of the wait: a pass is lost
CPU       |poll|poll|  service routine |code| delay |w
SCL       ‾|____________________________________________|==== held from here on
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.explain.bound.form_of_case import closed_form
from periph_sim.scene.case.load import load
from tests.explain.bound.cases import imu_hil
from tests.scene.late_code import WRITE, kept, late
from tests.scene.runs import TIMING

CASE = "imu_hil_400k"
READ = "0.00523"  # s: up to the STOP of the first read, which begins at 5 ms
FRAME = "4.0309 ms"  # the host's first: its service routine begins 1 us behind SDIR of that read
PASS = 10  # cycles, of the wait for SDIR
CYCLE = 20  # ticks, all but 30 ppm
TICK = Fraction(1, 3 * 10**9)


@pytest.fixture(scope="module")
def named() -> int:
    return closed_form(load(TIMING / f"{CASE}.toml", [])).held_from


def first_read(cycles: int, ticks: int) -> tuple[int, int]:
    """(margin of the first byte, how long SCL is held), in ticks, with the head so many ticks later."""
    first = (Fraction(5, 1000) + ticks * TICK) * 10**9
    changes = (f"controller.first={float(first):.4f} ns", f"host.first={FRAME}", "host.jitter=0 ms")
    _, scene = late(WRITE, cycles, CASE, READ, changes=changes)
    return kept(scene, "I2CDXR margin")[0], max(kept(scene, "stretch"))


@pytest.fixture(scope="module")
def worst() -> int:
    """Ticks by which the head is later where SDIR just misses a poll: from there to the next the margin only grows."""
    soonest, _ = first_read(0, 0)
    missed, found = PASS * CYCLE + 1, 0
    while missed - found > 1:
        between = (missed + found) // 2
        margin, _ = first_read(0, between)
        if margin - between > soonest - PASS * CYCLE // 2:
            found = between
        else:
            missed = between
    return missed


def test_one_cycle_less_than_bound_names_holds_scl_at_no_phase(named: int, worst: int):
    """Each cycle of a pass at its worst: within a cycle the margin grows until the next one samples the edge."""
    for cycles in range(PASS):
        margin, held = first_read(named - 1, worst + cycles * CYCLE)
        assert margin >= 0 and held == 0


def test_one_cycle_more_than_bound_names_holds_scl_at_the_worst_phase(named: int, worst: int):
    margin, held = first_read(named + 1, worst)
    assert margin < 0 and held == -margin < 2 * CYCLE


def test_a_delay_that_a_second_service_routine_fits_into_leaves_less_by_its_cost():
    """A head at 1 kHz leaves 1.5 ms for the first byte; frames of the host are 1.1 ms apart."""
    closed = closed_form(
        imu_hil("controller.rate=1 kHz", "controller.period=400 ms", "host.period=1.1 ms", frame_us=100)
    )
    left = closed.margin.ticks // CYCLE
    assert closed.held_from == 1 + left - closed.handlers.cost // CYCLE
