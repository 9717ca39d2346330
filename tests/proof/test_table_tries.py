"""Attempts to make a table claim too much: measures and cases of which a value does not follow from one round.

Each attempt states the word that the table must give to a budget, or the reason why the case is refused.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from periph_sim.proof import closed_table
from periph_sim.proof.closed_table import StartTable, TableMaker
from periph_sim.proof.free_run import FreeRun, NotClosed
from periph_sim.proof.measures_at_rest import MeasuresAtRest
from periph_sim.proof.stretch import CoveredCase
from periph_sim.proof.table_cases import check
from periph_sim.proof.table_proof import Part, TableProof
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.proof.proven_slave import write_slave
from tests.proof.test_closed_table import covered, made, write_echo
from tests.scene.runs import TIMING

SLAVE = TIMING / "variants" / "image_register_slave.toml"
LASTS = "an occurrence of it lasts from one round to the next"
NEXT = "its values depend on the start of the next round"
AFTER = "its `after` leaves out rounds of the table"
ECHOED = "from frame RX end to frame TX begin, in order"

# Budgets as (name, measure, limit), and for each name the expected reason; "" if the budget must be proven.
ECHO_BUDGETS = [
    ("pause", "from last frame TX end of burst to first frame RX begin of burst", 'max = "3 ms"'),
    ("whole burst", "from last frame RX end of burst to frame TX end, next", 'max = "30 us"'),
    ("whole burst in order", "from last frame RX end of burst to frame TX end, in order", 'max = "30 us"'),
    ("level", "level of SCI-A.SCICTL2.TXRDY at frame RX begin", "max = 1"),
    ("late echo", ECHOED, 'max = "1 us"\nafter = "300 ms"'),
    ("early echo", ECHOED, 'max = "1 us"\nafter = "7 ms"'),
]
ECHO_REASONS = dict.fromkeys(("echo", "whole burst", "whole burst in order", "level", "early echo"), "")
ECHO_REASONS |= {"pause": LASTS, "late echo": AFTER}
SLAVE_BUDGETS = [
    ("slack", "slack", 'min = "3 ms"'),
    ("own slack", "from record round end to record round next", 'min = "3 ms"'),
    ("stop to start", "from last bus STOP of round to bus START, next", 'max = "4 ms"'),
    ("byte to start", "from last bus byte of round to bus START", 'max = "4 ms"'),
    ("rest", "each time in bus free", 'max = "4 ms"'),
    ("gap", "gap between rounds", 'max = "4 ms"'),
    ("round", "round", 'max = "3 ms"'),
    ("reaction", "reaction", 'max = "1 us"\ncoverage = "40 %"'),
    ("lost", "lost flags", "max = 0"),
]
SLAVE_REASONS = {
    "wrong bytes": "",
    "slack": NEXT,
    "own slack": NEXT,
    "stop to start": LASTS,
    "byte to start": LASTS,
    "rest": LASTS,
    "gap": LASTS,
    "round": "",
    "reaction": "",
    "lost": "its values depend on the whole run",
}


def with_budgets(text: str, budgets: list[tuple[str, str, str]]) -> str:
    for name, measure, limit in budgets:
        text += f'\n[[budget]]\nname = "{name}"\nmeasure = "{measure}"\n{limit}\n'
    return text


def table_of(path: Path) -> tuple[CoveredCase, StartTable]:
    """Return a case and its table. Few entries are run again, because the tests of this file need no comparison."""
    case = covered(path)
    return case, TableMaker(case, least_again=10).make()


@pytest.fixture(scope="module")
def echo(tmp_path_factory: pytest.TempPathFactory) -> tuple[CoveredCase, StartTable]:
    file = write_echo(tmp_path_factory.mktemp("echo"))
    file.write_text(with_budgets(file.read_text(encoding="utf-8"), ECHO_BUDGETS), encoding="utf-8")
    return table_of(file)


@pytest.fixture(scope="module")
def slave(tmp_path_factory: pytest.TempPathFactory) -> tuple[CoveredCase, StartTable]:
    firmware = (TIMING / ".." / "firmware" / "c28x").resolve().as_posix()
    file = tmp_path_factory.mktemp("slave") / "slave.toml"
    text = SLAVE.read_text(encoding="utf-8").replace("../../firmware/c28x", firmware)
    file.write_text(with_budgets(text, SLAVE_BUDGETS), encoding="utf-8")
    return table_of(file)


def worst_of_run(case: CoveredCase, distances: list[int]) -> dict[str, float | None]:
    """Return the worst values of an ordinary run. distances: the distances of its starts, in ticks."""
    starts = [case.phases.first_start]
    for distance in distances:
        starts.append(starts[-1] + distance)
    per_second = case.phases.ticks_per_second
    times = tuple(Fraction(start, per_second) for start in starts)
    inputs = InputsTable(frames=times) if case.phases.moved == "frames" else InputsTable(rounds=times)
    end = Fraction(starts[-1] + distances[-1], per_second)
    result = Scene(case.case.model_copy(update={"inputs": inputs, "duration": end})).run()
    return {verdict.name: verdict.worst for verdict in result.budgets}


def word(reason: str) -> str:
    return "held" if reason else "proven"


@pytest.mark.parametrize("name", ECHO_REASONS)
def test_budgets_on_frames(name: str, echo: tuple[CoveredCase, StartTable]):
    case, table = echo
    assert table.not_proven(case, table.apart).get(name, "") == ECHO_REASONS[name]
    assert TableProof(case, None, [Part(case, table, ())]).words()[name] == word(ECHO_REASONS[name])


@pytest.mark.parametrize("name", SLAVE_REASONS)
def test_budgets_on_rounds(name: str, slave: tuple[CoveredCase, StartTable]):
    case, table = slave
    assert table.not_proven(case, table.apart).get(name, "") == SLAVE_REASONS[name]
    assert TableProof(case, None, [Part(case, table, ())]).words()[name] == word(SLAVE_REASONS[name])


def test_ordinary_runs_break_budgets_that_held_in_the_table(
    echo: tuple[CoveredCase, StartTable], slave: tuple[CoveredCase, StartTable]
):
    """A long pause breaks budgets on the time between rounds, and rounds that are close together break the slack."""
    for (case, table), name in ((echo, "pause"), (slave, "stop to start"), (slave, "byte to start")):
        long = worst_of_run(case, [case.phases.ticks_per_second // 10] * 3)[name]
        worst = TableProof(case, None, [Part(case, table, ())]).worst()[name]
        assert long is not None and long > worst.verdict.limit
    case, table = slave
    short = worst_of_run(case, [table.apart] * 3)["slack"]
    worst = TableProof(case, None, [Part(case, table, ())]).worst()["slack"]
    assert short is not None and short < worst.verdict.limit


SLOW_FIRST = """addressed:
          CMP   @AR6,#0
          SB    known,NEQ
          MOV   @AR6,#1
          MOV   AH,#60000
