"""Each lint finds a planted fault once and at its place, and nothing in correct firmware."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.firmware import start_i2c, start_pie
from periph_sim.processor.dsp import Dsp
from periph_sim.records.lint import Finding, Options, all_lints, lint, text
from periph_sim.scene.case.load import load
from tests.records.scenes import ADDRESS, asks, by_hand, line_of, ran, recorded
from tests.scene.runs import TIMING

Fault = Callable[[Any, Dsp], None]


def set_read_only(i2c: Any, dsp: Dsp) -> None:
    i2c.I2CSTR.all = 0x1000  # BB


def change_prescaler(i2c: Any, dsp: Dsp) -> None:
    i2c.I2CPSC.all = 9


def change_address(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    i2c.I2COAR.all = 0x22


def load_on_xrdy(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.XRDY == 1)
    i2c.I2CDXR.all = 0x5A


def leave_byte(i2c: Any, dsp: Dsp) -> None:
    while not i2c.I2CSTR.RRDY:
        pass
    i2c.I2CSTR.SCD = 1


def wait_for_ever(i2c: Any, dsp: Dsp) -> None:
    while not i2c.I2CSTR.RRDY:
        dsp.compute(100)


def overwrite(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
    for byte in (1, 2, 3):
        i2c.I2CDXR.all = byte


def read_early(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
    assert i2c.I2CDRR.all == 1
    assert i2c.I2CDRR.all == 1


def reset(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
    dsp.compute(3000)
    i2c.I2CMDR.IRS = 0


def forget(i2c: Any, dsp: Dsp) -> None:
    def addressed() -> None:
        assert i2c.I2CISRC.INTCODE == 7

    i2c.I2CIER.AAS = 1
    start_pie(dsp, {"I2CINT1A": addressed})
    dsp.compute(1_000_000)


def wipe_all(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    dsp.compute(35_000)
    i2c.I2CSTR.all = 0xFFFF


def wipe_along(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    dsp.compute(35_000)
    i2c.I2CSTR.SCD = 1


def wait_for_stale(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)


def set_direction(i2c: Any, dsp: Dsp) -> None:
    i2c.I2CMDR.TRX = 1


def set_count(i2c: Any, dsp: Dsp) -> None:
    i2c.I2CCNT.all = 6


def start_in_reset(i2c: Any, dsp: Dsp) -> None:
    i2c.I2CMDR.IRS = 0
    i2c.I2CMDR.STT = 1


TWICE = {"controller": {"first": "1 ms", "rounds": 2, "period": "1 ms", "request": [{"address": 0x23, "write": "01"}]}}
PLANTED: list[tuple[str, Fault, int, dict[str, Any]]] = [
    ("read-only", set_read_only, 1, {}),
    ("prescaler-while-enabled", change_prescaler, 1, {}),
    ("own-address-in-transfer", change_address, 2, asks(0x23, write="01", count=0)),
    ("xrdy-alone", load_on_xrdy, 2, {}),
    ("receive-register-unread", leave_byte, 1, asks(write="01", count=0)),
    ("spin-without-bound", wait_for_ever, 1, {"duration": "25 ms"}),
    ("transmit-register-overwritten", overwrite, 3, asks(count=1)),
    ("receive-register-early", read_early, 3, asks(write="01", count=0)),
    ("reset-in-transfer", reset, 3, asks(write="0102", count=0)),
    ("group-not-acknowledged", forget, 1, asks(write="01", count=0)),
    ("flag-wiped", wipe_all, 3, asks(write="0102", count=0)),
    ("flag-wiped", wipe_along, 3, asks(write="0102", count=0)),
    ("stale-flag", wait_for_stale, 3, TWICE),
    ("without-effect", set_direction, 1, {}),
    ("without-effect", set_count, 1, {}),
    ("without-effect", start_in_reset, 2, {}),
]


def firmware(fault: Fault) -> Callable[[Dsp], None]:
    def main(dsp: Dsp) -> None:
        start_i2c(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2COAR.all = ADDRESS
        i2c.I2CMDR.IRS = 1
        fault(i2c, dsp)

    return main


def serve(i2c: Any, dsp: Dsp) -> None:
    """Receive a byte and send one correctly, then set up the module again."""
    dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
    assert i2c.I2CDRR.all == 1
    dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
    i2c.I2CDXR.all = 0x5A
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
    i2c.I2CMDR.IRS = 0
    i2c.I2COAR.all = 0x22
    i2c.I2CPSC.all = 9
    i2c.I2CMDR.IRS = 1


ALSO_FOUND = {  # other lints that a planted fault necessarily causes
    "receive-register-early": ("spin-without-bound",),
    "flag-wiped": ("receive-register-unread", "read-only"),
    "reset-in-transfer": ("receive-register-unread",),
    "group-not-acknowledged": ("receive-register-unread",),
    "stale-flag": ("receive-register-unread",),
}


@pytest.mark.parametrize(("name", "fault", "below", "scene"), PLANTED, ids=[name for name, *_ in PLANTED])
def test_a_planted_fault_is_found_once_at_its_place(
    monkeypatch: pytest.MonkeyPatch, name: str, fault: Fault, below: int, scene: dict[str, Any]
):
    run = ran(monkeypatch, firmware(fault), **scene)
    found = [f for f in lint(run) if f.lint == name or f.lint not in ALSO_FOUND.get(name, ())]
    inner = name in ("group-not-acknowledged", "stale-flag")  # their place is a function inside that of the fault
    place = found[0].place if inner else line_of(fault, below)
    times = 2 if name == "transmit-register-overwritten" else 1
    assert [(f.lint, f.unit, f.place) for f in found] == [(name, "dsp", place)] and found[0].count <= times
    assert found[0].source.startswith(("SPRUG03B", "SPRUFB0D")) and 0 < found[0].first < run.table.end


def test_a_finding_without_a_place_is_shown_with_its_unit(monkeypatch: pytest.MonkeyPatch):
    run = ran(monkeypatch, firmware(serve), **asks(pointer=1, count=1))
    shown = text(run, [Finding("stale-flag", "dsp", "", 1, 0, "it is stale", "SPRUG03B")])
    assert shown.startswith("dsp: it is stale [SPRUG03B]\n")


def test_every_lint_has_a_planted_fault():
    assert list(all_lints()) == sorted({name for name, *_ in PLANTED})


def test_correct_firmware_has_no_findings(monkeypatch: pytest.MonkeyPatch):
    assert lint(ran(monkeypatch, firmware(serve), **asks(pointer=1, count=1))) == []


def take(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
    assert i2c.I2CDRR.all == 1


def test_the_bound_of_a_wait_can_be_set(monkeypatch: pytest.MonkeyPatch):
    run = ran(monkeypatch, firmware(take), **asks(write="01", count=0))
    assert lint(run) == []
    (found,) = lint(run, Options(bound=Fraction(1, 1000)))
    assert found.lint == "spin-without-bound" and "end of the run" not in found.text


def test_a_wait_that_never_ends_is_found_in_any_short_run(monkeypatch: pytest.MonkeyPatch):
    (found,) = lint(ran(monkeypatch, firmware(take), "1 ms"))
    assert found.lint == "spin-without-bound" and "until the end of the run, and never got past it" in found.text


@pytest.mark.parametrize("style", ["polled", "interrupt"])
@pytest.mark.parametrize("fifo", [False, True])
def test_the_responder_has_no_findings(style: str, fifo: bool):
    changes = [f"unit.dsp.settings.style={style}", f"unit.dsp.settings.fifo={str(fifo).lower()}"]
    assert lint(recorded(load(TIMING / "responder.toml", changes), "0.02")) == []


PUBLISHED = {"receive-register-unread", "without-effect"}  # the published routine writes TRX and I2CCNT as slave


SHOWN_BY = {"imu_hil_no_sdir": {"xrdy-alone"}, "late_model": {"reset-in-transfer"}}  # the purpose of these cases


@pytest.mark.parametrize("case", sorted(path.stem for path in TIMING.glob("*.toml")))
def test_shipped_cases_have_only_the_known_findings(case: str):
    """In late_model, the computation of the model ends in the middle of a request to the unit."""
    shipped = load(TIMING / f"{case}.toml", [])
    programs = {
        Path(file).stem for unit in shipped.unit.values() for file in (unit.firmware, unit.image, *unit.sources)
    }
    expected = (PUBLISHED if "imu_hil" in programs else set()) | SHOWN_BY.get(case, set())
    seconds = {"late_model": "0.06", "imu_hil_c": "0.0077"}.get(case, "0.03")
    assert {found.lint for found in lint(recorded(shipped, seconds))} == expected


def test_a_run_without_records_has_no_findings():
    assert lint(by_hand()) == []


BEGIN = """ .include "f28335.inc"
 .reserve ".stack", 0x400, 0x40
 .sect ".text", 0x9000
 .global _wait, _timer
