"""A case stepped from outside: when changes are applied, when pins of the case change, and that steps do not matter."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire
from periph_sim.outside import replay
from periph_sim.outside.session import Change, OutsidePins, Session
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from tests.outside.sessions import BUS, Records, begun, bus, case, refuses

Applied = list[tuple[int, dict[str, int]]]


def test_a_transfer_bit_by_bit_and_the_time_of_its_ack() -> None:
    """SDA --|__1_0_1_0_0_0_0_W_[ack]; the ACK begins a filter delay after SCL falls at the end of the eighth bit."""
    session, _ = bus()
    half = session.ticks("5 us")
    at = session.now
    changes: list[Change] = []
    assert [session.pulls(line) for line in BUS] == [False, False]
    session.apply(at, {"SDA": 0})
    for bit in (*map(int, f"{0x50 << 1:08b}"), 1):
        at += half
        session.apply(at, {"SCL": 0})
        session.apply(at + half // 4, {"SDA": bit})
        at += half
        session.apply(at, {"SCL": 1})
        changes += session.advance(at + half // 2)
    assert session.pulls("SDA") and not session.level("SDA")
    answer = [change for change in changes if change.line == "SDA"]
    assert [change.level for change in answer] == [0]
    eighth_fall = at - half
    assert 0 < answer[0].at - eighth_fall < half // 2
    session.apply(at + half, {"SCL": 0})
    changes = session.advance(at + 3 * half)
    assert [(change.line, change.level) for change in changes] == [("SDA", 1)] or ("SCL", 0) in [
        (change.line, change.level) for change in changes
    ]


def played(applied: Applied, steps: list[int], seed: int = 0) -> list[object]:
    """Return the records of these changes with time stepped by these lengths; lines are given in random order."""
    draw = Random(seed)
    session, records = bus()
    begin = session.now
    for at, levels in applied:
        while steps and session.now + steps[0] <= begin + at:
            session.advance(session.now + steps.pop(0))
        if seed and draw.random() < 0.5:
            session.advance(begin + at)  # the tick itself is not executed yet
        order = list(levels.items())
        draw.shuffle(order)
        if draw.random() < 0.5:
            session.apply(begin + at, dict(order))
        else:
            for line, level in order:
                session.apply(begin + at, {line: level})
    for step in steps:
        session.advance(max(session.now, min(session.now + step, begin + 10_000_000)))
    session.advance(begin + 10_000_000)
    session.finish()
    return [tuple(record) for record in records.kept]


@given(
    st.lists(
        st.tuples(
            st.integers(1, 3_000).map(lambda cycles: 20 * cycles),
            st.dictionaries(st.sampled_from(BUS), st.integers(0, 1), min_size=1, max_size=2),
        ),
        max_size=60,
    ),
    st.lists(st.integers(0, 400_000), max_size=30),
    st.integers(0, 1000),
)
@settings(max_examples=30)
def test_the_same_changes_give_the_same_records_for_any_steps_of_time(
    moves: Applied, steps: list[int], seed: int
) -> None:
    applied, at = [], 0
    for pause, levels in moves:
        at += pause
        applied.append((at, levels))
    assert played(applied, [], 0) == played(applied, list(steps), seed)


def test_an_advance_that_was_interrupted_can_be_repeated() -> None:
    """
    SDA   --|__2 ms           |--3 ms
    SCL   --------------|__2.7 ms        Ctrl-C at 2.5 ms
    """
    session, records = bus()
    ms = session.ticks_per_second // 1000

    def interrupt() -> None:
        raise KeyboardInterrupt

    session.scene.kernel.call_at(session.scene.start + 5 * ms // 2, interrupt)
    session.apply(2 * ms, {"SDA": 0})
    session.apply(3 * ms, {"SDA": 1})
    with pytest.raises(KeyboardInterrupt):
        session.advance(4 * ms)
    session.apply(27 * ms // 10, {"SCL": 0})
    session.advance(4 * ms)
    moved = [(one.tick - session.scene.start, one.where, one.value) for one in records.kept if one.kind is Kind.EDGE]
    assert moved == [(2 * ms, "SDA", 0), (27 * ms // 10, "SCL", 0), (3 * ms, "SDA", 1)]


def test_the_log_replays_the_changes_from_outside(log: Path) -> None:
    session, live = bus(log=log)
    assert session.i2c.transfer(0x50, b"\x00", 4) == b"\x01\x02\x03\x04"
    assert session.i2c.transfer(0x51, b"\x00", 4) is None
    session.advance(session.now + session.ticks("1 ms"))
    result = session.finish()
    again = Records()
    replayed = replay(case(), log, subscribe=again.subscribe)
    assert live.kept == again.kept and len(live.kept) > 200
    assert (replayed.simulated_s, replayed.counts, replayed.wire_bytes) == (
        result.simulated_s,
        result.counts,
        result.wire_bytes,
    )
    assert result.wire_bytes == 1 + 1 + 1 + 4 + 1


def test_a_log_without_an_end_is_replayed_to_its_last_whole_line(log: Path) -> None:
    with bus(log=log)[0] as session:
        session.i2c.transfer(0x50, b"\x00", 2)
        last = session.now
    log.write_text(log.read_text() + '[99999999, {"SC')
    assert 0 < replay(case(), log).simulated_s <= last / session.ticks_per_second
    assert replay(case(), log).wire_bytes == 5


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "line 1: found no head, expected the log of a session"),
        ("[]\n", "line 1: found no head"),
        ("{HEAD}\n[2, {}]\n[1, {}]\n", "line 3: found tick 1 behind tick 2, expected instants in order of time"),
        ('{HEAD}\n{"end": 5}\n[6, {}]\n', "line 3: found something after the end, expected nothing more"),
        ("{HEAD}\n7\n", "line 2: found 7, expected an instant"),
        ("{HEAD}\n[1, {\n", "line 2: found a damaged line, expected JSON"),
        ('{HEAD}\n[1, {"RX": 0}]\n', "line 2: found 'RX': 0, expected 0 or 1 of SDA or SCL"),
        ('{HEAD}\n[1, {"SDA": 2}]\n', "line 2: found 'SDA': 2, expected 0 or 1 of SDA or SCL"),
    ],
)
def test_a_damaged_log_is_refused_with_its_line(text: str, sentence: str, log: Path) -> None:
    bus(log=log)[0].finish()
    head = log.read_text().splitlines()[0]
    log.write_text(text.replace("{HEAD}", head))
    refuses(sentence, replay, case(), log)


def test_a_log_of_another_version_or_clock_is_refused(tmp_path: Path, log: Path) -> None:
    bus(log=log)[0].finish()
    head = json.loads(log.read_text().splitlines()[0])
    for key, value, sentence in (
        ("version", 2, "found version 2, expected version 1"),
        ("ticks_per_second", 5, "it is the log of case mine with 5 ticks a second, and case mine has 3000000000"),
    ):
        log.write_text(json.dumps(head | {key: value}) + "\n")
        refuses(sentence, replay, case(), log)
    refuses(
        r"nowhere.jsonl: No such file or directory; give the log of a session",
        replay,
        case(),
        tmp_path / "nowhere.jsonl",
    )
    refuses("give the log another place", Session, case(), BUS, log=tmp_path / "no" / "folder.jsonl")


def test_a_past_tick_is_refused_with_both_times_and_the_current_tick_is_accepted() -> None:
    session, _ = bus()
    session.apply(session.now, {"SDA": 0})
    refuses(
        r"lines cannot move at tick 5 \(.*\): the session is at tick 3000000 \(1000.000 us\)",
        session.apply,
        5,
        {"SDA": 0},
    )
    refuses(r"tick 5 \(.*\) is past: the session is at tick 3000000 \(1000.000 us\)", session.advance, 5)
    assert session.level("SDA") == 1
    session.advance(session.now + 1)
    assert session.level("SDA") == 0


def test_a_refused_call_has_no_effect() -> None:
    session, _ = bus()
    for levels, sentence in (
        ({"SDA": 0, "SDL": 0}, "line 'SDL' does not lead outside of case mine; did you mean SDA?"),
        ({"SDA": 0, "SCL": "x"}, "SCL at tick .*: found 'x', expected 0, pulled low, or 1, let go"),
    ):
        refuses(sentence, session.apply, session.now, levels)
    session.advance(session.now + 100)
    assert session.level("SDA") == session.level("SCL") == 1
    refuses("there is no wire 'TX'", session.level, "TX")
    refuses("line 'TX' does not lead outside", session.pulls, "TX")
    session.finish()
    refuses("the session is finished; begin another one", session.apply, session.now, {"SDA": 0})


@pytest.mark.parametrize(
    ("wires", "sentence"),
    [
        (("SDA", "SLC"), "outside.wires: there is no wire 'SLC'; did you mean SCL?"),
        (("SDA", "SDA"), "outside.wires: SDA is named twice; once is enough"),
    ],
)
def test_unknown_or_repeated_wires_are_refused(wires: tuple[str, ...], sentence: str) -> None:
    refuses(sentence, Session, case(), wires, error=BadCase)


def test_a_case_may_declare_its_outside_wires_and_is_then_not_run(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    unit = case().unit["dsp"]
    path.write_text(
        f'name = "mine"\nduration = "1 ms"\n[unit.dsp]\nfirmware = "{unit.firmware}"\nmodules = ["I2C-A"]\n'
        '[outside]\nwires = ["SDA", "SCL"]\n'
    )
    session = begun(path, None)
    assert session.i2c.transfer(0x50, b"\x00", 1) == b"\x01"
    from periph_sim.api import run

    refuses(
        r"case.toml, line 6: outside: SDA and SCL are driven from outside, and a run", run, load(path), error=BadCase
    )
    refuses("no wire leads outside; name them", Session, case(), error=BadCase)


def test_waiting_for_the_outside_is_no_deadlock() -> None:
    session, _ = bus()
    session.advance(session.ticks("100 ms"))
    assert session.finish().verdict == "not judged"


@pytest.mark.parametrize(("address", "verdicts"), [(0x50, ["pass", "pass"]), (0x22, ["not judged", "fail"])])
def test_budgets_of_the_bus_are_judged_by_transfers_from_outside(address: int, verdicts: list[str]) -> None:
    budgets = [
        {"name": "stretch", "measure": "stretch", "max": "50 us"},
        {"name": "nacked", "measure": "nacked", "max": 0},
    ]
    session = begun(case(budget=budgets))
    session.i2c.transfer(address, b"\x00", 2)
    assert [verdict.verdict for verdict in session.finish().budgets] == verdicts


def test_a_transfer_that_never_ends_is_judged(log: Path) -> None:
    budgets = [{"name": "stretch", "measure": "stretch", "max": "50 us"}]
    session = begun(case(budget=budgets), log=log)
    assert session.i2c.start(0x50)
    session.advance(session.now + session.ticks("1 ms"))
    result = session.finish()
    assert session.finish() is result
    assert replay(case(budget=budgets), log).budgets == result.budgets


@pytest.mark.parametrize("tick", [5e6, "1 ms", None, True])
def test_a_tick_must_be_an_integer(tick: object) -> None:
    session, _ = bus()
    for call in (lambda: session.advance(tick), lambda: session.apply(tick, {"SDA": 1})):  # type: ignore[arg-type]
        refuses(r"is no tick: expected a whole number, as from session.ticks\('5 us'\)", call)
    session.finish()


def test_memory_does_not_grow_without_calls_of_next_output() -> None:
    asked, session = bus()[0], bus()[0]
    for _ in range(2000):
        for one in (asked, session):
            one.apply(one.now, {"SCL": 0})
            one.advance(one.now + one.ticks("2 us"))
            one.apply(one.now, {"SCL": 1})
            one.advance(one.now + one.ticks("3 us"))
        asked.next_output()
    assert len(session._reaction._put) <= 130
    assert session.next_output() == asked.next_output()


def test_a_pulse_within_one_instant_is_no_change() -> None:
    """A chip releases SDA as soon as its fall has settled; at 7 it drives SDA low again, and keeps it low."""
    kernel = Kernel()
    sda, scl = (Wire(kernel, name, Recorder()) for name in ("SDA", "SCL"))
    door = OutsidePins(kernel, {"SDA": sda, "SCL": scl}, lambda tick, levels: None)
    chip, clock = sda.attach("chip"), scl.attach("chip")
    held = iter([1, 1, 0])  # the levels that the chip drives after each settled fall
    watch([sda], lambda tick, level: None if level else chip.drive(next(held)))
    kernel.call_at(3, lambda: chip.drive(0))
    kernel.call_at(5, lambda: clock.drive(0))
    kernel.call_at(5, lambda: chip.drive(0))
    kernel.call_at(7, lambda: chip.drive(0))
    kernel.run_until(4)
    assert door.changes() == []
    kernel.run_until(8)
    assert door.changes() == [Change(5, "SCL", 0), Change(7, "SDA", 0)]
    assert door.changes() == []