delay:    DEC   @AH
          SB    delay,NEQ
known:
"""


def test_the_least_distance_contains_the_first_round(tmp_path: Path):
    """The firmware holds SCL for 2 ms when it is addressed for the first time, so the second start is later."""
    firmware = TIMING / ".." / "firmware" / "c28x"
    source = (firmware / "register_slave.asm").read_text(encoding="utf-8")
    assert "addressed:\n" in source
    (tmp_path / "slow.asm").write_text(source.replace("addressed:\n", SLOW_FIRST), encoding="utf-8")
    for name in ("f28335.inc", "start.inc"):
        (tmp_path / name).write_text((firmware / name).read_text(encoding="utf-8"), encoding="utf-8")
    text = SLAVE.read_text(encoding="utf-8").replace("../../firmware/c28x/register_slave.asm", "slow.asm")
    (tmp_path / "slow.toml").write_text(text, encoding="utf-8")
    case, table = table_of(tmp_path / "slow.toml")
    assert table.apart / case.phases.ticks_per_second > 0.0055


# Rounds with too few values ---------------------------------------------------------


def judge(occasions: list[tuple[int, int]], coverage: Fraction = Fraction(9, 10)) -> Any:
    """Return a judge whose measure counts these numbers of measured values and occasions, one pair at each rest."""
    pairs = iter(occasions)
    measure = SimpleNamespace(measured=0, occasions=0, series=True)

    def unfinished(now: int) -> list[tuple[int, int]]:
        measure.measured, measure.occasions = next(pairs)
        return []

    measure.unfinished = unfinished
    return SimpleNamespace(measure=measure, budget=SimpleNamespace(name="read", coverage=coverage))


@pytest.mark.parametrize(
    ("occasions", "lacking"),
    [
        ([(10, 10), (20, 20)], False),
        ([(9, 10), (18, 20)], False),
        ([(99, 100), (199, 200), (199, 201)], True),
        ([(0, 0), (0, 0)], False),
    ],
)
def test_a_budget_lacks_values_if_one_round_has_too_few(occasions: list[tuple[int, int]], lacking: bool):
    """A run with many rounds is judged although one of them has no value, but a run of only such rounds is not."""
    measures = MeasuresAtRest(cast(Any, [judge(occasions)]))
    for now in range(len(occasions)):
        measures.rest(now)
    assert measures.lacking == ({"read"} if lacking else set())


def test_a_run_that_is_not_judged_hides_its_values():
    """Without a rule for pairs, a second event that comes too late makes a run not judged, whatever its values are."""
    measures = MeasuresAtRest(cast(Any, []))
    measures._before = [(0, 0)]
    verdict = SimpleNamespace(name="echo", measured=0, occasions=None, count=7, passed=False, broken=False)
    measures._judges = [judge([])]
    measures.finish(cast(Any, [verdict]))
    assert measures.lacking == {"echo"}


# State of measures over a rest --------------------------------------------------------

# The service routine of SCI-A's receiver contains the polling loop, and never ends.
IN_A_ROUTINE = """          LCR   #_start_sci
          EALLOW
          MOVL  XAR4,#_echo
          MOVL  XAR5,#0x0DC0
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#0x0CE0 >> 6
          MOV   @0x20,#1          ; PIECTRL
          MOV   @0x32,#1          ; PIEIER9
          OR    IER,#0x100
          MOV   @0x21,#0xFFF
          CLRC  INTM
