"""Tables of states and starts: closed tables, their worst values, and contradictions in a table of too few states.

The scene of most tests is the SCI echo at 100 MHz and 1.56 Mbit/s: SCICLK has a period of 8 cycles, a pass of the
echo's wait one of 10, and a cycle has 10 ticks. So a period of the rest has 400 ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.proof import closed_table, free_run
from periph_sim.proof.closed_table import Contradiction, RestPlace, StartTable, TableEntry, TableMaker
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.normal_state import NormalState, normal_state
from periph_sim.proof.stretch import CoveredCase, Job
from periph_sim.proof.table_proof import Part, TableProof, WorstInProof
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import Verdict
from tests.scene.runs import TIMING

FIRMWARE = Path(__file__).parents[2] / "firmware" / "c28x"
PERIOD = 400
ECHO = """
name = "fast_echo"
start = "3 ms"
duration = "8 ms"

[unit.dsp]
oscclk = "20 MHz"
image = "echo.asm"
modules = ["SCI-A", "GPIO"]

[host]
baud = 1562500
first = "8 ms"
period = "20 ms"
motion = {{ kind = "static" }}

[[budget]]
name = "echo"
measure = "from frame RX end to frame TX begin, in order"
max = "{limit} us"
"""


def covered(path: Path, *changes: str) -> CoveredCase:
    return CoveredCase(Job(str(path), changes))


def made(path: Path, *changes: str) -> StartTable:
    return TableMaker(covered(path, *changes)).make()


def write_echo(folder: Path, limit: float = 1.0, *changes: tuple[str, str]) -> Path:
    """Write a case of the fast echo, and return its path. limit: in us. changes: replacements in its firmware."""
    firmware = (FIRMWARE / "sci_echo.asm").read_text(encoding="utf-8")
    for old, new in [("BRR       .set  40 ", "BRR       .set  1 "), *changes]:
        assert old in firmware
        firmware = firmware.replace(old, new)
    (folder / "echo.asm").write_text(firmware, encoding="utf-8")
    file = folder / "echo.toml"
    file.write_text(ECHO.format(limit=limit), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[CoveredCase, StartTable]:
    """Return the case of the fast echo, and its closed table."""
    case = covered(write_echo(tmp_path_factory.mktemp("whole")))
    return case, TableMaker(case).make()


def proof(case: CoveredCase, table: StartTable) -> TableProof:
    return TableProof(case, None, [Part(case, table, ())])


def worst_of(case: CoveredCase, table: StartTable) -> float:
    worst = proof(case, table).worst()["echo"].verdict.worst
    assert worst is not None
    return worst


def test_a_table_is_closed_when_each_start_was_run_from_each_state(whole: tuple[CoveredCase, StartTable]):
    case, table = whole
    assert (table.orbits, table.entries, table.has_failed) == ([PERIOD], PERIOD, False)
    assert table.again == closed_table.LEAST_REVISITED
    assert table.not_proven(case, table.apart) == {}


def test_no_ordinary_run_is_worse_than_the_table_and_some_are_as_bad(whole: tuple[CoveredCase, StartTable]):
    """The frames of these runs start at random ticks, from the least distance of the table on."""
    case, table = whole
    random, per_second = Random(5), case.phases.ticks_per_second
    seen = []
    for _ in range(40):
        starts = [case.phases.first_start]
        for _ in range(20):
            starts.append(starts[-1] + table.apart + random.randrange(per_second // 1000))
        inputs = InputsTable(frames=tuple(Fraction(start, per_second) for start in starts))
        duration = Fraction(starts[-1] + table.apart, per_second)
        result = Scene(case.case.model_copy(update={"inputs": inputs, "duration": duration})).run()
        (worst,) = [verdict.worst for verdict in result.budgets]
        assert worst is not None
        seen.append(worst)
    assert max(seen) == worst_of(case, table)
    assert min(seen) < worst_of(case, table)


def test_a_limit_just_below_the_worst_value_is_broken(whole: tuple[CoveredCase, StartTable], tmp_path: Path):
    case = covered(write_echo(tmp_path, round(worst_of(*whole) - 0.001, 3)))
    broken = TableMaker(case).make()
    assert broken.has_failed
    assert proof(case, broken).worst()["echo"].verdict.broken


@pytest.mark.parametrize(
    ("at_s", "rounds", "run"),
    [
        (50, [], ((100,), None, 199)),
        (150, [], ((100,), None, 199)),
        (199, [], ((100,), None, 199)),
        (200, [], ((100, 200), None, 249)),
        (None, [], ((100, 200), None, 249)),
        (110, [[120, 300]], ((100,), (120,), 199)),
    ],
)
def test_the_run_of_a_worst_value_ends_before_a_later_start(at_s: float | None, rounds: list[list[int]], run: object):
    """With both rounds and frames, the next start can belong to the same group. The least distance is 50 ticks."""
    table = StartTable([], 0, 0, 50, 0, False, [], [[100, 200]], set(), set(), rounds)
    verdict = Verdict("x", "x", "us", 1, 2, 1, 1, "pass", at_s)
    case: Any = SimpleNamespace(phases=SimpleNamespace(ticks_per_second=1))
    found = WorstInProof(Part(case, table, ("seed=7",)), 0, verdict).run()
    assert (found.worst, found.changes) == (verdict, ("seed=7",))
    assert (found.starts, found.rounds, found.until) == run


def test_the_register_slave_has_a_closed_table(monkeypatch: pytest.MonkeyPatch):
    """It sleeps in IDLE, so only the four cycles of LSPCLK repeat. Four runs are necessary to run 200 entries again."""
    monkeypatch.setattr(closed_table, "ROUNDS_A_RUN", 60)
    path = TIMING / "variants" / "image_register_slave.toml"
    case, begun = covered(path), list[Sequence[RestPlace]]()
    maker = TableMaker(case, on_run=lambda run, places: begun.append(places))
    table = maker.make()
    assert (table.orbits, table.entries, table.again, table.has_failed) == ([80], 80, 200, False)
    assert table.not_proven(case, table.apart) == {}
    assert len({place.tick for places in begun[-4:] for place in places}) > 60  # of those that were run again
    length = min(entry.length for entry in maker.entries.values())
    assert {(two - one - length) // 80 for one, two in pairwise(table.starts[-1])} == {0, 1, 2}  # rests, in periods


def test_what_measures_note_at_rests_is_in_the_table(monkeypatch: pytest.MonkeyPatch):
    """A budget without a value in a round is lacking, too."""
    finished: list[object] = []
    measures = SimpleNamespace(spanning={"long"}, lacking={"few"}, empty={("rounds", "none")}, finish=finished.append)
    measures.rest = lambda now, starts=(): None
    monkeypatch.setattr(closed_table, "MeasuresAtRest", lambda limits: measures)
    monkeypatch.setattr(closed_table, "ROUNDS_A_RUN", 2)
    maker = TableMaker(covered(TIMING / "variants" / "image_register_slave.toml"))
    maker._run(again=0)
    assert (maker.table.spanning, maker.table.lacking, len(finished)) == ({"long"}, {"few", "none"}, 1)


class Repeating:
    """A run at rest whose state follows from the cycle. A cycle has 10 ticks."""

    ticks_per_cycle = 10
    scene = None

    def __init__(self, value_at: Callable[[int], object], cycle: int = 0) -> None:
        self._value_at, self.cycle = value_at, cycle

    def state(self) -> NormalState:
        return {"value": self._value_at(self.cycle)}

    def next_cycle(self) -> None:
        self.cycle += 1

    def not_repeating(self, *states: NormalState) -> NotClosed:
        return NotClosed("it does not repeat")


def test_an_orbit_has_each_state_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The clocks repeat after 40 cycles, and the states after 10. A state of the start-up comes before some of them."""
    monkeypatch.setattr(closed_table, "period_of", lambda scene: 40)
    maker = TableMaker(covered(write_echo(tmp_path)))

    def place(value_at: Callable[[int], object], cycle: int = 0) -> RestPlace:
        run: Any = Repeating(value_at, cycle)
        return maker._place(run)

    assert [place(lambda cycle: cycle % 10, cycle) for cycle in (0, 3, 9)] == [RestPlace(0, at) for at in (0, 30, 90)]
    assert place(lambda cycle: cycle % 10 if cycle > 4 else "start-up") == RestPlace(0, 50)
    assert (maker.table.orbits, maker._open) == ([100], [[*range(100)]])
    with pytest.raises(NotClosed, match="it does not repeat"):
        place(lambda cycle: ("other", cycle % 11))


