"""Rates of the host: their sequences of samples, and proofs for a range of rates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import floor
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim import form
from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.core.records import Kind
from periph_sim.proof import host_rates, pair_table, table_proof
from periph_sim.proof.calls import call_here
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.host_rates import RatePlan, RateTask, edge_places, plan_rates, prove_rates, rate_runs, run_rate
from periph_sim.proof.pair_groups import Cells, Group, GroupRun, Orbit, Orbits
from periph_sim.proof.pair_run import Known, Task
from periph_sim.proof.pair_table import KnownGroup, PairMaker
from periph_sim.proof.stretch import CoveredCase, Job, Outcome
from periph_sim.proof.table_cases import check
from periph_sim.proof.table_proof import prove
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import PROVEN
from tests.proof.pair_cases import keep_a_tenth, maker_of, write_lonely
from tests.proof.proven_slave import write_slave
from tests.proof.test_pair_table import runner_of

Samples = tuple[int, ...]
compiled_only = pytest.mark.skipif(form.running == form.INTERPRETED, reason="a whole table takes minutes interpreted")


def samples_of(places: list[Fraction], bit: Fraction, start: int, sample: int) -> Samples:
    """Return, for each edge, the number of samples before it, counted from the sample before the start."""
    return tuple((start + floor(place * bit)) // sample for place in places)


# Sequences of samples ----------------------------------------------------------------


@given(
    st.lists(st.integers(1, 40), min_size=1, max_size=6, unique=True),
    st.integers(1, 3),
    st.fractions(10, 40, max_denominator=7),
    st.fractions(0, 2, max_denominator=50),
    st.integers(2, 13),
    st.data(),
)
def test_each_sequence_of_each_rate_and_start_is_run(
    steps: list[int], parts: int, least: Fraction, more: Fraction, sample: int, data: st.DataObject
) -> None:
    """Rates between those at which an edge moves are checked, too: they have no further sequence."""
    places = [Fraction(0), *(Fraction(step, parts) for step in sorted(steps))]
    first = data.draw(st.integers(0, sample - 1))
    runs = list(rate_runs(places, (least, least + more), sample, first))
    run: set[Samples] = set()
    first_runs: set[Samples] = set()
    for bit, starts in runs:
        assert least <= bit <= least + more
        first_run = samples_of(places, bit, first, sample)
        assert starts or first_run not in first_runs
        first_runs.add(first_run)
        for begin, end in starts:
            (sequence,) = {samples_of(places, bit, start, sample) for start in range(begin, end + 1)}
            assert begin == 0 or samples_of(places, bit, begin - 1, sample) != sequence
            assert end == sample - 1 or samples_of(places, bit, end + 1, sample) != sequence
            assert sequence not in run  # none is run twice
            run.add(sequence)
    others = st.fractions(least, least + more, max_denominator=1000)
    for bit in (least, least + more, *data.draw(st.lists(others, max_size=40))):
        assert {samples_of(places, bit, start, sample) for start in range(sample)} <= run
        assert samples_of(places, bit, first, sample) in first_runs


def test_the_first_rate_at_which_an_edge_is_a_tick_later_is_run() -> None:
    """From a bit of 11 ticks on, a frame that starts a tick after a sample has its edge after a further sample."""
    runs = list(rate_runs([Fraction(0), Fraction(1)], (Fraction(21, 2), Fraction(45, 4)), 2, 0))
    assert runs == [(Fraction(21, 2), ((0, 1),)), (Fraction(11), ((1, 1),))]


@pytest.mark.parametrize("gap", [Fraction(0), Fraction(3), Fraction(1, 3)])
def test_edges_are_where_the_host_makes_them(gap: Fraction, tmp_path: Path) -> None:
    case = CoveredCase(Job(str(write_lonely(tmp_path)), (f"host.gap={gap}", "host.error=0.5"))).case
    edges: list[int] = []
    scene = Scene(
        case, lambda recorder, _: recorder.subscribe([Kind.EDGE], lambda r: edges.append(r.tick), {Kind.EDGE: ["RX"]})
    )
    scene.advance(scene.start + scene.timebase.ticks(Fraction(11, 1000), "exact"))
    assert scene.host is not None and len(scene.host.last_data) == 12
    bit = scene.timebase.per_second / (Fraction(1562500) * Fraction(1005, 1000))
    places = edge_places(scene.host.last_data, gap)
    assert [tick - edges[0] for tick in edges] == [floor(place * bit) for place in places]


def test_groups_that_are_run_again_are_shared_among_the_rates_with_starts(tmp_path: Path) -> None:
    job, table = Job(str(write_lonely(tmp_path))), SimpleNamespace(again=3, apart=0)
    known = SimpleNamespace(orbits=SimpleNamespace(known=[None]))
    maker: Any = SimpleNamespace(covered=CoveredCase(job), known=known, table=table, long=10)
    maker.random_groups = lambda *_: iter(())
    plan = [(Fraction(64), starts) for starts in (((0, 1),), (), ((2, 3), (5, 8)))]
    prove_rates(plan, maker, job, (), 21, lambda work, calls: iter([5, 7, 6]))
    assert (table.again, table.apart) == (3 + 11 + 11, 7 + 1 + 10)


# Runs of invented groups -------------------------------------------------------------

TABLE_RUN = GroupRun(0, 0, 0, 0, 500, 1000, True)
ALONE, MEETING = Group(None, 0), Group(0, 0)


class InventedPairs:
    """Runs of groups whose requests come with the sample after tick 50 of a cell of frames.

    Tests change `delay_of`, the length of meetings, the failures, and the orbits that are found.
    """

    failures: frozenset[str] = frozenset()
    finds: tuple[Orbit, ...] = ()
    longest = 1000

    def __init__(self, covered: CoveredCase, ignored: object, known: Known) -> None:
        assert covered.case.host is not None
        self.error, self.known = covered.case.host.error, known
        self.ran: list[tuple[Group, int]] = []
        self.runner = SimpleNamespace(at=(0, 0))
        self.done = SimpleNamespace(outcomes=[Outcome((), self.failures), Outcome((), frozenset())])

    def delay_of(self, group: Group, offset: int) -> int:
        return 500 + (offset + 30) // 80 * 80

    def run(self, task: Task) -> GroupRun:
        assert task.orbit == 0 and task.sleep is None
        self.ran.append((task.group, task.offset))
        length = 1000 if task.group.round is None else self.longest
        return TABLE_RUN._replace(delay=self.delay_of(task.group, task.offset), length=length)

    def end(self) -> None:
        for orbit in self.finds:
            self.known.orbits.add(orbit)


def known_table() -> Known:
    known = Known(Orbits(), Cells(0, 80, 0, 0), {})
    known.orbits.add(Orbit((b"a",), 0))
    return known


def rated(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    start: tuple[int, int],
    kind: type[InventedPairs],
    known: Known | None = None,
) -> tuple[int, InventedPairs]:
    """Run frames that start in this range, and 20 meetings. Return the length of the longest, and the runs."""
    made: list[InventedPairs] = []
    monkeypatch.setattr(host_rates, "PairRun", lambda *given: made.append(kind(*given)) or made[-1])
    frames, groups = ({0: [KnownGroup(0, group, TABLE_RUN)]} for group in (ALONE, MEETING))
    task = RateTask(Fraction(1, 4), (start,), frames, groups, 20)
    longest = run_rate(Job(str(write_lonely(folder))), (), known or known_table(), task, 3)
    return longest, made[0]


def test_frames_at_both_ends_of_a_range_of_starts_are_run_as_those_of_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frames that start 60 to 100 ticks after the first tick of a cell are frames of the next one, 20 ticks earlier."""

    class Longer(InventedPairs):
        longest = 1234

    longest, pairs = rated(tmp_path, monkeypatch, (60, 100), Longer)
    assert (longest, pairs.error) == (1234, Fraction(1, 4))
    assert pairs.ran[:3] == [(ALONE, 60), (ALONE, -20), (ALONE, 20)]
    meetings = pairs.ran[3:]
    assert len(meetings) == 20 and {group for group, _ in meetings} == {MEETING}
    assert len({offset for _, offset in meetings}) > 5 and all(-20 <= offset <= 20 for _, offset in meetings)


