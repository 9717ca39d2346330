"""Parties that drive the bus: the outside replaces [controller] on SDA and SCL, and [host] on RX, by any interface."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim import BadCase, Case, Result, Scene, load
from periph_sim.interfaces.commands.live_case import files_of
from periph_sim.outside import Session, replay
from periph_sim.outside.drivers import I2C, I2cDriverPort
from periph_sim.outside.live.case_for_line import case_for_bus, case_for_line
from periph_sim.scene.outside_parties import with_outside
from tests.outside.sessions import BUS, case
from tests.scene.runs import TIMING
from tests.scene.small import sentence_of

FIRMWARE = TIMING.parent / "firmware" / "python" / "responder.py"
REPLACED = "SDA and SCL are driven from outside, in place of [controller]"
REQUEST = {"name": "four", "address": 0x50, "pointer": 0, "count": 4, "expect": "01 02 03 04"}
CONTROLLER = {"period": "1 ms", "first": "2 ms", "request": [REQUEST]}
BUDGETS = [
    {"name": "missed", "measure": "missed rounds", "max": 0},
    {"name": "nacked", "measure": "nacked rounds", "max": 0},
    {"name": "round", "measure": "round", "max": "800 us"},
    {"name": "wrong bytes", "measure": "wrong bytes", "max": 0},
]


def asked(**controller: Any) -> Case:
    """Return a case of the responder and a controller that reads four bytes from it each millisecond."""
    return case(controller=CONTROLLER | controller, budget=BUDGETS)


def ended(session: Session, at: str) -> Result:
    session.advance(session.ticks(at))
    return session.finish()


def three_rounds(session: Session) -> None:
    """Do three transfers, one each millisecond, as a driver does."""
    for number in range(1, 4):
        session.advance(session.ticks(f"{number} ms"))
        assert session.i2c.transfer(0x50, b"\x00", 4) == b"\x01\x02\x03\x04"
    session.advance(session.ticks("4.2 ms"))


def check(result: Result) -> None:
    """Check that three rounds of seven bytes were judged from the wires, and nothing of a [controller]."""
    assert result.notes[0] == REPLACED
    assert (result.wire_bytes, result.counts["rounds"], result.counts["missed"]) == (3 * 7, 3, 0)
    assert [(one.name, one.verdict, one.count) for one in result.budgets] == [
        ("missed", "pass", 3),
        ("nacked", "pass", 3),
        ("round", "pass", 3),
        ("wrong bytes", "pass", 12),
    ]


def test_a_session_and_the_replay_of_its_log(tmp_path: Path) -> None:
    log = tmp_path / "live.jsonl"
    session = Session(asked(), BUS, log=log)
    three_rounds(session)
    check(session.finish())
    check(replay(asked(), log))
    given = {"wires": list(BUS), "log": str(log)}
    logged = case(controller=CONTROLLER, budget=BUDGETS, outside=given)
    check(Scene(logged).run(Fraction("0.0042")))


def test_budgets_that_must_break_are_only_those_that_are_judged() -> None:
    """Without the host the age of its data is unknown."""
    host = {"period": "20 ms", "first": "1 ms", "motion": {"kind": "sines"}}
    age = {"name": "age", "measure": "age", "max": "1 us"}
    both = case(modules=("I2C-A", "SCI-A"), host=host, budget=[*BUDGETS, age], controller=CONTROLLER)
    driven = with_outside(both.model_copy(update={"breaks": ("age", "round")}), ("RX",))
    assert [budget.name for budget in driven.budget] == [budget["name"] for budget in BUDGETS]
    assert driven.breaks == ("round",)


def test_a_driver_of_the_bus() -> None:
    with Session(asked(), BUS) as session:
        bus, got = I2C(session), bytearray(4)
        for number in range(1, 4):
            session.advance(session.ticks(f"{number} ms"))
            bus.writeto_then_readfrom(0x50, b"\x00", got)
            assert got == b"\x01\x02\x03\x04"
        check(ended(session, "4.2 ms"))


def test_a_driver_with_its_own_port() -> None:
    with I2cDriverPort(asked(), BUS) as port:
        pass
    assert port.result.notes[0] == REPLACED


def test_a_served_bus_and_the_case_that_new_writes_from_its_log(tmp_path: Path) -> None:
    path, log = tmp_path / "case.toml", tmp_path / "live.jsonl"
    text = (TIMING / "responder.toml").read_text()
    path.write_text(text.replace('firmware = "responder"', f'firmware = "{FIRMWARE}"'))
    session = Session(case_for_bus(path), log=log)
    session.advance(session.ticks("1 ms"))
    session.i2c.transfer(0x50, b"\x00", 16)
    live = ended(session, "5 ms")
    files, target = files_of(log, str(tmp_path / "again"))
    target.write_text(files[target])
    again = Scene(load(target)).run()
    assert live.notes == again.notes == [REPLACED]
    assert live.budgets == again.budgets and [one.verdict for one in again.budgets] == ["pass"] * 3


def test_a_served_line_replaces_the_host_with_the_budgets_that_need_its_frames() -> None:
    served = case_for_line(TIMING / "imu_hil.toml", "scia")
    (sentence,) = served.replaced
    assert sentence == (
        "RX is driven from outside, in place of [host]; left out, since nothing else can judge them: "
        "'wrong bytes', 'data age'"
    )
    assert served.host is None and served.controller.check == "expect"
    session = Session(served)
    line = session.serial("scia")
    line.write(bytes(12))
    result = ended(session, "2 ms")
    assert (result.notes[0], result.sci_bytes) == (sentence, 12)
    assert {one.name for one in result.budgets}.isdisjoint({"wrong bytes", "data age"})


def test_a_mistake_is_reported_with_its_line_in_the_file_whatever_was_left_out(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    text = (TIMING / "imu_hil.toml").read_text().replace('firmware = "imu_hil"', f'firmware = "{FIRMWARE}"')
    path.write_text(text + '\n[outside]\nwires = ["RX"]\n')
    made = load(path)
    line = text.splitlines().index('name = "SCI overruns"') + 2
    last = len(made.budget) - 1
    assert str(made.mistake("x", "budget", last, "measure")).startswith(f"{path}, line {line}: budget.SCI overruns")
    assert made.line("budget", last) == line - 2


def test_rounds_are_due_by_the_schedule_of_the_controller() -> None:
    session = Session(asked(rounds=3), BUS)
    three_rounds(session)
    assert ended(session, "40 ms").counts["missed"] == 0
    session = Session(asked(), BUS)
    three_rounds(session)
    assert ended(session, "40 ms").counts["missed"] == 36


def test_requests_without_an_acknowledge_are_counted_on_the_wires() -> None:
    session = Session(asked(), BUS)
    session.advance(session.ticks("1 ms"))
    assert session.i2c.transfer(0x22, b"\x00", 1) is None
    result = session.finish()
    assert result.counts["nacked"] == 1
    assert [one.verdict for one in result.budgets] == ["not judged"] * 4  # the case's requests were not among those


def test_outside_and_controller_are_both_on_the_bus_if_the_case_says_so() -> None:
    session = Session(asked(beside_outside=True, rounds=1), BUS)
    session.advance(session.ticks("3 ms"))  # its round is over
    assert session.i2c.transfer(0x50, b"\x00", 4) == b"\x01\x02\x03\x04"
    assert session.i2c.transfer(0x22, b"\x00", 4) is None
    result = ended(session, "4 ms")
    assert result.notes[0] == "SDA and SCL are driven from outside, beside [controller]"
    assert result.wire_bytes == 7 + 7 + 1  # bytes of both, as the wires have them
    assert result.counts["nacked"] == 1


def test_one_line_alone_from_outside_does_not_replace_the_controller() -> None:
    result = ended(Session(asked(), ("SDA",)), "3.9 ms")
    assert result.counts["rounds"] == 2 and not any("outside" in note for note in result.notes)


def test_budgets_on_events_that_only_the_controller_records_are_left_out() -> None:
    budget = [*BUDGETS, {"name": "clears", "measure": "count of bus clear", "max": 0}]
    made = case(controller=CONTROLLER, budget=budget, outside={"wires": list(BUS)})
    assert made.replaced == (f"{REPLACED}; left out, since nothing else can judge them: 'clears'",)
    assert [one.name for one in made.budget] == [one["name"] for one in BUDGETS]


def test_a_session_cannot_restore_what_the_outside_table_of_the_case_replaced() -> None:
    made = case(controller=CONTROLLER, outside={"wires": list(BUS)})
    with pytest.raises(BadCase, match=r"the wires that it names replace \[controller\], and SDA alone would not"):
        Session(made, ("SDA",))


def test_a_table_that_sends_on_the_same_wire_is_refused() -> None:
    send = {"send": [{"name": "a", "to": "dsp.SCI-A", "bytes": "01", "at": "1 ms"}]}
    with pytest.raises(BadCase, match=r"the outside drives the RX of dsp\.SCI-A already, and one line has one sender"):
        Session(case("uart_logger", ("SCI-A",), serial=send), ("RX",))


@pytest.mark.parametrize(
    ("wires", "reason"), [(("RX",), "RX is driven from outside"), (BUS, "SDA and SCL are driven from outside")]
)
def test_a_case_that_is_driven_from_outside_is_not_run_by_itself(wires: tuple[str, ...], reason: str):
    tables = {
        "name": "x",
        "duration": "1 ms",
        "unit": {"dsp": {"firmware": "responder", "modules": ["I2C-A", "SCI-A"]}},
    }
    scene = Scene(Case.model_validate(tables | {"outside": {"wires": [*wires]}}))
    way_out = "step it with periph_sim.outside.Session, or give its log, a [controller] or a [host]"
    assert f"{reason}, and a run has no outside party; {way_out}" in sentence_of(BadCase, lambda: scene.run())


def test_a_budget_with_a_part_that_needs_the_host_is_left_out_with_it() -> None:
    part = {"measure": "age", "max": "40 ms"}
    budget = {"name": "both", "measure": "stretch", "max": "1 s", "and": [part]}
    alone = {"name": "alone", "measure": "stretch", "max": "1 s"}
    made = case(controller=CONTROLLER | {"check": "host"}, host={}, budget=[budget, alone])
    driven = with_outside(made, ("RX",))
    assert [one.name for one in driven.budget] == ["alone"] and driven.host is None
