"""[inputs]: rounds, frames and costs at exactly the given values.

rounds   |--5.2 ms--R1---25 ms--R2
frames   |-1 ms-F1--12 ms--F2
costs    | the first computation 100 us, the second 130 us, further ones drawn
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim import BadCase, Case, Dsp, Firmware, FirmwareError, Scene, load, make_case
from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.table import Spread
from periph_sim.core.time import NO_TIME, Timebase
from periph_sim.scene.firmware_loader import settings_for
from periph_sim.timing.rounds import BusRounds, MasterSchedule
from tests.scene.runs import TIMING

US = Fraction(1, 1_000_000)
MS = 1000 * US
COST = Spread(100 * US, 140 * US)
BIT = Fraction(1, 115_200)
ONE_CYCLE = Fraction(1, 150_000_000)


def steps(dsp: Dsp, _: object) -> None:
    for _ in range(4):
        dsp.compute(COST, "step")


def idle(dsp: Dsp, _: object) -> None:
    dsp.compute(10**9)


class Observed:
    """Times of rounds and frames, and durations of spans, in seconds from the start of a run."""

    def __init__(self, case: Case, program: Any = None, seconds: Fraction | None = None) -> None:
        self.rounds: list[Fraction] = []
        self.frames: list[Fraction] = []
        self.costs: list[Fraction] = []
        self._span = Fraction(0)
        self._edge_of_rx = -MS
        programs = None if program is None else {"dsp": Firmware("dsp", program, None)}
        scene = self.scene = Scene(case, self._subscribe, programs)
        if scene.head is not None:
            scene.head.on_round.append(lambda one: self.rounds.append(self._seconds(one.start)))
        self.result = scene.run(seconds)

    def _subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        self._rate = timebase.per_second
        recorder.subscribe([Kind.SPAN, Kind.EDGE], self._keep, {Kind.EDGE: ["RX"]})

    def _seconds(self, tick: int) -> Fraction:
        return Fraction(tick, self._rate)

    def _keep(self, record: Record) -> None:
        now = self._seconds(record.tick)
        if record.kind is Kind.EDGE:
            if record.where == "RX" and now > self._edge_of_rx + 20 * BIT:  # edges within a frame are closer
                self.frames.append(now)
            self._edge_of_rx = now if record.where == "RX" else self._edge_of_rx
        elif record.value:
            self._span = now
        else:
            self.costs.append(now - self._span)


def case(**tables: Any) -> Case:
    unit = {"dsp": {"firmware": "responder", "modules": ["I2C-A", "SCI-A"]}}
    return make_case(name="x", duration="40 ms", **{"unit": unit, **tables})


REQUEST = {"request": [{"address": 0x20, "count": 1}]}


def test_rounds_start_at_the_listed_times():
    """Their times are not scaled by ppm, and the last listed round is the last of the run."""
    listed = ["5.2 ms", "25 ms"]
    seen = Observed(case(controller={**REQUEST, "ppm": 100, "jitter": "1 ms"}, inputs={"rounds": listed}), idle)
    assert seen.rounds == [Fraction("5.2") * MS, 25 * MS]


def test_frames_start_at_the_listed_times():
    listed = {"frames": ["1 ms", "12 ms"]}
    seen = Observed(case(host={"ppm": 100, "jitter": "1 ms", "paced_by": "pause"}, inputs=listed), idle)
    assert seen.frames == [1 * MS, 12 * MS]


def test_a_listed_frame_number_is_that_of_its_start():
    """The host's frame n is then due at the start of entry n, for the age and the true value of its data."""
    seen = Observed(case(host={}, inputs={"frames": ["1 ms", "12 ms"]}), idle)
    host, per_ms = seen.scene.host, seen.scene.timebase.per_second // 1000
    assert [host.due(number) for number in (0, 1)] == [per_ms, 12 * per_ms]
    assert host.frame_at(12 * per_ms + per_ms) == 1 + Fraction(1, 20)  # by the period of 20 ms


def test_empty_lists_have_no_rounds_and_no_frames():
    seen = Observed(case(controller=REQUEST, host={}, inputs={"rounds": [], "frames": []}), idle)
    assert (seen.rounds, seen.frames) == ([], [])


