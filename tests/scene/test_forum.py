"""The cases of timing/forum show what the threads of docs/forum.md report, and the page's change fixes each."""

from __future__ import annotations

import pytest

from periph_sim.cosim.registers import peek
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING, run_file

CURES = {
    "brkdt_often": "unit.dsp.settings.qualify=0",
    "fe_at_start": 'unit.board2.settings.low="0 s"',
    "fourteen_bytes": "unit.dsp.settings.fill=refilled",
    "interrupt_once": "unit.dsp.settings.acknowledge=true",
    "nack_holds_scl": "unit.dsp.settings.after_nack=[0x4E20]",
    "no_stop": "unit.dsp.settings.count_at_start=true",
    "rx_low": "fault=[]",
    "shifted_messages": "unit.dsp.settings.realign=true",
    "status_zero": 'serial.send.first.at="2.9 ms"',
}
SECONDS = {"brkdt_often": "0.2", "shifted_messages": "0.5", "status_zero": "0.0045"}  # others: 0.02


def seen(name: str, *changes: str) -> tuple[dict[str, float], list[str]]:
    """Return the worst value of each budget, and the budgets that the run breaks."""
    ran = run_file(f"forum/{name}", SECONDS.get(name, "0.02"), *changes)
    return {verdict.name: float(verdict.worst or 0) for verdict in ran.result.budgets}, ran.broken()


def test_each_case_has_a_cure():
    assert sorted(CURES) == sorted(path.stem for path in (TIMING / "forum").glob("*.toml"))


@pytest.mark.parametrize("name", CURES)
def test_the_case_shows_the_report_and_its_cure_does_not(name: str):
    assert seen(name)[1] == list(load(TIMING / "forum" / f"{name}.toml").breaks) != []
    assert seen(name, CURES[name])[1] == []


def test_brkdt_and_fe_come_once_in_ten_bytes_while_the_pin_is_right():
    assert seen("brkdt_often")[0] == {"framing errors": 100, "breaks": 100, "wrong frames on RX": 0}  # of 1000 bytes
    wrong_rate = seen("brkdt_often", "unit.dsp.settings.qualify=0", "serial.baud=108000")[0]
    assert (wrong_rate["framing errors"] > 0, wrong_rate["breaks"]) == (True, 0)


def test_a_low_rx_interrupts_twice_once_if_the_first_zero_is_not_delivered():
    assert seen("rx_low")[0] == {"interrupts without data": 2}
    assert seen("rx_low", "unit.dsp.options.sci.break_char_delivered=false")[0] == {"interrupts without data": 1}


def test_a_short_low_time_gives_only_fe_and_a_break_silences_the_receiver_until_sw_reset():
    whole = 9 * 17 + 1  # messages, and the character with FE
    assert seen("fe_at_start")[0] == {"framing errors": 1, "breaks": 1, "characters read": 1}
    short = seen("fe_at_start", 'unit.board2.settings.low="6 us"')[0]
    assert short == {"framing errors": 1, "breaks": 0, "characters read": whole}
    assert seen("fe_at_start", "unit.board1.options.sci.rx_after_break=next_high")[0]["characters read"] == whole


def test_without_stop_the_registers_are_those_of_the_report_with_a_stage_after_the_fifo():
    def registers(*changes: str) -> dict[str, int]:
        scene = run_file("forum/no_stop", "0.02", *changes).scene
        return {name: peek(scene, f"dsp.I2C-A.{name}") for name in ("I2CSTR", "I2CCNT", "I2CMDR", "I2CFFTX", "I2CDXR")}

    report = {"I2CSTR": 0x1010, "I2CCNT": 34, "I2CMDR": 0x4E20, "I2CFFTX": 0x6080, "I2CDXR": 0x1F}
    assert registers() == report | {"I2CDXR": 0}
    assert registers("unit.dsp.options.i2c.fifo_extra_stage=dxr_drr_behind") == report


def test_the_i2c_cases_depend_on_these_lengths_and_options():
    assert seen("no_stop", "unit.dsp.settings.length=14")[1] == ["bytes sent", "SCL low"]
    assert seen("no_stop", CURES["no_stop"], "unit.dsp.settings.length=62")[1] == ["bytes sent"]  # 64 bytes, and STOP
    assert seen("fourteen_bytes", "unit.dsp.settings.length=14")[1] == []
    assert seen("no_stop", "unit.dsp.options.i2c.cnt_copy_point=write")[1] == []
    assert seen("fourteen_bytes", "unit.dsp.options.i2c.fifo_extra_stage=dxr_drr_behind")[1] == []
    assert seen("nack_holds_scl", "unit.dsp.options.i2c.bb_on_irs_reset=clear")[1] == []
    assert seen("interrupt_once", "unit.dsp.options.i2c.rx_overrun_policy=overwrite")[1] == ["bytes read", "group held"]