OTHER_FRAME = "a frame has other effects than each frame of the table"
OTHER_MEETING = "a frame and a round have other effects than those of the table"


@pytest.mark.parametrize(
    ("start", "delay", "reason"),
    [
        ((60, 130), lambda group, offset: 500 + (offset + 30) // 80 * 80, OTHER_FRAME),  # two sequences of samples
        ((60, 100), lambda group, offset: 420 if offset == -20 else 500 + (offset + 30) // 80 * 80, OTHER_FRAME),
        ((10, 10), lambda group, offset: 500 + offset, OTHER_FRAME),  # no whole number of samples later
        ((10, 40), lambda group, offset: 500 + 80 * (group == MEETING), OTHER_MEETING),
    ],
)
def test_frames_with_other_effects_are_noticed(
    start: tuple[int, int], delay: Callable[[Group, int], int], reason: str, tmp_path: Path, monkeypatch: Any
) -> None:
    class Other(InventedPairs):
        def delay_of(self, group: Group, offset: int) -> int:
            return delay(group, offset)

    with pytest.raises(NotClosed, match=rf"^at a host.error of 0\.25 %, {reason}"):
        rated(tmp_path, monkeypatch, start, Other)


def test_failures_and_further_rests_at_another_rate_are_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Failing(InventedPairs):
        failures = frozenset({"latency"})

    class Finding(InventedPairs):
        finds = (Orbit((b"b",), 0),)

    known = known_table()
    for kind, reason in ((Failing, "a run breaks latency"), (Finding, host_rates.OTHER_REST)):
        with pytest.raises(NotClosed, match=rf"^at a host.error of 0\.25 %, {reason}"):
            rated(tmp_path, monkeypatch, (10, 40), kind, known)
    assert len(known.orbits.known) == 1


# Proofs ------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def tables_repeat_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run few groups to explore a table, and again; test_pair_table uses the numbers of a whole table."""
    monkeypatch.setattr(pair_table, "TIMED", 20)
    monkeypatch.setattr(table_proof, "LEAST_REVISITED", 10)


class Planned(NamedTuple):
    """A plan of rates, and the objects that run it. The table is explored, but not closed."""

    maker: PairMaker
    job: Job
    ignored: Sequence[str]
    plan: RatePlan

    def prove(self) -> None:
        """Run the frames of the plan, as `prove` does after the table is closed."""
        prove_rates(self.plan, self.maker, self.job, self.ignored, 10, call_here)


def planned(folder: Path, within: int, *changes: str, firmware: tuple[tuple[str, str], ...] = ()) -> Planned:
    job = Job(str(write_lonely(folder, *firmware)), changes)
    ignored = check(CoveredCase(job).case, with_pairs=True)
    maker = maker_of(job, 0)
    maker.explore()
    return Planned(maker, job, ignored, plan_rates(maker, ignored, Fraction(within)))


@compiled_only
def test_a_frame_at_each_rate_is_a_frame_of_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lengths: list[int] = []
    before: list[tuple[int, int]] = []

    def call_all(work: Any, calls: Any) -> Iterator[Any]:
        for found in call_here(work, calls):
            lengths.extend([found] if work is run_rate else ())
            yield found

    def after_closing(plan: RatePlan, maker: PairMaker, *others: Any) -> None:
        before.append((maker.table.again, maker.table.apart))
        prove_rates(plan, maker, *others)

    keep_a_tenth(monkeypatch)
    monkeypatch.setattr(table_proof, "prove_rates", after_closing)
    made = prove(Job(str(write_lonely(tmp_path)), ("host.error=0.16",)), call_all=call_all, rates=Fraction(10))
    assert made.rates == 10
    assert {name for name, word in made.words().items() if word == PROVEN} == {"latency", "service"}
    ((again, apart),) = before
    assert again + 10 <= made.again < again + 200
    assert made.apart >= apart and made.apart > max(lengths) > 2_000_000  # a rest begins 2 ms after a frame


@compiled_only
def test_the_announced_time_includes_the_rates(tmp_path: Path) -> None:
    """A rate with two starts is a scene, six frames and its share of the meetings that are run again."""
    times = list[float]()
    maker = maker_of(Job(str(write_lonely(tmp_path))), on_estimate=lambda _, seconds: times.append(seconds))
    maker.explore()
    for rates in ([], [2] * 20, [2] * 20 + [0] * 20):
        maker.estimate(rates)
    group, scene = maker._seconds, maker._scene_seconds
    first, second = (two - one for one, two in pairwise(times))
    assert first == pytest.approx(group * (200 + 6 * 20) + scene * (20 + 320 / 256))
    assert second == pytest.approx(scene * 20)


@compiled_only
def test_a_rate_at_which_a_character_is_lost_is_noticed(tmp_path: Path) -> None:
    """The SCI receives all characters up to a rate that is 3.8945 % too high."""
    found = planned(tmp_path, 20, "host.error=3.8943")
    with pytest.raises(NotClosed, match=r"^at a host.error of 3\.89\d* %, a frame has 0 service routines of the SCI"):
        found.prove()


@compiled_only
def test_more_rates_than_can_be_run_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(planned(tmp_path, 60).plan) > 3
    monkeypatch.setattr(host_rates, "MOST_RATES", 3)
    with pytest.raises(NotClosed, match="more than 3 different sequences of samples in this range of rates"):
        planned(tmp_path, 60)


@compiled_only
def test_the_range_is_around_the_rate_of_the_case(tmp_path: Path) -> None:
    """100 ppm of the rate are 148 ppm of the baud rate, since the error of the rate is 47.568 %."""
    plan = planned(tmp_path, 100, "host.baud=1100000", "host.error=47.568182").plan
    rate = 1_100_000 * Fraction("1.47568182") * Fraction(10_001, 10_000)
    assert plan[0][0] == 1_000_000_000 / rate  # a tick is a nanosecond
    assert plan[0][0] * Fraction(100_018, 100_000) < plan[-1][0] <= plan[0][0] * Fraction(10_001, 9_999)


@compiled_only
def test_the_place_of_the_first_frame_between_two_samples_depends_on_its_start_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With idle bits between the characters, the last one begins at another place between two samples."""
    firsts: list[int] = []
    monkeypatch.setattr(host_rates, "rate_runs", lambda *given: firsts.append(given[3]) or [])
    for changes in ((), ("host.gap=0.3", 'host.first="9.000007 ms"')):
        planned(tmp_path, 10, *changes)
    assert firsts[1] == (firsts[0] + 7) % 80


MAIN = "_main:    LCR   #_model\n"
LOOK = """          MOVW  DP,#GPADAT >> 6
look:     TBIT  @GPADAT+1,#12
          SB    look,TC
"""


@compiled_only
def test_both_ends_of_a_range_of_starts_are_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All starts are treated as one sequence of samples, although the last has its request at another sample."""
    real = rate_runs

    def too_wide(*given: Any) -> list[Any]:
        return [(bit, ((0, given[2] - 1),)) for bit, _ in real(*given)]

    monkeypatch.setattr(host_rates, "rate_runs", too_wide)
    found = planned(tmp_path, 10, "host.error=0.16")
    with pytest.raises(NotClosed, match="a frame has other effects than each frame of the table"):
        found.prove()


@compiled_only
def test_start_up_code_that_looks_at_the_line_is_refused(tmp_path: Path) -> None:
    """It could measure the rate of the first frame, cycle by cycle."""
    with pytest.raises(NotClosed, match=r"start-up code may notice the rate of the first frame: .*GPADAT"):
        planned(tmp_path, 10, firmware=((MAIN, LOOK + MAIN),))


@compiled_only
def test_a_frame_can_start_long_before_or_after_its_cell(tmp_path: Path) -> None:
    runner = runner_of(write_lonely(tmp_path))
    for offset in (-1000, -100_000, 100_000):
        now, first = runner.run.now, runner.run.scene.start
        frame = (runner.cells.first - runner.orbits.known[runner.at[0]].origin) % runner.cells.period  # type: ignore[union-attr]
        runner.run_group(Group(None, frame), offset)
        assert runner.run.frames[-1] + first > now


@compiled_only
@pytest.mark.parametrize("bits", [7, 9])
def test_a_request_that_is_not_with_the_last_character_is_refused(
    bits: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if a character had 9 or 11 bits in place of 10, so that the request is too late or too early."""
    monkeypatch.setattr(host_rates, "UartFormat", lambda: UartFormat(bits=bits))
    with pytest.raises(NotClosed, match="not requested with the last character of a frame"):
        planned(tmp_path, 60)


def test_rates_need_a_host_and_a_controller(tmp_path: Path) -> None:
    with pytest.raises(BadCase, match=r"--host-ppm needs both a \[host\] and a \[controller\]"):
        prove(Job(str(write_slave(tmp_path))), rates=Fraction(1))