def test_runs_are_made_until_no_orbit_has_an_entry_that_was_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    left = [[[1], [3]], [[], [3]], [[], []]]  # after each run, the ticks of the open entries of two orbits
    maker = TableMaker(covered(write_echo(tmp_path)), least_again=0)

    def run(again: int) -> None:
        maker.table.orbits, maker._open = [20, 20], left.pop(0)
        maker.entries[RestPlace(0, len(left))] = TableEntry(RestPlace(0, 0), 100, 5)

    monkeypatch.setattr(maker, "_run", run)
    maker.make()
    assert left == []


@pytest.mark.parametrize("rests_first", [True, False])
def test_the_least_distance_of_starts_is_a_tick_longer_than_the_longest_round(
    rests_first: bool, monkeypatch: pytest.MonkeyPatch
):
    """The first round of the case is the longest. With a free first start, it is a round like the others."""
    monkeypatch.setattr(closed_table, "ROUNDS_A_RUN", 3)
    case = covered(TIMING / "variants" / "image_register_slave.toml", 'controller.first="12 ms"')
    maker = TableMaker(case, rests_first=rests_first)
    maker._run(again=0)
    table, length = maker.table, min(entry.length for entry in maker.entries.values())
    first = table.first_rest - table.starts[0][0]
    assert rests_first or first > length
    assert table.apart == 1 + (length if rests_first else first)