here:     IDLE
          SB    here,UNC
"""
SEND = "first:    LCR   #_send\n"
NTH = [("nth", "from 22nd frame RX end of interrupt SCIRXINTA to frame TX begin, next", 'max = "1 us"')]


def test_events_that_are_counted_in_a_service_routine_without_end(tmp_path: Path):
    """The 22nd frame of the routine comes once in a run, so the table measures it at a few starts only."""
    old = "          LCR   #_start_sci\n\n"
    file = write_echo(tmp_path, 1.0, (old, IN_A_ROUTINE), ("@SCICTL2,#0\n", "@SCICTL2,#2\n"))
    file.write_text(with_budgets(file.read_text(encoding="utf-8"), NTH), encoding="utf-8")
    case, table = table_of(file)
    assert table.not_proven(case, table.apart)["nth"] == LASTS


def test_a_byte_that_is_written_before_the_rest_and_sent_after_it(tmp_path: Path):
    """The slave writes the first byte of the next read at the end of a read."""
    case = write_slave(tmp_path, with_budgets("", [("margin", "margin of I2CDXR", 'max = "3 ms"')]))
    file = tmp_path / "register_slave.asm"
    text = file.read_text(encoding="utf-8")
    for old, new in (
        ("ended:    AND   @I2CIER", "ended:    LCR   #_send\n          AND   @I2CIER"),
        (
            "first:    LCR   #_send\n",
            "first:    TBIT  @I2CSTR,#XRDY\n          SB    full,NTC\n          LCR   #_send\nfull:\n",
        ),
    ):
        assert old in text
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")
    text = case.read_text(encoding="utf-8")
    requests = text[text.index("[[controller.request]]") : text.index("[[budget]]")]
    one = '[[controller.request]]\nname = "r"\naddress = 0x50\ncount = 1\n\n'
    case.write_text(text.replace(requests, one), encoding="utf-8")
    run = FreeRun(covered(case), closed_table.check(covered(case).case), False, False)
    measures = MeasuresAtRest(run.scene.limits)
    measures.rest(run.now)
    assert measures.spanning == {"margin"}


def test_the_first_start_of_a_case_with_jitter_is_free(tmp_path: Path):
    """Jitter moves the first frame, too. So the table begins with the first rest, which must come before it."""
    early = write_echo(tmp_path)
    with pytest.raises(NotClosed, match=r"must come after the firmware has been at rest for 2 ms"):
        made(early, "host.jitter=1 ms")
    late = covered(early, "host.jitter=1 ms", "host.first=10 ms")
    table = TableMaker(late, least_again=10).make()
    assert table.rests_first and table.first_rest < late.phases.first_start
    assert min(starts[0] for starts in table.starts) < late.phases.first_start


def test_rounds_that_are_late_by_their_jitter_are_not_proven(tmp_path: Path):
    """In a table, a round begins when it is due. In the case, it begins up to 4 ms later."""
    late = [("late", "from record round due to record round end", 'max = "3 ms"')]
    case = write_slave(tmp_path, with_budgets("", late))
    changes = ("controller.first=20 ms", "controller.period=20 ms", "controller.jitter=4 ms")
    plan = covered(case, *changes)
    table = TableMaker(plan, least_again=10).make()
    assert table.not_proven(plan, table.apart) == {"late": "its values depend on the jitter of the round"}
    verdicts = {one.name: one for one in Scene(load(case, [*changes, "duration=200 ms"])).run().budgets}
    assert verdicts["late"].broken


@pytest.mark.parametrize("ppm", [0, -100_000, 100_000])
def test_the_least_distance_has_the_jitter_of_the_clock(ppm: int):
    """A slow clock has longer periods and a longer jitter."""
    phases = covered(SLAVE, "controller.period=30 ms", "controller.jitter=29 ms", f"controller.ppm={ppm}").phases
    exact = Fraction(1, 1000) / (1 + Fraction(ppm, 10**6)) * phases.ticks_per_second
    assert exact - 2 < phases.least_distance() <= exact
    assert exact - 450 < phases.least_distance(Fraction(1)) < exact - 300


def test_a_first_start_at_the_start_of_the_run_is_refused(tmp_path: Path):
    with pytest.raises(NotClosed, match="the first start is at the start of the run; make `first` later"):
        made(write_echo(tmp_path), "host.first=0 s")


# Cases that are refused ---------------------------------------------------------------

GIVES_UP = """again:    TBIT  @SCIRXST,#RXRDY
          SB    got,TC
          DEC   @AH
          SB    again,NEQ
          ADD   @AR3,#1
          SB    wait,UNC