def test_lists_that_are_not_given_leave_the_schedules():
    with_costs = case(controller=REQUEST, host={}, inputs={"costs": {"dsp": []}})
    without = case(controller=REQUEST, host={})
    assert Observed(with_costs, idle).rounds == Observed(without, idle).rounds != []


def test_a_round_that_starts_within_another_is_missed():
    """A round of an address and one byte takes 0.2 ms."""
    budget = {"name": "missed", "measure": "missed rounds", "max": 0}
    listed = {"rounds": ["5 ms", "5.05 ms", "6 ms"]}
    seen = Observed(case(controller=REQUEST, inputs=listed, budget=[budget]), idle)
    assert seen.rounds == [5 * MS, 6 * MS]
    assert seen.result.budgets[0].worst == 1


def test_the_last_round_is_missed_if_it_starts_within_another():
    budget = {"name": "missed", "measure": "missed rounds", "max": 0}
    for late in ("0 s", "1 ms"):  # jitter does not apply
        tables = {"controller": {**REQUEST, "jitter": late}, "inputs": {"rounds": ["5 ms", "5.05 ms"]}}
        seen = Observed(case(**tables, budget=[budget]), idle)
        assert (seen.result.budgets[0].worst, seen.scene.head.missed) == (1, 1)
        (note,) = (one for one in Observed(case(**tables), idle).result.notes if one.startswith("controller"))
        assert note.startswith("controller: 1 round did not begin when due, because the one before was still running")


def test_the_slack_of_a_round_reaches_to_the_next_listed_start():
    """A round of an address and one byte takes 0.105 ms; the last one has slack until a period of 20 ms has passed."""
    slack = {"name": "slack", "measure": "slack", "min": "0 s"}
    for rounds, worst in ((["5 ms", "6 ms"], 895), (["5 ms", "30 ms"], 19_895)):
        (verdict,) = Observed(case(controller=REQUEST, inputs={"rounds": rounds}, budget=[slack]), idle).result.budgets
        assert verdict.worst == worst


def test_rounds_of_another_master_are_due_when_they_begin_after_the_list():
    asked = [Transfer("", [Phase(0x20, True, count=1, start_at=tick)], tick + 10) for tick in (50, 70)]
    rounds = BusRounds(MasterSchedule(tuple(asked[:1]), 20, first=10, starts=(50,)), lambda: NO_TIME)
    seen: list[tuple[int, int]] = []
    rounds.on_round.append(lambda one: seen.append((one.due, one.start)))
    for transfer in asked:
        rounds.transfer(transfer)
    assert seen == [(50, 50), (70, 70)]


def test_a_frame_that_starts_within_another_is_not_sent():
    seen = Observed(case(host={}, inputs={"frames": ["1 ms", "1.5 ms", "4 ms"]}), idle)
    assert len(seen.frames) == 2
    assert seen.scene.host.late == 1


def test_costs_are_the_listed_ones_and_then_drawn():
    seen = Observed(case(inputs={"costs": {"dsp": ["100 us", "130 us"]}}), steps)
    assert seen.costs[:2] == [100 * US, 130 * US]
    drawn = Random("0 dsp computations")
    assert seen.costs[2:] == [drawn.randint(15_000, 21_000) * ONE_CYCLE for _ in range(2)]


def test_a_cost_outside_its_range_is_refused_when_it_is_used():
    with pytest.raises(FirmwareError, match=r"entry 2 of costs in \[inputs\] is 99 us; expected 100 us to 140 us"):
        Observed(case(inputs={"costs": {"dsp": ["100 us", "99 us"]}}), steps)


WRONG = {
    "rounds without a controller": ({"rounds": ["1 ms"]}, r"inputs\.rounds: there is no \[controller\]"),
    "frames without a host": ({"frames": ["1 ms"]}, r"inputs\.frames: there is no \[host\]"),
    "costs of an unknown unit": ({"costs": {"dps": []}}, r"there is no unit 'dps'; did you mean dsp"),
}


@pytest.mark.parametrize(("inputs", "sentence"), WRONG.values(), ids=WRONG)
def test_lists_of_missing_parts_are_refused(inputs: dict[str, Any], sentence: str):
    with pytest.raises(BadCase, match=sentence):
        case(inputs=inputs)


