"""Occurrences paired: one that is shifted, dropped, added or swapped is seen as what it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.reports.level_choice.moments import Label
from periph_sim.reports.level_choice.pairing import disordered, pair, pair_moments

A, B, ELSEWHERE = Label("dsp.I2C-A flag", "I2CSTR.XRDY", 1), Label("dsp.I2C-A flag", "I2CSTR.AAS", 1), Label("bus", "x")
Moments = dict[Label, np.ndarray]


def at(*ticks: int) -> np.ndarray:
    return np.array(ticks, np.int64)


MOMENTS = st.lists(st.integers(0, 10**15), min_size=2, max_size=40, unique=True).map(sorted).map(lambda t: at(*t))
RUN = st.tuples(MOMENTS, MOMENTS).map(lambda both: {A: both[0], B: both[1]})


@given(RUN)
def test_a_run_is_equal_to_itself(run: Moments):
    for paired in pair_moments(run, run).values():
        assert not paired.differences.any() and paired.unpaired == 0 and not paired.disordered


@given(RUN, st.integers(-(10**9), 10**9))
def test_all_shifted_alike_are_off_by_just_that(run: Moments, shift: int):
    for label, paired in pair_moments(run, {each: ticks + shift for each, ticks in run.items()}).items():
        assert (
            paired.differences.tolist() == [shift] * len(run[label]) and paired.unpaired == 0 and not paired.disordered
        )


@given(MOMENTS, st.data())
def test_one_shifted_within_its_neighbours_is_the_only_one_that_is_off(ticks: np.ndarray, data: st.DataObject):
    place = data.draw(st.integers(0, len(ticks) - 1))
    end = ticks[place + 1] if place + 1 < len(ticks) else ticks[place] + 100
    late = data.draw(st.integers(0, int(end - ticks[place])))
    moved = ticks.copy()
    moved[place] += late
    paired = pair_moments({A: ticks}, {A: moved})[A]
    assert paired.differences.tolist() == [late if n == place else 0 for n in range(len(ticks))]
    assert paired.unpaired == 0 and not paired.disordered


@given(RUN, st.data())
def test_a_dropped_one_is_lacking_and_the_other_labels_stay_exact(run: Moments, data: st.DataObject):
    place = data.draw(st.integers(0, len(run[A]) - 1))
    found = pair_moments(run, {A: np.delete(run[A], place), B: run[B]})
    assert (found[A].unpaired, found[A].disordered) == (1, False)
    assert found[B].unpaired == 0 and not found[B].disordered and not found[B].differences.any()


@given(RUN, st.integers(0, 10**15))
def test_an_added_one_is_added_and_the_other_labels_stay_exact(run: Moments, tick: int):
    found = pair_moments(run, {A: np.sort(np.append(run[A], tick)), B: run[B]})
    assert (found[A].unpaired, found[A].disordered) == (1, False)
    assert found[B].unpaired == 0 and not found[B].disordered and not found[B].differences.any()


@given(st.lists(st.integers(1, 1000), min_size=4, max_size=60), st.data())
def test_two_neighbours_that_change_places_are_out_of_order(steps: list[int], data: st.DataObject):
    ticks = np.cumsum(at(*steps))
    place = data.draw(st.integers(0, len(ticks) - 2))
    swapped = ticks.copy()
    swapped[[place, place + 1]] = ticks[[place + 1, place]]
    run = {Label("dsp.I2C-A flag", f"flag {n}", 1): ticks[n : n + 1] for n in range(len(ticks))}
    level = {Label("dsp.I2C-A flag", f"flag {n}", 1): swapped[n : n + 1] for n in range(len(ticks))}
    found = pair_moments(run, level)
    assert [n for n in range(len(ticks)) if found[Label("dsp.I2C-A flag", f"flag {n}", 1)].disordered] == [
        place,
        place + 1,
    ]


def test_of_a_label_that_is_in_one_run_alone_all_are_lacking_or_added():
    found = pair_moments({A: at(1, 2)}, {B: at(3)})
    assert (found[A].unpaired, found[B].unpaired) == (2, 1)


def test_order_counts_within_a_stream_only():
    found = pair_moments({A: at(10), ELSEWHERE: at(20)}, {A: at(30), ELSEWHERE: at(20)})
    assert found[A].differences.tolist() == [20] and not found[A].disordered


def test_what_came_together_in_one_run_has_no_order_there():
    assert not len(disordered(at(10, 10, 20), at(12, 11, 12)))


@pytest.mark.parametrize(
    ("after", "out"),
    [
        ((1, 2, 3, 4), []),
        ((4, 3, 2, 1), [0, 1, 2, 3]),
        ((4, 1, 2, 3), [0, 1]),
        ((2, 1, 4, 3), [0, 1, 2, 3]),
    ],
)
def test_neighbours_that_change_places_are_out_of_order(after: tuple[int, ...], out: list[int]):
    assert disordered(at(1, 2, 3, 4), at(*after)).tolist() == out


def test_differences_are_level_less_reference():
    paired = pair(at(10, 20, 30), at(11, 18))
    assert paired.differences.tolist() == [1, -2]
    assert paired.unpaired == 1
