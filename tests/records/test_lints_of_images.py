"""Lints on machine code: what an image does against the manuals is found with its place; fields that it tests count."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from periph_sim.records.lint import Options, lint
from periph_sim.scene.case.load import load
from tests.records.scenes import recorded

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
    """Lint by name with its place, of 1 ms at 7.5 MHz."""
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