def test_starts_out_of_order_are_reported_with_their_change():
    changes = ["inputs.rounds=['5 ms']", "inputs.frames=['5 ms', '3 ms']"]
    with pytest.raises(
        BadCase, match=r"--set \"inputs\.frames=\['5 ms', '3 ms'\]\": inputs\.frames\.1: it is not after"
    ):
        load(TIMING / "imu_hil.toml", changes)


def test_a_round_before_the_chips_are_set_up_is_refused():
    """The chips are set up 10 ms before `first`, whatever the listed rounds."""
    tables = {"chip": {"gyroscope": {"model": "itg3200", "values": {"fixed": [0, 0, 0]}}}, "unit": {}}
    asked = {"request": [{"chip": "gyroscope"}], "first": "40 ms", "initialise": "10 ms"}
    sentence = r"inputs\.rounds\.0: the round starts before the chips are set up; start it later, or make "
    with pytest.raises(BadCase, match=sentence):
        Scene(case(controller=asked, inputs={"rounds": ["29 ms"]}, **tables))
    assert Observed(case(controller=asked, inputs={"rounds": ["36 ms"]}, **tables)).rounds == [36 * MS]


@pytest.mark.parametrize(("key", "program"), [("image", "x.out"), ("sources", ["x.c"])])
def test_costs_of_units_without_ranges_are_refused(key: str, program: object):
    with pytest.raises(BadCase, match=r"inputs\.costs\.dsp: only computations of Python firmware have a range"):
        make_case(name="x", unit={"dsp": {key: program, "modules": []}}, duration="1 ms", inputs={"costs": {"dsp": []}})


@pytest.mark.parametrize("times", [["2 ms", "1 ms"], ["2 ms", "2 ms"]])
def test_starts_out_of_order_are_refused(times: list[str]):
    with pytest.raises(BadCase, match=r"inputs\.rounds\.1: it is not after the start before it; list them in order"):
        case(controller=REQUEST, inputs={"rounds": times})


def test_the_inputs_of_the_flagship_listed_give_the_same_verdicts():
    """The starts and costs of a run, given as lists, lead to the same verdict and value of every budget."""
    path, seconds = TIMING / "imu_hil.toml", Fraction(1, 5)
    before = Observed(load(path), None, seconds)
    firmware, given_settings = before.scene.firmware["dsp"], before.scene.case.unit["dsp"].settings
    estimated = settings_for(firmware, given_settings).run_cost
    random, least, most = Random("1 dsp computations"), estimated.least / ONE_CYCLE, estimated.most / ONE_CYCLE
    costs = [random.randint(-(-least // 1), -(-most // 1)) * ONE_CYCLE for _ in range(20)]
    lists = {"rounds": before.rounds, "frames": before.frames}
    changes = [f"inputs.{name}={[in_seconds(time) for time in times]}" for name, times in lists.items()]
    changes.append(f"inputs.costs.dsp={[in_seconds(cost) for cost in costs]}")
    after = Observed(load(path, [*changes, "host.jitter=0 s", "seed=1"]), None, seconds)
    assert len(before.rounds) == 10 and len(before.frames) == 10
    assert after.rounds == before.rounds and after.costs == before.costs
    assert after.result.budgets == before.result.budgets


def in_seconds(time: Fraction) -> str:
    return f"{time.numerator}/{time.denominator} s"


@settings(max_examples=30)
@given(
    st.lists(st.integers(0, 30_000), min_size=1, max_size=5, unique=True).map(sorted),
    st.lists(st.integers(0, 30_000), max_size=5, unique=True).map(sorted),
)
def test_rounds_and_frames_start_at_any_listed_cycles(rounds: list[int], frames: list[int]):
    """Every listed start begins a round or a frame, unless it lies within the previous one."""
    lists = {"rounds": [f"{one} us" for one in rounds], "frames": [f"{one} us" for one in frames]}
    seen = Observed(case(controller={**REQUEST, "gap": "0 s"}, host={}, inputs=lists), idle)
    assert set(seen.rounds) <= {one * US for one in rounds}
    assert len(seen.rounds) + seen.scene.head.missed == len(rounds)
    assert seen.scene.host.frames + seen.scene.host.late == len(frames)
