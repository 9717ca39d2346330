"""Tables of cases whose rounds and frames start independently: closed tables, and detection of wrong ones.

The scene of most tests is `write_lonely` at 100 MHz: a sample of the SCI's line lasts 8 cycles, a pass of the wait 10,
and a cycle has 10 ticks.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import islice, pairwise
from pathlib import Path
from random import Random
from types import SimpleNamespace
from weakref import ref

import pytest
from msgspec import structs

from periph_sim import form
from periph_sim.core.chip import NEVER
from periph_sim.proof import pair_table, table_proof
from periph_sim.proof.closed_table import REVISITED, StartTable
from periph_sim.proof.frame_cells import find_cells
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.pair_budgets import within_round
from periph_sim.proof.pair_groups import Cells, Group, GroupRun, GroupRunner, Orbit, Orbits, Sleep, far_ranges
from periph_sim.proof.pair_run import Done, Known, PairRun, Task, alone
from periph_sim.proof.pair_table import Cell, PairMaker, round_offsets
from periph_sim.proof.stretch import CoveredCase, Job, Outcome
from periph_sim.proof.table_cases import check
from periph_sim.proof.table_proof import TableProof, prove
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import PROVEN
from tests.proof.pair_cases import maker_of, write_lonely
from tests.proof.proven_slave import write_slave

SAMPLE, PASS = 80, 100  # ticks
compiled_only = pytest.mark.skipif(form.running == form.INTERPRETED, reason="a whole table takes minutes interpreted")


ANSWER = """
[[budget]]
name = "answer"
measure = "from bus START to 2nd bus byte of transfer, same transfer"
max = "1 s"

[[budget]]
name = "transfer"
measure = "from bus START to bus STOP, same transfer"
max = "26.26 us"

