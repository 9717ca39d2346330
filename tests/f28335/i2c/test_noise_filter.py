"""The noise filter of SCL and SDA alone. Columns of diagrams are cycles; the filter is five cycles wide."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.core.options import BoolOption
from periph_sim.f28335.i2c.noise_filter import I2cNoiseFilter
from tests.waves import DiagramRig, play, tidy

WIDTH = 5
IN_ORDER = BoolOption("unequal_arrival", False)


class Rig(DiagramRig):
    """Rows: SCL, SDA are the pins; scl, sda the outputs; new is the number of changes of the outputs (last digit)."""

    def __init__(self, together: bool = False) -> None:
        self.touched: set[str] = set()
        self.filter = I2cNoiseFilter(BoolOption("unequal_arrival", together), self.touched)
        self.pins = 0b11
        self.changes = 0

    def drive(self, now: int, signal: str, level: int) -> None:
        bit = 1 << (signal == "SDA")
        self.pins = self.pins & ~bit | level * bit
        self.run_until(now - 1)
        self.filter.sample(now, self.pins, WIDTH, WIDTH)

    def run_until(self, time: int) -> None:
        while self.filter.due <= time:
            before, due = self.filter.levels, self.filter.due
            assert self.filter.apply_due(due) != before and self.filter.due > due
            self.changes += 1

    def show(self, signal: str) -> int:
        if signal == "new":
            return self.changes % 10
        return self.filter.levels >> (signal == "sda") & 1


def test_a_level_reaches_the_output_after_the_width_of_the_filter():
    Rig().check("""
        > SCL  1 0 . . . . . . . 1 . . . . . .
        < scl  1 . . . . . 0 . . . . . . . 1 .
        < new  0 . . . . . 1 . . . . . . . 2 .
    """)


def test_a_shorter_pulse_has_no_effect():
    Rig().check("""
        > SCL  1 0 . . . 1 . . 0 . . . . . . .
        > SDA  1 . . 0 . . . 1 . . . . . . . .
        < scl  1 . . . . . . . . . . . . 0 . .
        < sda  1 . . . . . . . . . . . . . . .
        < new  0 . . . . . . . . . . . . 1 . .
    """)


def test_edges_in_one_cycle_are_one_change_of_the_output():
    diagram = """
        > SCL  1 0 . . . . . . 1 . . . . . .
        > SDA  1 0 . . . . . . 1 . . . . . .
        < scl  1 . . . . . 0 . . . . . . 1 .
        < sda  1 . . . . . 0 . . . . . . 1 .
        < new  0 . . . . . 1 . . . . . . 2 .
    """
    rig = Rig()
    assert play(diagram, rig, 1) == tidy(diagram) and rig.touched == set()


UNEQUAL = {
    "in_order": """
        > SCL  1 . . 0 . . . . . . . . . . . . . .
        > SDA  1 0 . . . . . . . . 1 . . . . . . .
        < scl  1 . . . . . . . 0 . . . . . . . . .
        < sda  1 . . . . . 0 . . . . . . . . . . .
        < new  0 . . . . . 1 . 2 . . . . . . . . .
    """,
    "one_sample": """
        > SCL  1 . . 0 . . . . . . . . . . . . . .
        > SDA  1 0 . . . . . . . . 1 . . . . . . .
        < scl  1 . . . . . . . 0 . . . . . . . . .
        < sda  1 . . . . . . . 0 . . . . . . . . .
        < new  0 . . . . . . . 1 . . . . . . . . .
    """,
}


@pytest.mark.parametrize("answer", UNEQUAL)
def test_edges_less_than_a_module_clock_apart_depend_on_unequal_arrival(answer):
    rig = Rig(answer == "one_sample")
    assert play(UNEQUAL[answer], rig, 1) == tidy(UNEQUAL[answer]) and rig.touched == {"unequal_arrival"}


def test_a_change_of_sda_while_scl_is_low_is_applied_with_the_next_sample_or_change_of_scl():
    Rig().check("""
        > SCL  1 0 . . . . . . . . . 1 . . . . . .
        > SDA  1 . . 0 . . . . . 1 . . . . . . . .
        < scl  1 . . . . . 0 . . . . . . . . . 1 .
        < sda  1 . . . . . . . . 0 . . . . . . 1 .
        < new  0 . . . . . 1 . . . . . . . . . 2 .
    """)


@pytest.mark.parametrize("together", [False, True])
def test_edges_a_module_clock_apart_are_two_changes(together):
    diagram = """
        > SDA  1 0 . . . . . . . . . . .
        > SCL  1 . . . . . 0 . . . . . .
        < sda  1 . . . . . 0 . . . . . .
        < scl  1 . . . . . . . . . . 0 .
        < new  0 . . . . . 1 . . . . 2 .
    """
    rig = Rig(together)
    assert play(diagram, rig, 1) == tidy(diagram) and rig.touched == set()


@given(st.lists(st.tuples(st.integers(1, 9), st.integers(0, 3)), max_size=30), st.booleans(), st.integers(0, 99))
def test_the_last_levels_given_for_a_cycle_are_its_sample(steps, together, seed):
    """Earlier levels for the same cycle have no effect."""
    chance = random.Random(seed)
    answer = BoolOption("unequal_arrival", together)
    once, often = I2cNoiseFilter(answer, set()), I2cNoiseFilter(answer, set())
    now = 0
    for gap, pins in steps:
        now += gap
        while once.due <= now:
            due = once.due
            assert often.due == due and once.apply_due(due) == often.apply_due(due)
        for wrong in chance.choices(range(4), k=3):
            often.sample(now, wrong, WIDTH, WIDTH)
        often.sample(now, pins, WIDTH, WIDTH)
        once.sample(now, pins, WIDTH, WIDTH)
        assert often.due == once.due


@given(st.lists(st.tuples(st.integers(1, 9), st.integers(0, 3)), max_size=30))
def test_the_filter_equals_one_that_samples_every_cycle(steps):
    """An output changes when its pin has had the other level in five consecutive samples."""
    lazy, pins, levels, run = I2cNoiseFilter(IN_ORDER, set()), 0b11, 0b11, [0, 0]
    given = {sum(gap for gap, _ in steps[: n + 1]): level for n, (_, level) in enumerate(steps)}
    for cycle in range(max(given, default=0) + 20):
        for line in (0, 1):
            if run[line] == WIDTH:
                levels ^= 1 << line
        pins = given.get(cycle, pins)
        for line in (0, 1):
            run[line] = run[line] % WIDTH + 1 if (pins ^ levels) >> line & 1 else 0
        if lazy.due <= cycle:
            lazy.apply_due(cycle)
        if cycle in given:
            lazy.sample(cycle, pins, WIDTH, WIDTH)
        scl = levels & 1
        assert lazy.levels & 1 == scl and lazy.due > cycle
        assert lazy.levels == levels or not scl  # a change of SDA while SCL is low may be applied later


def test_constant_lines_request_no_wake_up():
    lines = I2cNoiseFilter(IN_ORDER, set())
    lines.sample(0, 0b00, WIDTH, WIDTH)
    lines.settle(0b10)
    assert (lines.levels, lines.due) == (0b10, NEVER)