def test_budgets_that_do_not_follow_from_single_rounds_of_the_table_are_not_proven():
    """The first starts of the runs are at ticks 60 and 50."""
    names = ["proven", "from the first", "late", "long", "few", "far"]
    further: dict[str, list[str]] = {name: [] for name in names} | {"far": ["the next round", "the whole run"]}
    not_before = dict.fromkeys(names, 0) | {"from the first": 50, "late": 51}
    case: Any = SimpleNamespace(
        phases=SimpleNamespace(least_distance=lambda within: 100, ticks_per_second=10**9),
        case=SimpleNamespace(budget=[SimpleNamespace(name=name) for name in names]),
        not_before=lambda: not_before,
        looks_further=lambda: further,
    )
    table = StartTable([], 0, 0, 100, 0, False, [], [[60], [50]], {"long"}, {"few"})
    assert table.not_proven(case, 100) == {
        "late": "its `after` leaves out rounds of the table",
        "long": "an occurrence of it lasts from one round to the next",
        "few": "a round has too few measured values, and a run of such rounds is not judged",
        "far": "its values depend on the next round",
    }
    reason = "the case has starts that are less than 0.0002 ms apart"  # 101 ns
    assert table.not_proven(case, 101) == dict.fromkeys(names, reason)


# States without some parts ---------------------------------------------------------


@pytest.mark.parametrize(
    ("orbit", "tick", "length", "records", "is_like"),
    [
        (0, 390, 100, 5, True),
        (0, 5, 115, 5, True),  # the rest begins 15 ticks later, in a period of 400 ticks
        (0, 5, 100, 5, False),
        (0, 390, 115, 5, False),
        (0, 390, 100, 6, False),
        (1, 390, 100, 5, False),
    ],
)
def test_two_runs_of_an_entry_end_in_the_same_state(
    orbit: int, tick: int, length: int, records: int, is_like: bool, tmp_path: Path
):
    maker = TableMaker(covered(write_echo(tmp_path)))
    maker.table.orbits = [PERIOD, PERIOD]
    entries = TableEntry(RestPlace(0, 390), 100, 5), TableEntry(RestPlace(orbit, tick), length, records)
    with nullcontext() if is_like else pytest.raises(Contradiction, match="orbit 0, tick 7"):
        maker._compare(RestPlace(0, 7), *entries)


def without(names: Sequence[str]) -> Callable[..., NormalState]:
    """Return a function like `normal_state` that leaves out some parts of the state."""

    def coarser(scene: Scene, ignored: Sequence[str] = ()) -> NormalState:
        state = normal_state(scene, ignored)
        for name in names:
            assert name in state
            state[name] = None
        return state

    return coarser