_c_int00: MOV @SP,#0x400
 EALLOW
 MOVW DP,#WDCR >> 6
 MOV @WDCR,#0x68
 MOV @PCLKCR0,#0x10
 MOVL XAR4,#_timer
 MOVL XAR5,#TINT0
 MOVL *XAR5,XAR4
 EDIS
 MOVW DP,#I2CMDR >> 6
 MOV @I2CMDR,#0x20
"""


def found(tmp_path: Path, code: str) -> dict[str, str]:
    """Map each lint that is found in 1 ms of this code, at 7.5 MHz, to its place."""
    (tmp_path / "own.asm").write_text(BEGIN + code)
    unit = 'image = "own.asm"\nmodules = ["I2C-A", "TIMER0"]'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "1 ms"\n[unit.dsp]\n{unit}\n')
    run = recorded(load(tmp_path / "own.toml"))
    return {finding.lint: finding.place for finding in lint(run, Options(bound=Fraction("100e-6")))}


def test_a_wait_that_never_ends_a_group_without_acknowledge_and_a_read_only_field_are_found(tmp_path: Path):
    code = """ MOV @I2CSTR,#0x1000
 MOVW DP,#TIMER0PRD >> 6
 MOVL XAR4,#100
 MOVL @TIMER0PRD,XAR4
 MOV @TIMER0TCR,#0x4020
 MOVW DP,#PIECTRL >> 6
 MOV @PIECTRL,#1
 MOV @PIEIER1,#0x40
 OR IER,#1
 CLRC INTM
_wait: MOVW DP,#I2CMDR >> 6
pass: TBIT @I2CSTR,#3
 SB pass,NTC
_timer: NOP
 IRET
"""
    assert found(tmp_path, code) == {
        "read-only": "_c_int00 (own.asm:16, 0x009013)",
        "group-not-acknowledged": "_timer (own.asm:29, 0x009029)",
        "spin-without-bound": "_wait (own.asm:27, 0x009027)",
    }