[[budget]]
name = "noticed"
measure = "from bus START to flag I2C-A.I2CSTR.BB = 1, next"
max = "1 us"
"""


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Job:
    path = write_lonely(tmp_path_factory.mktemp("lonely"))
    path.write_text(path.read_text(encoding="utf-8") + ANSWER, encoding="utf-8")
    return Job(str(path))


@pytest.fixture(scope="module")
def whole(job: Job) -> TableProof:
    return prove(job, any_tick=True)


@pytest.fixture(autouse=True)
def few_groups_are_explored(monkeypatch: pytest.MonkeyPatch) -> None:
    """Explore few groups. `whole` is made before this fixture, with the number of groups of the command."""
    monkeypatch.setattr(pair_table, "TIMED", 20)


def runner_of(path: Path) -> GroupRunner:
    """Return a runner that knows the cells of frames."""
    covered = within_round(CoveredCase(Job(str(path))))
    runner = GroupRunner(covered, check(covered.case, with_pairs=True), Orbits())
    runner.cells = find_cells(runner)
    return runner


def worst_of(made: TableProof, name: str) -> float:
    worst = made.worst()[name].verdict.worst
    assert worst is not None
    return worst


# A closed table ----------------------------------------------------------------------


@compiled_only
def test_few_groups_represent_all_meetings_of_a_round_and_a_frame(whole: TableProof):
    assert not whole.has_failed
    assert 1000 < whole.entries < whole.entry_count / 100
    assert whole.again >= 200
    assert {name for name, word in whole.words().items() if word == PROVEN} == {
        "latency",
        "service",
        "transfer",
        "noticed",
    }
    assert whole.covered.left_out["line"] == "a frame can move 'edge RX fall' in a way that is not run"
    assert whole.covered.left_out["age"] == "its values depend on the whole run"
    assert whole.not_proven()["answer"].startswith("a round has too few measured values")  # no request is answered


@compiled_only
def test_no_ordinary_run_is_worse_than_the_table_and_some_are_as_bad(whole: TableProof):
    """Half of the frames begin within 40 ticks of a place at which their service routine meets the wait's end."""
    random, case, per_second = Random(7), whole.covered.case, whole.covered.phases.ticks_per_second
    seen: dict[str, list[float]] = {"latency": [], "service": [], "noticed": []}
    for _ in range(60):
        rounds, frames = [], []
        at = per_second // 50
        for number in range(12):
            at += whole.apart + random.randrange(40_000)
            rounds.append(at)
            near = random.choice([-77_000, -50_000]) + random.randrange(-40, 40) * 10
            frames.append(at + (near if number % 2 else random.randrange(-2_000_000, 2_000_000)))
            at = max(rounds[-1], frames[-1])
        times = [tuple(Fraction(one, per_second) for one in starts) for starts in (frames, rounds)]
        inputs = InputsTable(frames=times[0], rounds=times[1])
        duration = Fraction(at + per_second // 100, per_second)
        result = Scene(case.model_copy(update={"inputs": inputs, "duration": duration})).run()
        for verdict in result.budgets:
            if verdict.name in seen:
                assert verdict.worst is not None
                seen[verdict.name].append(verdict.worst)
    assert {name: max(values) for name, values in seen.items()} == {name: worst_of(whole, name) for name in seen}


@pytest.mark.parametrize(
    ("change", "offsets"),
    [
        ("seed=1", (0, 1, 9)),
        ('controller.filter="50 ns"', (0, 1, 9)),
        ('controller.filter="55 ns"', (0, 1, 4, 5, 6, 9)),
        ('controller.filter="52 ns"', (0, 1, 2, 3, 4, 5, 6, 7, 8, 9)),
        ('controller.gap="51 ns"', tuple(range(10))),
        ("controller.ppm=-400", tuple(range(10))),  # SCL is low for 1251 ticks
        ('controller.stuck_after="25.000051 ms"', tuple(range(10))),
        ('controller.clear_after="25.000051 ms"', tuple(range(10))),
    ],
)
def test_offsets_of_rounds_that_represent_all_ticks_of_a_cycle(change: str, offsets: tuple[int, ...], tmp_path: Path):
    assert round_offsets(CoveredCase(Job(str(write_lonely(tmp_path)), (change,))), 10) == offsets


def test_only_a_case_with_rounds_and_frames_can_have_rounds_between_two_cycles(tmp_path: Path):
    with pytest.raises(BadCase, match=r"--any-tick needs both a \[host\] and a \[controller\]"):
        prove(Job(str(write_slave(tmp_path, ""))), any_tick=True)


@compiled_only
def test_the_run_of_the_worst_value_has_it(whole: TableProof):
    worst = whole.worst()["latency"]
    run, covered = worst.run(), worst.part.covered
    end = Fraction(run.until, covered.phases.ticks_per_second)
    scene = covered.scene_of(covered.phases.inputs_at(run.starts, run.rounds), end, covered.case.seed)
    (again,) = (verdict for verdict in scene.run().budgets if verdict.name == "latency")
    assert again.worst == worst.verdict.worst


@compiled_only
def test_a_limit_that_only_a_slow_clock_of_the_controller_breaks(job: Job, whole: TableProof):
    """With the clock of the case, a transfer lasts 26.25 us, and with clocks from about -400 ppm on, 26.271 us."""
    assert worst_of(whole, "transfer") == 26.25
    made = prove(job, Fraction(500))
    worst = made.worst()["transfer"]
    assert (made.has_failed, made.words()["transfer"], worst.verdict.worst) == (True, "broken", 26.271)
    assert [part.changes for part in made.parts] == [("controller.ppm=-500", "controller.first=0.011994 s")]


@compiled_only
def test_each_clock_of_the_controller_has_a_table_with_the_same_first_starts(
    job: Job, whole: TableProof, monkeypatch: pytest.MonkeyPatch
):
    made: list[CoveredCase] = []

    class Maker:
        def __init__(self, covered: CoveredCase, *_: object) -> None:
            made.append(covered)
            self.covered = within_round(covered)

        def explore(self) -> None:
            pass

        def estimate(self, rates: object) -> None:
            pass

        def make(self) -> StartTable:
            return whole.parts[0].table

    monkeypatch.setattr(table_proof, "PairMaker", Maker)
    proof = prove(job, Fraction(16))
    assert [part.changes[0] for part in proof.parts] == [f"controller.ppm={ppm}" for ppm in (-16, 0, 16)]
    assert [covered.phases.first_starts() for covered in made] == [{"frames": 9_000_000, "rounds": 12_000_000}] * 3
    assert [float(covered.case.controller.ppm) for covered in made if covered.case.controller] == [-16, 0, 16]
    assert (proof.words()["latency"], proof.data_use) == (PROVEN, "")


@compiled_only
def test_a_limit_just_below_the_worst_value_is_broken(whole: TableProof, tmp_path: Path):
    limit = round(worst_of(whole, "latency") - 0.001, 3)
    made = prove(Job(str(write_lonely(tmp_path, limit=limit))))
    assert made.has_failed
    assert made.words()["latency"] == "broken"


def test_starts_that_are_closer_than_those_of_the_table_are_not_proven(tmp_path: Path):
    path = str(write_lonely(tmp_path))
    least = CoveredCase(Job(path)).phases.least_distance()
    assert least == 20 * 10**6  # 20 ms, in ticks
    assert CoveredCase(Job(path, ("host.jitter=1 ms",))).phases.least_distance() == 19 * 10**6
    assert CoveredCase(Job(path, ("controller.period=5 ms",))).phases.least_distance() == 5 * 10**6


# Groups ------------------------------------------------------------------------------


def test_frames_within_one_sample_have_equal_runs(tmp_path: Path):
    runner = runner_of(write_lonely(tmp_path))
    assert runner.cells is not None
    assert (runner.cells.period, runner.orbits.own * runner.cycle) == (SAMPLE, PASS)
    orbit = runner.at[0]
    for group in alone(runner.orbits, orbit, runner.cells, runner.cycle, [0])[-2:]:
        runs = []
        while len(runs) < 4:
            here = runner.at[0]
            run = runner.run_group(group if here == orbit else runner.like(group), Random(len(runs)).randrange(SAMPLE))
            runs += [run] if here == orbit else []
        assert all(run.is_like(runs[0]) for run in runs)


def test_groups_within_one_wait_differ_only_in_the_pass_that_is_interrupted(tmp_path: Path):
    """The service routine is entered at each tick of a pass; the same tick of another pass has the same effect."""
    runner = runner_of(write_lonely(tmp_path))
    cells = runner.cells
    assert cells is not None
    for tick in (50, 0):
        (orbit, place), now = runner.at, runner.run.now - runner.run.scene.start
        waits = runner.sleeps(Group(tick, None))
        period = runner.orbits.known[orbit].cycles * runner.cycle
        assert runner.run.rounds[-1] > now and (runner.run.rounds[-1] - now + place * runner.cycle) % period == tick
    (_, high, sleep), *_ = far_ranges(waits, cells, runner.cycle)
    assert (sleep.period, len(waits)) == (PASS, 3)
    first = next(d for d in range(high - 40 * PASS, high) if runner.rounds_in(runner.orbits.known[orbit], 0, d))
    runs = {}
    for tick in range(0, PASS, 20):
        for turn in (0, 7, 30):
            pair = Group(0, first + tick + turn * PASS)
            while runner.at[0] != orbit:
                runner.run_group(runner.like(pair))
            runs[tick, turn] = runner.run_group(pair, 0, sleep)
    assert all(run.within and run.is_like(runs[tick, 0]) for (tick, _), run in runs.items())


@compiled_only
def test_each_meeting_is_run_or_in_a_cell(tmp_path: Path):
    """For each cycle, the distances of the single groups and of the cells are all distances in a row, each once."""
    maker = maker_of(Job(str(write_lonely(tmp_path))))
    pair = maker.explore()
    assert [len(starts) > 20 for starts in maker.table.starts] == [True, True]
    for waits in (maker.find_waits(pair, 0), dict.fromkeys(range(0, PASS, 10), ())):
        if not any(waits.values()):  # each meeting is a task, so there are as many as the groups are long
            maker.runs = {key: run._replace(length=run.length // 20) for key, run in maker.runs.items()}
        frame = max(run.length for (_, group), run in maker.runs.items() if group.round is None) + SAMPLE
        most = max(run.length for (_, group), run in maker.runs.items() if group.frame is None)
        tasks, cells = maker.tasks(0, waits)
        ends = {Group(cell.round, frame) for cell in cells for frame in (cell.first, cell.last)}
        assert ends <= {task.group for task in tasks}
        assert all((cell.last - cell.first) % cell.step == cell.step % cell.sleep.period == 0 for cell in cells)
        assert bool(cells) == any(waits.values())
        for tick in range(0, PASS, 30):  # cycles with an even number, and with an odd one
            found = [task.group.frame for task in tasks if task.group.round == tick and task.group not in ends]
            for cell in (cell for cell in cells if cell.round == tick):
                found += range(cell.first, cell.last + 1, cell.step)
            distances = sorted(one for one in found if one is not None)
            assert {two - one for one, two in pairwise(distances)} == {20}
            assert 0 <= distances[0] + frame < 20 and 0 <= most - distances[-1] < 20


def test_each_distance_is_run_or_in_a_cell_that_is_far_from_the_ends_of_its_wait(tmp_path: Path):
    """The waits are drawn. Some of them are too short for cells."""
    maker, random, counts = maker_of(Job(str(write_lonely(tmp_path)))), Random(3), set[bool]()
    maker._cycle, maker._frames, maker._orbits.own = 10, Cells(30, SAMPLE, 250, 400), 10
    maker._orbits.add(Orbit((b"",), 20))
    run = GroupRun(0, 0, 0, 0, 0, 0, True)
    maker.runs = {
        (0, Group(None, 0)): run._replace(length=500),
        (0, Group(None, 10)): run._replace(length=1500),
        (0, Group(0, None)): run._replace(length=4000),
        (0, Group(10, None)): run._replace(length=3000),
    }
    for _ in range(60):
        ends = [-NEVER, *sorted(random.sample(range(-3000, 6000), 6)), NEVER]
        waits = zip(ends[::2], ends[1::2], strict=True)
        sleeps = [Sleep(begin, end, random.choice([60, 100, 250]), ()) for begin, end in waits]
        ranges = {sleep: (low, high) for low, high, sleep in far_ranges(sleeps, maker._frames, 10)}
        tick = random.randrange(0, PASS, 10)
        tasks, cells = maker.tasks(0, {tick: sleeps})
        for cell in cells:
            low, high = ranges[cell.sleep]
            assert low <= cell.first < cell.last <= high
            assert cell.step % cell.sleep.period == cell.step % 20 == 0
        assert [task for task in tasks if task.sleep is not None] == [
            Task(0, Group(tick, frame), offset, cell.sleep)
            for cell in cells
            for frame, offset in ((cell.first, 0), (cell.last, SAMPLE - 1))
        ]
        offsets = {task.group.frame or 0: task.offset for task in tasks if task.sleep is None}
        found = sorted([*offsets, *(frame for cell in cells for frame in range(cell.first, cell.last + 1, cell.step))])
        assert found == list(range(found[0], found[-1] + 1, 20))
        assert -1500 - SAMPLE <= found[0] < -1500 - SAMPLE + 20 and 3980 < found[-1] <= 4000
        assert (20 + tick + found[0] - 30) % 20 == 0  # this frame can start with a cell
        assert all(
            {offset, offsets[at + 20]} == {0, SAMPLE - 1} for at, offset in offsets.items() if at + 20 in offsets
        )
        counts |= {any(cell.sleep == sleep for cell in cells) for sleep in ranges}
    assert counts == {True, False}


def test_random_groups_of_a_cell_are_within_it(tmp_path: Path):
    maker = maker_of(Job(str(write_lonely(tmp_path))))
    run = GroupRun(0, 0, 0, 0, 0, 0, True)
    maker.cells = [Cell(0, 10, -500, 500, 100, Sleep(-NEVER, NEVER, 100, ()))]
    maker.runs = {(0, Group(10, -500)): run, (0, Group(10, 500)): run}
    drawn = {one.group for one in islice(maker.random_groups(), 200)}
    assert drawn == {Group(10, frame) for frame in range(-500, 501, 100)}


def test_each_task_is_run_once_and_calls_of_one_batch_know_the_same_orbits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The results of calls are requested one by one, and each of them adds an orbit to the table."""
    monkeypatch.setattr(pair_table, "CHUNK", 3)
    monkeypatch.setattr(pair_table, "CALLS", 2)
    maker = maker_of(Job(str(write_lonely(tmp_path))))
    maker._frames = Cells(0, SAMPLE, 0, 0)
    batches: list[int] = []

    def call_all(work: object, calls: Sequence[tuple[Job, object, Known, list[Task]]]) -> Iterator[object]:
        batches.append(len(calls))
        for _, _, known, tasks in calls:
            yield tasks, len(known.orbits.known)

    monkeypatch.setattr(maker, "_call_all", call_all)
    tasks, found = [Task(0, Group(number, None), 0, None) for number in range(14)], []
    for number, done in enumerate(maker._outcomes(tasks)):
        found.append(done)
        maker._orbits.add(Orbit((bytes([number]),), 0))
    assert batches == [2, 2, 1]
    assert found == [(tasks[first : first + 3], known) for first, known in ((0, 0), (3, 0), (6, 2), (9, 2), (12, 4))]


# Tables of invented groups -------------------------------------------------------------

LIKE = GroupRun(0, 0, 0, 0, 0, 1000, True)
NOTHING_FAILED = Outcome((), frozenset())


def invented(
    folder: Path, monkeypatch: pytest.MonkeyPatch, run_of: Callable[[Task], GroupRun], orbits: Sequence[Orbit] = ()
) -> PairMaker:
    """Return a maker, after `explore`, with one orbit of 400 ticks, in which a wait lasts for ever.

    run_of: returns the run of a group. orbits: further orbits, which the calls find.
    """
    maker = maker_of(Job(str(write_lonely(folder))))
    maker._cycle, maker._frames, maker._places, maker.long = 10, Cells(0, SAMPLE, 250, 400), (0,), 7
    maker._orbits.own = 10
    maker._orbits.add(Orbit(tuple(bytes([number]) for number in range(40)), 0))

    def call_all(work: object, calls: Sequence[tuple[Job, object, Known, list[Task]]]) -> Iterator[Done]:
        for *_, tasks in calls:
            yield structs.replace(done_of([run_of(task) for task in tasks]), orbits=[*orbits])

    monkeypatch.setattr(pair_table, "PairRun", lambda *_: SimpleNamespace(end=lambda: None, done=done_of([])))
    monkeypatch.setattr(maker, "_call_all", call_all)
    monkeypatch.setattr(
        maker, "find_waits", lambda *_: {tick: [Sleep(-NEVER, NEVER, PASS, ())] for tick in range(0, PASS, 10)}
    )
    return maker


def done_of(runs: list[GroupRun]) -> Done:
    return Done(1, runs, [], [NOTHING_FAILED], [[]], [[]], 0, set(), set(), set(), set())


def test_an_orbit_that_is_found_while_another_is_closed_is_closed_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """One meeting of the first orbit leads to the second one, and all others to the first one."""
    new = Orbit(tuple(bytes([number, 1]) for number in range(40)), 0)
    maker = invented(
        tmp_path, monkeypatch, lambda task: LIKE._replace(after=int((task.orbit, task.group.round) == (0, 50))), [new]
    )
    maker._least_again = 1
    table = maker.make()
    of_orbits = [{group for orbit, group in maker.runs if orbit == number} for number in (0, 1)]
    assert of_orbits[0] == of_orbits[1] and table.orbits == [1060, 1060]
    assert table.entries == len(maker.runs) == 230
    assert table.again == 230 // REVISITED


def test_an_orbit_that_is_found_when_groups_are_run_again_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Groups from this orbit are not in the table, so the table is not closed."""
    orbits: list[Orbit] = []
    maker = invented(tmp_path, monkeypatch, lambda task: LIKE, orbits)
    again = maker._again

    def find_orbit() -> None:
        orbits.append(Orbit(tuple(bytes([number, 1]) for number in range(40)), 0))
        again()

    monkeypatch.setattr(maker, "_again", find_orbit)
    with pytest.raises(NotClosed, match="the firmware reaches a state of rest that is not in the table"):
        maker.make()


def test_groups_at_the_ends_of_cells_that_differ_are_in_no_cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A frame that comes early has another effect, and the service routine of a late one is not within the wait."""

    def run_of(task: Task) -> GroupRun:
        frame = 0 if task.group.frame is None else task.group.frame
        return LIKE._replace(routine=int(frame < -700), within=task.sleep is None or frame <= 600)

    maker = invented(tmp_path, monkeypatch, run_of)
    table = maker.make()
    assert len(maker.cells) == 10 * PASS // 20
    assert all(cell.groups > 5 and cell.first >= -700 and cell.last <= 600 for cell in maker.cells)
    single = {group.frame for (_, group) in maker.runs if group.round == 0 and group.frame is not None}
    ends = {frame for cell in maker.cells if cell.round == 0 for frame in (cell.first, cell.last)}
    inner = {frame for cell in maker.cells if cell.round == 0 for frame in range(cell.first, cell.last, cell.step)}
    assert single | inner == {*range(-1080, 1001, 20)} and single & inner <= ends
    assert table.orbits == [10 + 400 // SAMPLE + 5 * len(range(-1080, 1001, 20)) + 5 * len(range(-1070, 1001, 20))]


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_cell_without_two_groups_that_agree_is_refused(sign: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """All frames before the round, or all frames after it, have a routine that is not within the wait."""

    def run_of(task: Task) -> GroupRun:
        return LIKE._replace(within=task.sleep is None or (task.group.frame or 0) * sign <= 0)

    monkeypatch.setattr(pair_table, "MOST_SHRINKS", 5)
    with pytest.raises(NotClosed, match="service routines of the SCI within one wait have different effects"):
        invented(tmp_path, monkeypatch, run_of).make()


@pytest.mark.parametrize("difference", ["shift", "main", "routine", "delay"])
def test_a_meeting_in_a_cell_with_another_effect_is_noticed(
    difference: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def run_of(task: Task) -> GroupRun:
        frame = task.group.frame or 0
        return LIKE._replace(**{difference: 0 if task.sleep or abs(frame) > 300 or task.group.round is None else 1})

    with pytest.raises(NotClosed, match="two runs of one meeting differ"):
        invented(tmp_path, monkeypatch, run_of).make()


def test_a_frame_in_the_middle_of_a_sample_with_another_effect_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The first runs of all groups have frames in the first or the last tick of a sample."""

    def run_of(task: Task) -> GroupRun:
        return LIKE._replace(delay=int(1 < task.offset < SAMPLE - 2))

    with pytest.raises(NotClosed, match="two runs of one meeting differ"):
        invented(tmp_path, monkeypatch, run_of).make()


def test_frames_in_the_last_tick_of_a_sample_are_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """They have another effect if they are alone, or if they are not."""
    monkeypatch.setattr(PairMaker, "_again", lambda maker: None)
    for is_alone in (True, False):

        def run_of(task: Task, alone: bool = is_alone) -> GroupRun:
            return LIKE._replace(delay=int(task.offset == SAMPLE - 1 and (task.group.round is None) == alone))

        with pytest.raises(NotClosed, match="two runs of one meeting differ"):
            invented(tmp_path, monkeypatch, run_of).make()


def test_the_longest_group_determines_the_least_distance_of_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Within a cell, the rest can come later by a step of `FreeRun.settle`, which is 7 ticks here."""
    longest = Group(50, None)
    maker = invented(tmp_path, monkeypatch, lambda task: LIKE._replace(length=1234 if task.group == longest else 1000))
    assert maker.make().apart == 1234 + 1 + 7


def test_results_of_budgets_in_runs_of_groups_are_in_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A run judges no budget that lacks values in a round of a kind, or that has no value in all kinds of groups."""
    maker = invented(tmp_path, monkeypatch, lambda task: LIKE)
    one, two = done_of([]), done_of([])
    one.lacking, one.empty, one.unknowns, one.data_use = {"few"}, {("rounds", "none")}, {"option"}, "a branch"
    two.spanning, two.empty = {"long"}, {("frames", "none"), ("frames", "some")}
    for done in (one, two):
        maker._add(done)
    table = maker.table
    assert (table.lacking, table.spanning, table.data_use) == ({"few", "none"}, {"long"}, "a branch")
    assert maker.covered.unknowns == {"option"}


def test_an_orbit_that_two_calls_find_is_added_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The first call finds the orbit at cycle 3 of the known one. The states of the new one begin at another cycle."""
    maker = invented(tmp_path, monkeypatch, lambda task: LIKE)
    known, new = maker._orbits.known[0], Orbit(tuple(bytes([number, 1]) for number in range(40)), 0)
    done = done_of([LIKE._replace(after=after, shift=20) for after in (0, 1, 2)])
    done.orbits = [Orbit(known.keys[3:] + known.keys[:3], 30), new]
    assert [(run.after, run.shift) for run in maker._add(done)] == [(0, 20), (0, 50), (1, 20)]
    assert maker._orbits.known == [known, new]
    maker._keep(0, Group(0, None), LIKE._replace(after=1))
    assert maker.known.ways == {0: {1: Group(0, None)}}


# Wrong tables that are noticed --------------------------------------------------------


def wrong_cells(by: int) -> Callable[[GroupRunner], Cells]:
    def find(runner: GroupRunner) -> Cells:
        cells = find_cells(runner)
        return cells._replace(first=(cells.first + by) % cells.period)

    return find


@compiled_only
def test_a_wrong_beginning_of_the_cells_leads_to_a_contradiction(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Frames of one supposed cell are received at two instants."""
    monkeypatch.setattr(pair_table, "find_cells", wrong_cells(30))
    with pytest.raises(NotClosed, match=r"differ|have different effects|not reached again"):
        prove(Job(str(write_lonely(tmp_path))))


@compiled_only
def test_an_effect_of_a_frame_within_a_wait_is_noticed(tmp_path: Path):
    """The routine counts in XT, which nothing else uses, so each frame leads to another orbit."""
    counts = ("          MOVW  DP,#PIEACK >> 6\n          MOV   @PIEACK", "          ADD   @_count,#1\n")
    path = write_lonely(tmp_path)
    text = (path.parent / "imu.asm").read_text(encoding="utf-8")
    text = text.replace("_magnetometer:  .space 8\n", "_magnetometer:  .space 8\n_count:    .space 1\n")
    text = text.replace(counts[0], f"          MOVW  DP,#_count >> 6\n{counts[1]}{counts[0]}")
    (path.parent / "imu.asm").write_text(text, encoding="utf-8")
    with pytest.raises(NotClosed, match="there are more than 24 states of rest, apart from the clocks"):
        prove(Job(str(path)))


# Cases that are refused ---------------------------------------------------------------

ACK = "          MOV   @PIEACK,#0x100    ; group 9\n"
WAIT = "asked:    TBIT  @I2CSTR,#AAS\n"


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (
            ACK,
            ACK + "          MOVW  DP,#GPBSET >> 6\n          MOV   @GPBSET,#MODEL_PIN\n",
            "its service routine accesses dsp W GPIO.GPBSET",
        ),
        (
            ACK,
            ACK + "          MOVW  DP,#SCIRXBUF >> 6\n          MOV   @SCIRXBUF + 2,#1\n",
            "it sends: dsp W SCI-A.SCITXBUF",
        ),
        (
            ACK,
            ACK + "          MOVW  DP,#0x440 >> 6\n          MOV   AL,@0x450\n",
            r"_sci_received \(imu.asm:\d+, 0x\w+\) reads 0x0450 on the stack, which it has not written",
        ),
        (
            WAIT,
            "asked:    MOVW  DP,#GPBSET >> 6\n          MOV   AH,@GPADAT\n          MOVW  DP,#I2CMDR >> 6\n"
            "          TBIT  @I2CSTR,#AAS\n",
            "it depends on dsp R GPIO.GPADAT, which shows the line of the frame",
        ),
        (
            WAIT,
            "asked:    MOVW  DP,#SCICCR >> 6\n          MOV   AH,@SCIFFRX\n          MOVW  DP,#I2CMDR >> 6\n"
            "          TBIT  @I2CSTR,#AAS\n",
            "it accesses dsp R SCI-A.SCIFFRX outside of the service routine",
        ),
        (
            WAIT,
            "asked:    TBIT  @I2CSTR,#12       ; BB\n          SB    quiet,NTC\n          EALLOW\n"
            "          MOVW  DP,#0x6F80 >> 6\n          MOV   @0x6F80,#0\n          EDIS\n"
            "          MOVW  DP,#I2CMDR >> 6\nquiet:    TBIT  @I2CSTR,#AAS\n",
            "it accesses dsp W GPIO.GPACTRL, which can change how the frame is received",
        ),
        (
            ACK,
            ACK + "          MOVW  DP,#GPBSET >> 6\n          MOV   AH,@GPADAT\n",
            "its service routine accesses dsp R GPIO.GPADAT",
        ),
        (
            ACK,
            ACK + "          EALLOW\n          MOVW  DP,#0x6F80 >> 6\n          MOV   @0x6F80,#0\n          EDIS\n",
            "its service routine accesses dsp W GPIO.GPACTRL",
        ),
        (ACK, ACK + "          MOV   AH,@PIEACK + 2\n", "its service routine accesses dsp R PIE.PIEIFR1"),
    ],
)
def test_firmware_that_notices_more_of_a_frame_is_refused(old: str, new: str, reason: str, tmp_path: Path):
    start = ("_start_pin:", "_start_pin: MOVW DP,#0x440 >> 6\n          MOV   @0x450,#5  ; on the stack\n")
    covered = within_round(CoveredCase(Job(str(write_lonely(tmp_path, (old, new), start)))))
    with pytest.raises(NotClosed, match=reason):
        pair = PairRun(covered, check(covered.case, with_pairs=True), Known(Orbits(), None, {}))
        find_cells(pair.runner)
        pair.run(Task(pair.runner.at[0], Group(0, None), 0, None))


FLAG = """asked:    MOVW  DP,#_taken >> 6
          MOV   AL,@_taken
          SB    asked,EQ
          MOV   @_taken,#0
          MOVW  DP,#I2CMDR >> 6
          TBIT  @I2CSTR,#12       ; BB
          TBIT  @I2CSTR,#AAS
"""
SETS = "          MOVW  DP,#_taken >> 6\n          MOV   @_taken,#1\n"


def test_a_wait_for_a_variable_is_refused(tmp_path: Path):
    wait = "flagged:  MOVW  DP,#_taken >> 6\n          CMP   @_taken,#9\n          SB    flagged,NEQ\n"
    with pytest.raises(NotClosed, match=r"waits at _serve \(imu.asm:\d+, 0x\w+\) without reading a register, and such"):
        runner_of(write_lonely(tmp_path, (WAIT, f"{wait}          MOVW  DP,#I2CMDR >> 6\n{WAIT}")))


@compiled_only
def test_a_wait_that_the_routine_ends_has_no_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The routine sets a flag, and the firmware then reads I2CSTR, whose value depends on the time of the routine."""
    end = "          MOVW  DP,#PIEACK >> 6\n          MOV   @PIEACK,#0x100    ; group 9\n"
    path = write_lonely(tmp_path, (WAIT, FLAG), (end, SETS + end))
    runner = runner_of(path)
    assert runner.cells is not None
    ((_, _, sleep),) = far_ranges(runner.sleeps(Group(0, None)), runner.cells, runner.cycle)
    assert sleep.end == NEVER
    near = next(d for d in range(PASS) if runner.rounds_in(runner.orbits.known[runner.at[0]], 0, d))
    assert not runner.run_group(Group(0, near), 0, sleep).within
    monkeypatch.setattr(pair_table, "MOST_SHRINKS", 1)
    with pytest.raises(NotClosed, match="service routines of the SCI within one wait have different effects"):
        prove(Job(str(path)))


def test_only_events_that_no_frame_moves_are_judged(tmp_path: Path):
    """A pin that can be RX, variables, reads and flags within a frame can move within a cell."""
    path = write_lonely(tmp_path)
    texts = {
        "irq to stop": "from interrupt SCIRXINTA enter to bus STOP, next",
        "own": "from access W I2C-A.I2CMDR to bus START, next",
        "reads": "from bus START to access R I2C-A.I2CSTR, next",
        "words": "from flag SCI-A.SCIFFRX.RXFFST = 7 to flag SCI-A.SCIFFRX.RXFFST = 8, next",
        "variable": "from variable _taken = 1 to bus START, next",
        "pin": "from edge MODEL rise to edge MODEL fall, next",
        "line by name": "from edge LINE fall to edge LINE rise, next",
        "pie": "from access W PIE.PIEACK to interrupt SCIRXINTA enter, next",
        "first": "interrupt latency SCIRXINTA to first access",
        "numbered": "from 1st access R SCI-A.SCIFFRX of transfer to interrupt SCIRXINTA leave, next",
        "edges": "from edge SCL fall to edge SCL rise, next",
        "in the routine": "from 1st bus address of interrupt SCIRXINTA to bus STOP, next",
        "given": "from bus START to bus STOP, next, given 1st bus address of interrupt SCIRXINTA",
        "unless": "from bus START to bus STOP, next, unless edge RX fall",
    }
    budgets = [f'\n[[budget]]\nname = "{name}"\nmeasure = "{text}"\nmax = "1 s"\n' for name, text in texts.items()]
    text = path.read_text(encoding="utf-8") + "".join(budgets)
    path.write_text(text.replace('"GPIO"]\n', '"GPIO"]\npins = { MODEL = 34, LINE = 28 }\n', 1), encoding="utf-8")
    covered = within_round(CoveredCase(Job(str(path))))
    assert {budget.name for budget in covered.case.budget} == {"latency", "service", "own", "pin", "edges"}
    assert covered.left_out["numbered"] == covered.left_out["irq to stop"]
    assert covered.left_out["in the routine"] == covered.left_out["given"] == covered.left_out["irq to stop"]
    assert covered.left_out["unless"] == "a frame can move 'edge RX fall' in a way that is not run"
    assert covered.left_out["irq to stop"] == "it relates the service routine of the SCI to other events"
    assert covered.left_out["reads"] == "a frame can move 'access R I2C-A.I2CSTR' in a way that is not run"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ("host.jitter=1 ms", "host.jitter moves the first start"),
        ("controller.jitter=1 ms", "controller.jitter moves the first start"),
        ("controller.first=12.000001 ms", "its rounds do not start with cycles of the CPU"),
        ("controller.ppm=30", "its rounds do not start with cycles of the CPU"),
    ],
)
def test_a_case_whose_starts_are_not_those_of_the_table_is_refused(change: str, reason: str, tmp_path: Path):
    with pytest.raises(NotClosed, match=reason):
        prove(Job(str(write_lonely(tmp_path)), (change,)))


@pytest.mark.parametrize(("pin", "wire"), [("RX = 34", "RX"), ("SCL = 28", "SCL"), ("RX = 32", "RX")])
def test_a_second_pin_at_a_wire_is_refused(pin: str, wire: str, tmp_path: Path):
    path = write_lonely(tmp_path)
    path.write_text(
        path.read_text(encoding="utf-8").replace('"GPIO"]\n', f'"GPIO"]\npins = {{ {pin} }}\n'), encoding="utf-8"
    )
    with pytest.raises(NotClosed, match=f"unit dsp has 2 pins at the wire {wire}"):
        prove(Job(str(path)))


def test_an_external_interrupt_is_refused(tmp_path: Path):
    enable = "XINT1CR   .set 0x7070\n_start_pin: MOVW DP,#XINT1CR >> 6\n          MOV   @XINT1CR,#1\n"
    path = write_lonely(tmp_path, ("_start_pin:", enable))
    path.write_text(path.read_text(encoding="utf-8").replace('"GPIO"]\n', '"GPIO", "XINT"]\n'), encoding="utf-8")
    with pytest.raises(NotClosed, match="an external interrupt is enabled"):
        prove(Job(str(path)))


def test_frames_before_a_late_first_round_are_not_in_the_table(tmp_path: Path):
    """Between the first frame, at 9 ms, and the first round come two further frames, which are in no group.

    The first run is 400 ticks later than the others at its first group, since it adds the orbit before.
    """
    maker = maker_of(Job(str(write_lonely(tmp_path)), ("controller.first=52 ms",)))
    maker.explore()
    assert 52 * 10**6 < maker.table.first_rest < 60 * 10**6
    assert maker.table.apart == maker.table.first_rest + 400 - 9 * 10**6 + 1
    assert maker.covered.phases.least_distance() == 20 * 10**6


def test_the_scene_of_a_runner_is_released(tmp_path: Path):
    runner = runner_of(write_lonely(tmp_path))
    scene = ref(runner.run.scene)
    del runner
    gc.collect()
    assert scene() is None