got:      MOV   AL,@SCIRXBUF
"""
WAIT = "wait:     TBIT  @SCIRXST,#RXRDY\n          SB    wait,NTC\n          MOV   AL,@SCIRXBUF\n"
COUNTS = """wait:     MOVL  XAR3,#0
again:    ADD   @AR3,#1
          TBIT  @SCIRXST,#RXRDY
          SB    again,NTC
          MOV   AL,@SCIRXBUF
"""
WATCHDOG = "          MOV   @WDCR,#0x68       ; watchdog off\n"
SYNCHRONISED = "          OR    @GPAQSEL2+1,#0x300\n"
QUALIFIED = "          AND   @GPAQSEL2+1,#0xFCFF\n          OR    @GPAQSEL2+1,#0x200\n"
DUE = "something is still due a second after the start of a round"
ENDS = "          MOV   @SCITXBUF,AL\n          SB    wait,UNC\n"


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (WAIT, "wait:     MOV   AH,#60000\n" + GIVES_UP, DUE),
        (WAIT, COUNTS, DUE),
        (WATCHDOG, "", DUE),
        (SYNCHRONISED, QUALIFIED, r"the state does not repeat .*_qualifiers\[28\]"),
        (ENDS, "          MOV   @SCITXBUF,AL\n          ESTOP0\n", "the state does not repeat"),
    ],
    ids=["wait that gives up and counts", "wait that counts", "watchdog on", "sampled pin", "program that ends"],
)
def test_firmware_whose_state_does_not_repeat_is_refused(old: str, new: str, reason: str, tmp_path: Path):
    """A long pause changes what such firmware does next."""
    with pytest.raises(NotClosed, match=reason):
        made(write_echo(tmp_path, 1.0, (old, new)))


def test_two_units_are_refused(tmp_path: Path):
    case = covered(write_echo(tmp_path)).case
    with pytest.raises(NotClosed, match="it has more than one unit, and the phases of their clocks are free"):
        check(case.model_copy(update={"unit": {**case.unit, "other": case.unit["dsp"]}}))


def test_all_reasons_for_a_refusal_are_named_at_once():
    case = load(TIMING / "imu_hil_c.toml")
    with pytest.raises(NotClosed) as refused:
        check(case)
    names = [reason.split(",")[0].split(";")[0] for reason in str(refused.value).split("; ")]
    assert [name for name in names if name.startswith(("rounds", "unit", "the bytes"))] == [
        "rounds and frames start independently of each other",
        "unit dsp runs C sources",
        "unit.dsp.ppm is not 0",
        "the bytes of the frames differ",
    ]


def test_the_longest_time_for_which_a_controller_waits_is_compared_with_a_rest():
    case = load(SLAVE, ["controller.rate=1 kHz"])
    assert case.controller is not None
    for part in ("low", "high"):
        one = case.controller.model_copy(update={part: Fraction(501, 10**6)})
        with pytest.raises(NotClosed, match="a bit of the controller lasts longer than 1 ms"):
            check(case.model_copy(update={"controller": one}))


@pytest.mark.parametrize("rate", ["100 Hz", "200 Hz", "900 Hz"])
def test_a_slow_bus_is_refused(rate: str):
    """The controller waits until the bus has been free for half a bit, which is longer than the rest of the table."""
    with pytest.raises(NotClosed, match="a bit of the controller lasts longer than 1 ms"):
        made(SLAVE, f"controller.rate={rate}", "controller.period=5 s")


def test_a_slow_filter_of_the_controller_is_refused():
    with pytest.raises(NotClosed, match=r"controller\.filter lasts longer than 1 ms"):
        made(SLAVE, "controller.filter=2 ms", "controller.rate=1 kHz", "controller.period=1 s")


def test_slow_frames_are_refused(tmp_path: Path):
    """Two of their characters last longer than a rest, so the frames of the table could be one burst."""
    with pytest.raises(NotClosed, match="a character of the host lasts longer than 1 ms"):
        made(write_echo(tmp_path), "host.baud=9600", "host.period=1 s")
    with pytest.raises(NotClosed, match="a character of the host lasts longer than 1 ms"):
        made(write_echo(tmp_path), "host.baud=10000", "host.error=-50", "host.period=1 s")
