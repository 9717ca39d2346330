"""Windows of failures, found with runs of many phases; both ends are exact to the phase.

phases    0 1 2 3 4 5 6 7 8 9
failures        x x x             window 3 to 5
late              x x x           noticed a period later
stays           x x x x x x x     a hang; runs of single phases find the end
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import cast

from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.interfaces.reports.coverage import PART
from periph_sim.proof.cover import (
    APART,
    Covered,
    Coverer,
    Window,
    Worst,
    _first_true,
    _merged,
    joined_at_end,
    nothing,
    windows_of,
)
from periph_sim.proof.near import parts_of
from periph_sim.proof.phases import REPEATED
from periph_sim.proof.stretch import CoveredCase, Outcome
from periph_sim.timing.verdict import Verdict

COUNT = 300
Ranges = Sequence[tuple[int, int]]
Rule = Callable[[list[int]], bool]  # True if a run with these phases, one in each period, fails


def within(ranges: Ranges, phase: int) -> bool:
    return any(first <= phase <= last for first, last in ranges)


def at_once(ranges: Ranges, later: int = 0) -> Rule:
    """Return a rule by which a failure is noticed `later` periods after the period of its phase."""
    return lambda phases: any(within(ranges, phase) for phase in phases[: len(phases) - later])


class FakeEngine:
    """A case whose failures follow from rules. rules: a dictionary from the names of failures to rules."""

    class phases:
        is_one_a_run = False

    def __init__(self, **rules: Rule) -> None:
        self.rules = rules
        self.runs = 0
        self.ran: list[tuple[int, ...]] = []

    def run(self, phases: Sequence[int], seed: int) -> Outcome:
        self.runs += 1
        self.ran.append(tuple(phases))
        whole = [*phases, *[phases[-1]] * REPEATED]
        verdicts = tuple(verdict(name, -1 if fails(whole) else 1) for name, fails in self.rules.items())
        return Outcome(verdicts, frozenset(one.name for one in verdicts if one.broken))


def verdict(name: str, margin: float | None, word: str | None = None) -> Verdict:
    result = word or ("not judged" if margin is None else "fail" if margin < 0 else "pass")
    return Verdict(name, name, "us", margin, 0, margin, 1, result, 0.0)  # type: ignore[arg-type]


def covered(engine: FakeEngine, phases: Iterable[int] = range(COUNT), part: int = PART) -> tuple[Covered, list[Window]]:
    """Cover phases in parts, as worker processes do, and find the windows."""
    chosen, case = [*phases], cast(CoveredCase, engine)
    found = nothing()
    for each in parts_of(chosen, part):
        found.add(Coverer(case, 0).cover(each))
    assert found.runs == engine.runs
    windows = windows_of(found, Coverer(case, 0, found).status, (chosen[0], chosen[-1]))
    return found, windows


def ends(windows: Iterable[Window]) -> list[tuple[int, int]]:
    return [(one.first, one.last) for one in windows]


@st.composite
def far_ranges(draw: st.DrawFn) -> list[tuple[int, int]]:
    """Ranges of phases that are at least APART from each other."""
    found, place = [], 0
    for gap, width in draw(st.lists(st.tuples(st.integers(0, 60), st.integers(1, 60)), max_size=4)):
        first, last = place + gap, place + gap + width - 1
        if last < COUNT:
            found.append((first, last))
        place = last + 1 + APART
    return found


@settings(max_examples=150)
@given(far_ranges(), st.integers(0, 2), st.sampled_from([7, 64, PART]))
def test_every_window_is_found_to_the_phase_and_the_rest_holds(
    ranges: list[tuple[int, int]], later: int, part: int
) -> None:
    found, windows = covered(FakeEngine(late=at_once(ranges, later)), part=part)
    assert ends(windows) == ranges
    assert not found.drifting
    failing = {phase for first, last in ranges for phase in range(first, last + 1)}
    assert failing.isdisjoint(found.held)
    assert failing | set(found.held) | found.failed.keys() == set(range(COUNT))


@settings(max_examples=60)
@given(far_ranges(), far_ranges())
def test_windows_of_two_failures_may_overlap(one: list[tuple[int, int]], two: list[tuple[int, int]]) -> None:
    """Each phase outside the windows holds, though only one of APART phases within a window is run."""
    found, windows = covered(FakeEngine(one=at_once(one), two=at_once(two)))
    for window in windows:
        ranges = one if window.name == "one" else two
        assert within(ranges, window.first) and within(ranges, window.last)
        assert all(not within(ranges, end) for end in (window.first - 1, window.last + 1))
    assert not any(within([*one, *two], phase) for phase in found.held)


def test_the_neighbours_of_a_closed_window_were_run_alone() -> None:
    engine = FakeEngine(late=at_once([(100, 120)]))
    _, windows = covered(engine, range(0, COUNT, 7))
    assert [(one.first, one.last, one.is_closed) for one in windows] == [(100, 120, True)]
    assert {(99,), (100,), (120,), (121,)} <= set(engine.ran)


def test_windows_at_the_bounds_are_not_closed() -> None:
    _, windows = covered(FakeEngine(late=at_once([(0, 30), (290, 400)])))
    assert [(one.first, one.last, one.is_closed) for one in windows] == [(0, 30, False), (290, 299, False)]


def test_windows_that_are_one_phase_apart_are_not_joined() -> None:
    """The phase between them is run, because it lies APART phases after the first failure."""
    found, windows = covered(FakeEngine(late=at_once([(50, 65), (67, 90)])))
    assert ends(windows) == [(50, 65), (67, 90)]
    assert 66 in found.held or found.failed[66] == frozenset()


def test_a_window_in_several_parts_is_joined() -> None:
    found, windows = covered(FakeEngine(late=at_once([(20, 200)])), part=32)
    assert ends(windows) == [(20, 200)]
    assert windows[0].run == sum(bool(failures) for failures in found.failed.values()) >= (200 - 20) // APART


def test_failures_that_occur_only_with_drifting_phases_are_reported_with_their_run() -> None:
    """A run fails from its fourth different phase on, but never with only one phase."""
    engine = FakeEngine(tired=lambda phases: len(set(phases)) > 3)
    found, windows = covered(engine, range(10))
    assert windows == []
    assert [(one.names, one.first, one.last) for one in found.drifting] == [
        (frozenset({"tired"}), 0, 3),
        (frozenset({"tired"}), 4, 7),
    ]
    assert found.held == [0, 1, 2, 4, 5, 6, 8, 9]
    assert found.worst["tired"].phases == (0, 1, 2, 3)


def test_a_window_grows_by_phases_that_held_only_while_the_phase_increased() -> None:
    """A phase that fails only if it comes three times in a row holds in a run of many phases."""

    def repeated(phases: list[int]) -> bool:
        pairs = zip(phases, phases[1:], phases[2:], strict=False)
        return any(one == two == three and 20 <= one <= 56 for one, two, three in pairs)

    found, windows = covered(FakeEngine(still=repeated), range(100), part=50)
    assert 50 in found.held  # in the run of the second part
    assert [(one.first, one.last, one.is_closed) for one in windows] == [(20, 56, True)]


def test_a_budget_that_no_run_judges_has_no_judged_run() -> None:
    class Silent(FakeEngine):
        def run(self, phases: Sequence[int], seed: int) -> Outcome:
            self.runs += 1
            return Outcome((verdict("x", None),), frozenset())

    found, _ = covered(Silent())
    assert found.judged == {"x": 0}


@given(st.permutations([None, 3.0, 1.0, -2.0, -1.0]))
def test_the_worst_value_does_not_depend_on_the_order(margins: list[float | None]) -> None:
    found = nothing()
    for margin in margins:
        found.judge(Worst(verdict("x", margin), (1, 2), 0))
    assert found.worst["x"].verdict.margin == -2


def test_of_equal_values_the_shortest_run_is_kept() -> None:
    found = nothing()
    for phases in ((1, 2, 3), (2,), (4, 5)):
        found.judge(Worst(verdict("x", 1.0), phases, 0))
    assert found.worst["x"].phases == (2,)


@given(st.integers(0, 50), st.integers(0, 50), st.integers(0, 60))
def test_the_least_number_is_found(low: int, more: int, true_from: int) -> None:
    high = low + more
    assert _first_true(lambda number: number >= true_from or number == high, low, high) == min(
        max(low, true_from), high
    )


def window(name: str, first: int, last: int) -> Window:
    return Window(name, first, last, 1, is_closed=False)


@given(st.integers(1, 40), st.integers(1, 40), st.booleans(), st.booleans())
def test_windows_at_both_ends_of_the_period_are_joined(begin: int, end: int, has_begin: bool, has_end: bool) -> None:
    """The neighbours of an end of the period are at the other end."""
    ranges = [(0, begin - 1)] * has_begin + [(COUNT - end, COUNT - 1)] * has_end

    def status(phase: int) -> frozenset[str]:
        return frozenset({"x"} if within(ranges, phase) else ())

    other = window("y", 0, 5)
    found = joined_at_end([*(window("x", *one) for one in ranges), other], COUNT, status)
    mine = [one for one in found if one.name == "x"]
    if has_begin and has_end:
        assert [(one.first, one.last, one.run, one.is_closed) for one in mine] == [(COUNT - end, begin - 1, 2, True)]
    else:
        assert [(one.first, one.last, one.is_closed) for one in mine] == [(*one, True) for one in ranges]
    assert [(one.first, one.last) for one in found if one.name == "y"] == [(0, 5)]


def test_a_window_of_the_whole_period_has_no_neighbours() -> None:
    whole = [window("x", 0, COUNT - 1)]
    assert joined_at_end(whole, COUNT, lambda phase: frozenset({"x"})) == whole


@given(st.sets(st.integers(0, 40)), st.sets(st.integers(0, 40)), st.integers(0, 41))
def test_windows_of_known_phases_end_beside_phases_that_hold(held: set[int], failed: set[int], first: int) -> None:
    """Some phases of a random set fail and were run. The windows agree with all that was run."""
    fails = set(range(first, 41)) | failed
    status: dict[int, frozenset[str]] = {phase: frozenset({"x"}) for phase in failed}
    found = nothing()
    found.failed, found.held = status, sorted(held - fails)

    def run(phase: int) -> frozenset[str]:
        found.failed[phase] = frozenset({"x"} if phase in fails else ())
        return found.failed[phase]

    for one in windows_of(found, run, (0, 40)):
        assert {one.first, one.last} <= fails
        assert one.is_closed == (one.first > 0 and one.last < 40)
        assert fails.isdisjoint({one.first - 1, one.last + 1} & set(range(41)))


def test_windows_that_overlap_are_joined_although_a_phase_in_them_held_while_the_phase_increased() -> None:
    """1: fails alone, h: held in a run in which the phase increases. Two groups extend to the same window.

    phase    10 11 12 13 14 15
             .  1  h  1  1  .
    """
    found = nothing()
    found.held = [10, 12, 15]
    found.failed = {11: frozenset({"late"}), 13: frozenset({"late"}), 14: frozenset({"late"})}

    def alone(phase: int) -> frozenset[str]:
        names = frozenset({"late"} if 11 <= phase <= 14 else ())
        found.failed[phase] = names
        return names

    (window,) = windows_of(found, alone, (0, 20))
    assert (window.first, window.last, window.is_closed) == (11, 14, True)


def test_of_windows_that_overlap_the_farthest_ends_count() -> None:
    windows = [Window("late", 3, 9, 4, True), Window("late", 5, 7, 2, True), Window("soon", 5, 7, 2, True)]
    windows.append(Window("soon", 6, 8, 1, False))
    assert _merged(windows) == [Window("late", 3, 9, 4, True), Window("soon", 5, 8, 2, False)]
