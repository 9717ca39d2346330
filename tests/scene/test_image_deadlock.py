"""An image that waits for what cannot come is told: asleep with no interrupt on, or in a loop over memory."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.small import case

PROGRAM = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          .sect ".ebss", 0x8000
          .global _flag
_flag:    .word 0, 0
          .sect ".text", 0x9000
_c_int00: MOV   @SP,#0x400
          EALLOW
          MOVW  DP,#WDCR >> 6
          MOV   @WDCR,#{wdcr}
          EDIS
          MOVW  DP,#_flag >> 6
          {before}
again:    {loop}
          ESTOP0
"""
DISABLED, ENABLED = 0x68, 0x28
FLAG = "MOV AL,@_flag + 1\n SB again,EQ"
CALLED = "LCR #look\n SB again,EQ\n ESTOP0\nlook: MOV AL,@_flag\n LRETR"
POINTED = "MOV AL,*+XAR4[1]\n SB again,EQ"
LOCAL = "MOV AL,*-SP[2]\n SB again,EQ"
ENDLESS = "SB again,UNC"
PIE = "MOVW DP,#PIECTRL >> 6\n MOV @PIECTRL,#1\n"


def ran(folder: Path, loop: str, before: str = "NOP", wdcr: int = DISABLED) -> Result:
    path = folder / "waits.asm"
    path.write_text(PROGRAM.format(loop=loop, before=before, wdcr=wdcr))
    unit = {"image": str(path), "modules": ["TIMER0", "GPIO"]}
    return Scene(case(unit={"dsp": unit})).run(Fraction("0.0005"))


@pytest.mark.parametrize(
    ("before", "why"),
    [
        ("CLRC INTM", "IER = 0, so that no interrupt can wake it; enable one in IER before IDLE"),
        (PIE + "OR IER,#0x81\n MOV @PIEIER1,#0", "IER enables INT1 and INT8 only, with PIEIER1 = 0 and PIEIER8 = 0; "),
    ],
)
def test_a_sleep_that_no_interrupt_can_end(tmp_path: Path, before: str, why: str):
    result = ran(tmp_path, "IDLE", before)
    (told,) = result.stuck
    assert told.startswith("dsp waits in IDLE for an interrupt at _c_int00 (waits.asm:")
    assert f" and would for ever: {why}" in told
    assert result.verdict == "fail"


RUNS, STOPPED = (f"MOVW DP,#TIMER0PRD >> 6\n MOV @TIMER0TCR,#{tcr}\n" for tcr in (0x4020, 0x4030))
TINT0 = PIE + "OR IER,#1\n MOV @PIEIER1,#0x40\n"


def test_a_sleep_that_a_running_timer_may_end_is_none(tmp_path: Path):
    assert ran(tmp_path, "IDLE", RUNS + TINT0).stuck == []


@pytest.mark.parametrize(
    ("before", "why"),
    [
        (STOPPED + TINT0, "TIMER0 has nothing due and no wire leads there"),
        (
            RUNS + PIE + "OR IER,#1\n MOV @PIEIER1,#0x20",
            "no module of the unit has an interrupt that IER and PIEIER en",
        ),
        (
            RUNS + "OR IER,#0x1000",
            "no module of the unit has an interrupt that IER and PIEIER enable; enable one, or name",
        ),
    ],
)
def test_a_sleep_whose_interrupts_cannot_come(tmp_path: Path, before: str, why: str):
    """The timer runs in two of them, but its interrupt is not the one that is enabled."""
    (told,) = ran(tmp_path, "IDLE", before).stuck
    assert (
        "dsp waits in IDLE for an interrupt at _c_int00 (waits.asm:" in told and f" and would for ever: {why}" in told
    )


UNMODELLED = "MOVW DP,#0x7100 >> 6\n MOV AL,@0x19\n ANDB AL,#4\n SB again,EQ"  # ADCST, which no module has


@pytest.mark.parametrize("before", ["NOP", RUNS, RUNS + TINT0 + "CLRC INTM", RUNS + "OR IER,#1\n CLRC INTM"])
def test_a_poll_of_what_nothing_models_is_told_whatever_else_runs(tmp_path: Path, before: str):
    (told,) = ran(tmp_path, UNMODELLED, before + "\n NOP").stuck
    assert "and would for ever: nothing models that; answer it by [[unit.dsp.stub]] with register = " in told


def test_a_poll_of_what_nothing_models_is_none_where_the_watchdog_ends_it(tmp_path: Path):
    assert ran(tmp_path, UNMODELLED, wdcr=ENABLED).stuck == []


def test_a_running_timer_whose_interrupt_is_not_enabled_does_not_hide_a_wait(tmp_path: Path):
    """IER enables another line: only that could run a service routine."""
    on = PIE + "OR IER,#1\n MOV @PIEIER1,#0x20\n CLRC INTM\n MOVW DP,#_flag >> 6\n "
    (told,) = ran(tmp_path, FLAG, RUNS + on).stuck
    assert "waits for _flag+1 at " in told


def test_a_sleep_that_the_watchdog_ends_is_none(tmp_path: Path):
    assert ran(tmp_path, "IDLE", wdcr=ENABLED).stuck == []
    assert ran(tmp_path, FLAG, wdcr=ENABLED).stuck == []


@pytest.mark.parametrize(
    ("loop", "before", "what"),
    [
        (FLAG, "NOP", "_flag+1"),
        (POINTED, "MOVL XAR4,#_flag", "_flag+1"),
        ("MOVW DP,#0x9040 >> 6\n MOV AL,@0\n SB again,EQ", "NOP", "0x9040"),
        (LOCAL, "ADDB SP,#4\n MOV *-SP[2],#0", "0x0402"),
        (CALLED, "NOP", "memory"),
    ],
)
def test_a_loop_over_memory_that_no_interrupt_can_change(tmp_path: Path, loop: str, before: str, what: str):
    (told,) = ran(tmp_path, loop, before).stuck
    assert told.startswith(f"dsp waits for {what} at ")
    assert told.endswith(
        " and would for ever: only a service routine could change that, and INTM = 1; "
        "enable interrupts before the wait (CLRC INTM, bits of IER)"
    )


def test_a_loop_over_memory_that_a_service_routine_may_change(tmp_path: Path):
    on = PIE + "OR IER,#1\n MOV @PIEIER1,#0x40\n CLRC INTM\n MOVW DP,#_flag >> 6\n "
    runs = "MOVW DP,#TIMER0PRD >> 6\n MOV @TIMER0TCR,#0x4020\n"
    assert ran(tmp_path, FLAG, runs + on).stuck == []
    (told,) = ran(tmp_path, FLAG, "MOVW DP,#TIMER0PRD >> 6\n MOV @TIMER0TCR,#0x4030\n" + on).stuck
    assert "waits for _flag+1 at _c_int00 (waits.asm:" in told and "nothing due" in told


def test_an_endless_loop_without_a_way_out_is_how_programs_end(tmp_path: Path):
    assert ran(tmp_path, ENDLESS).stuck == []