CLOCKS = ["dsp.SCI-A.chip._rx_clock._cycle", "dsp.SCI-A.chip._tx_clock._cycle", "dsp.SYS.chip.lspclk_phase"]


@pytest.mark.parametrize("names", [["dsp.program.cpu.polls.began"], CLOCKS])
def test_a_state_without_a_phase_leads_to_a_contradiction(
    names: Sequence[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """States that differ in the phase of the wait, or of SCICLK, are taken as equal, but their rounds differ."""
    monkeypatch.setattr(free_run, "normal_state", without(names))
    with pytest.raises(Contradiction, match="fast_echo: two rounds from equal states differ"):
        made(write_echo(tmp_path))


def test_a_phase_that_follows_from_the_rest_of_the_state_can_be_left_out(
    whole: tuple[CoveredCase, StartTable], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The clock of the receiver is in phase with that of the transmitter."""
    monkeypatch.setattr(free_run, "normal_state", without(CLOCKS[:1]))
    case = covered(write_echo(tmp_path))
    table = TableMaker(case).make()
    assert (table.orbits, worst_of(case, table)) == (whole[1].orbits, worst_of(*whole))


# Cases that are refused --------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "changes", "reason"),
    [
        (
            "responder",
            (),
            "unit dsp runs Python firmware, which has a part of its state on a stack",
        ),
        (
            "variants/image_sci_echo",
            ("unit.dsp.ppm=1",),
            "unit.dsp.ppm is not 0, so a cycle is not a whole number of ticks",
        ),
        ("imu_hil_image", (), "rounds and frames start independently of each other"),
        ("variants/image_sci_echo", (), "the bytes of the frames differ; add motion"),
    ],
)
def test_a_case_without_a_table_is_refused_with_the_reason(name: str, changes: tuple[str, ...], reason: str):
    with pytest.raises(NotClosed) as refused:
        made(TIMING / f"{name}.toml", *changes)
    assert str(refused.value).startswith(reason)


def test_a_case_whose_starts_are_closer_than_those_of_the_table_is_not_proven(whole: tuple[CoveredCase, StartTable]):
    case, table = whole
    closer = covered(Path(case.case.file), "host.period=2 ms")
    assert table.not_proven(closer, table.apart) == {"echo": "the case has starts that are less than 2.1001 ms apart"}
    jitter = covered(Path(case.case.file), "host.period=10 ms", "host.jitter=9 ms")
    assert set(table.not_proven(jitter, table.apart)) == {"echo"}


class Announced(Exception):
    """Ends a table when its number of entries is announced."""


@pytest.mark.parametrize(("rests_first", "entries"), [(False, PERIOD), (True, 2 * PERIOD)])
def test_a_second_orbit_is_expected_if_the_first_start_is_free(rests_first: bool, entries: int, tmp_path: Path):
    def announce(number: int, seconds: float) -> None:
        raise Announced(number)

    with pytest.raises(Announced, match=f"^{entries}$"):
        TableMaker(covered(write_echo(tmp_path), 'host.first="12 ms"'), None, announce, None, rests_first).make()


def test_firmware_that_counts_does_not_close(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Register AH is different after each character, so each round leads to a new orbit."""
    monkeypatch.setattr(closed_table, "MAX_ENTRIES", 5 * PERIOD)
    counts = ("          MOV   @SCITXBUF,AL\n", "          MOV   @SCITXBUF,AL\n          ADD   @AH,#1\n")
    with pytest.raises(NotClosed, match="the table would have more than 2,000 entries"):
        made(write_echo(tmp_path, 1.0, counts))


def test_firmware_that_serves_the_watchdog_is_refused(tmp_path: Path):
    serves = "          EALLOW\n          MOVW  DP,#0x7025 >> 6\n          MOV   @0x25,#0x55\n          EDIS\n"
    serves += "          MOVW  DP,#SCICCR >> 6\n"
    change = ("          MOV   @SCITXBUF,AL\n", "          MOV   @SCITXBUF,AL\n" + serves)
    with pytest.raises(NotClosed, match=r"the firmware accesses dsp W SYS\.WDKEY"):
        made(write_echo(tmp_path, 2.0, change))
