"""The free phase of a case: which starts move, when they are due, and which cases have none."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim import BadCase, load, make_case
from periph_sim.proof.phases import REPEATED, WARM_UP, Phases
from periph_sim.scene.case.model import Case
from periph_sim.scene.plan import ScenePlan
from tests.proof.scenes import MS, listener
from tests.scene.runs import TIMING

UNIT = {"dsp": {"firmware": "responder", "modules": ["I2C-A", "SCI-A"]}}
REQUEST = {"request": [{"address": 0x20, "count": 1}]}
SEND = {"send": [{"to": "dsp.SCI-A", "text": "?", "at": "1 ms"}]}


def case(**tables: Any) -> Case:
    return make_case(name="x", duration="40 ms", **{"unit": UNIT, **tables})


def phases(**tables: Any) -> Phases:
    return Phases(ScenePlan(case(**tables)))


def test_with_host_and_controller_the_frames_move_in_the_rounds() -> None:
    found = phases(host={"first": "1 ms"}, controller={**REQUEST, "first": "7 ms"})
    assert (found.moved, found.is_relative, found.count) == ("frames", True, 3_000_000)
    inputs, end = found.inputs([0, 2])
    first = 7 * MS + WARM_UP * 20 * MS
    assert inputs.frames is not None
    assert inputs.frames[:2] == (first, first + 20 * MS + Fraction(2, 150_000_000))
    assert len(inputs.frames) == 2 + REPEATED
    assert end == inputs.frames[-1] + 20 * MS - Fraction(1, 3_000_000_000)


def test_with_host_or_controller_alone_its_starts_move_from_their_times_in_the_case() -> None:
    rounds = phases(controller={**REQUEST, "first": "7 ms"}).inputs([0])[0].rounds
    frames = phases(host={"first": "7 ms"}).inputs([0])[0].frames
    assert rounds is not None and frames is not None
    assert rounds[0] == frames[0] == 7 * MS + WARM_UP * 20 * MS


@pytest.mark.parametrize(("jitter", "ticks"), [("0 us", 0), ("1 us", 3000), ("1.365 us", 2**12 - 1)])
def test_delays_are_those_that_the_sensor_head_draws(jitter: str, ticks: int) -> None:
    found = phases(controller={**REQUEST, "jitter": jitter})
    random = Random(7)
    assert found.delays(7, 100) == [random.randrange(ticks + 1) for _ in range(100)]


def test_sends_are_later_by_the_phase() -> None:
    found = phases(serial=SEND)
    inputs, end = found.inputs([150])
    assert (found.moved, found.is_one_a_run, found.count) == ("sends", True, 150_000)
    assert (inputs.sends_later, end) == (MS / 1000, 40 * MS + MS / 1000)


def test_frames_with_a_longer_period_than_the_rounds_come_in_every_kth_round() -> None:
    """imu_hil_c: a frame of 1.04 ms each 20 ms, and a round each millisecond."""
    found = Phases(ScenePlan(load(TIMING / "imu_hil_c.toml")))
    starts = found.starts([0, 0, 0])
    assert [round((two - one) / found.cycle / 150_000, 2) for one, two in pairwise(starts)] == [20, 20]


def test_frames_whose_period_differs_by_the_drift_of_a_clock_come_in_every_round() -> None:
    found = Phases(ScenePlan(load(TIMING / "imu_hil_drift.toml")))
    one, two = found.starts([0, 0])
    assert (two - one) // found.cycle == 3_000_000


def test_the_first_moved_start_is_after_the_first_judged_time_and_the_first_frame() -> None:
    late = {"name": "age", "measure": "age", "max": "1 s", "after": "150 ms"}
    tables: dict[str, Any] = {"controller": {**REQUEST, "first": "5 ms"}, "host": {}}
    for more in ({"budget": [late]}, {"host": {"first": "150 ms"}}):
        found = phases(**{**tables, **more})
        assert found.due(0) >= 150 * MS * 3_000_000_000 > found.due(0) - found.cycle * found.count


def test_units_with_different_clocks_count_in_cycles_of_the_fastest() -> None:
    case = load(TIMING / "two_dsps.toml")
    slow, fast = case.unit
    for clocks in ({slow: 6}, {fast: 6}):
        changed = load(TIMING / "two_dsps.toml", [f"unit.{unit}.pll={pll}" for unit, pll in clocks.items()])
        found = Phases(ScenePlan(changed))
        assert found.seconds(1) == Fraction(1, 150_000_000)
        assert found.count == Phases(ScenePlan(case)).count


def test_a_crystal_with_a_fine_tick_keeps_its_cycle_exact() -> None:
    """147.456 MHz: a tick is shorter than a picosecond."""
    found = phases(unit={"dsp": {**UNIT["dsp"], "oscclk": "29.4912 MHz"}}, host={})
    assert found.seconds(147_456_000) == 1
    assert found.count == 147_456 * 20


GRIDS = [phases(host={"ppm": ppm}, controller={**REQUEST, "ppm": ppm, "first": "5 ms"}) for ppm in (0, -30, 78)]


@given(st.sampled_from(GRIDS), st.integers(0, 2_999_000), st.integers(0, 50))
def test_a_phase_is_the_distance_from_its_due_time(found: Phases, phase: int, number: int) -> None:
    start = found.starts([phase] * (number + 1))[-1]
    assert start == found.due(number) + phase * found.cycle
    assert found.cycles_after_due(start) == phase
    assert found.cycles_after_due(found.due(0)) == 0


@given(st.sampled_from(GRIDS), st.lists(st.integers(0, 2_999_000), min_size=1, max_size=5, unique=True).map(sorted))
def test_the_phase_at_a_start_is_that_of_the_start(found: Phases, chosen: list[int]) -> None:
    inputs, _ = found.inputs(chosen)
    assert inputs.frames is not None
    for phase, time in zip(chosen, inputs.frames, strict=False):
        assert found.phase_at(chosen, float(time) + 1e-9) == phase
    assert found.phase_at(chosen, 0) == chosen[0]


@given(st.fractions(0, 20 * MS), st.fractions(0, 20 * MS))
def test_the_phases_between_two_times_lie_between_them(one: Fraction, two: Fraction) -> None:
    found, first, last = GRIDS[0], min(one, two), max(one, two)
    try:
        low, high = found.between(first, last)
    except BadCase:
        assert last - first < found.seconds(1) or first > found.seconds(found.count - 1)
        return
    assert found.seconds(low - 1) < first <= found.seconds(low)
    assert found.seconds(high) <= last and high < found.count
    assert last < found.seconds(high + 1) or high == found.count - 1


def test_the_least_distance_of_starts_is_a_period_without_jitter_and_with_a_fast_clock() -> None:
    """A period has 60,000,000 ticks. With a clock error of 0.2 ppm, 21 ms differ by 12.6 ticks, counted twice."""
    rounds = {**REQUEST, "jitter": "1 ms"}
    found = phases(controller=rounds)
    assert found.least_distance() == 57_000_000
    assert found.least_distance(Fraction(1, 5)) == 57_000_000 - 26
    assert phases(host={"jitter": "2 ms"}, controller=rounds).least_distance(Fraction(1, 5)) == 54_000_000
    assert phases(host={"period": "30 ms"}, controller=rounds).least_distance() == 57_000_000


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no firmware": ({"unit": {}, "controller": REQUEST}, r"there is no firmware to cover; give it a \[unit\.NAME\]"),
    "a fault": ({"host": {}, "fault": [{"line": "RX", "at": "1 ms", "length": "1 ms"}]}, "does not move the times of"),
    "lost bytes": ({"host": {"lose": [[0, 1]]}}, r"host\.lose: prove does not move the times of faults; remove"),
    "silence": ({"host": {"silent": [["1 ms", "2 ms"]]}}, r"host\.silent: prove does not move the times of faults"),
    "frames sent twice": ({"host": {"twice": [1]}}, r"host\.twice: prove does not move the times of faults"),
    "chosen frames": ({"host": {}, "inputs": {"frames": ["1 ms"]}}, "prove chooses the starts itself; remove rounds"),
    "no frames": ({"host": {}, "inputs": {"frames": []}}, "prove chooses the starts itself; remove rounds"),
    "chosen rounds": ({"controller": REQUEST, "inputs": {"rounds": ["9 ms"]}}, "prove chooses the starts itself"),
    "later sends": ({"serial": SEND, "inputs": {"sends_later": "1 us"}}, "prove chooses the starts itself"),
    "nothing free": ({}, r"no start is free: there is no \[host\], no \[controller\], and no \[\[serial\.send\]\]"),
    "serial and host": ({"host": {}, "serial": {"send": [{**SEND["send"][0], "to": "dsp.SCI-B"}]},
                         "unit": {"dsp": {**UNIT["dsp"], "modules": ["SCI-A", "SCI-B"]}}}, "moves either"),
    "ended rounds": ({"host": {}, "controller": {**REQUEST, "rounds": 3}}, "prove needs rounds without end; remove"),
    "faster frames": ({"host": {"period": "5 ms"}, "controller": REQUEST}, r"host\.period: prove moves one frame in a"),
}  # fmt: skip


@pytest.mark.parametrize(("tables", "sentence"), WRONG.values(), ids=WRONG)
def test_a_case_without_a_free_phase_is_refused_with_the_reason(tables: dict[str, Any], sentence: str) -> None:
    with pytest.raises(BadCase, match=sentence):
        phases(**tables)


@settings(max_examples=20)
@given(st.integers(-100, 100))
def test_the_period_of_a_fast_or_slow_host_is_that_of_its_clock(ppm: int) -> None:
    found = phases(host={"ppm": ppm})
    assert found.count == int(3_000_000 * Fraction(10**6, 10**6 + ppm))


def test_the_listener_has_as_many_phases_as_cycles(tmp_path: Path) -> None:
    assert Phases(ScenePlan(load(listener(tmp_path)))).count == 15_000
