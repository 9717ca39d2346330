"""An image that waits for an event that cannot occur is reported: in IDLE without an interrupt, or in a loop."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim import Result, Scene
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


def ran(
    folder: Path,
    loop: str,
    before: str = "NOP",
    wdcr: int = DISABLED,
    us: float = 500,
    stub: list[object] | None = None,
) -> Result:
    path = folder / "waits.asm"
    path.write_text(PROGRAM.format(loop=loop, before=before, wdcr=wdcr))
    unit = {"image": str(path), "modules": ["TIMER0", "GPIO"], "stub": stub or []}
    return Scene(case(unit={"dsp": unit})).run(Fraction(us) / 1_000_000)


@pytest.mark.parametrize(
    ("before", "reason"),
    [
        ("CLRC INTM", "IER = 0, so that no interrupt can wake it; enable one in IER before IDLE"),
        (PIE + "OR IER,#0x81\n MOV @PIEIER1,#0", "IER enables INT1 and INT8 only, with PIEIER1 = 0 and PIEIER8 = 0; "),
    ],
)
def test_a_sleep_that_no_interrupt_can_end(tmp_path: Path, before: str, reason: str):
    result = ran(tmp_path, "IDLE", before)
    (sentence,) = result.stuck
    assert sentence.startswith("dsp waits in IDLE for an interrupt at _c_int00 (waits.asm:")
    assert f" and would for ever: {reason}" in sentence
    assert result.verdict == "fail"


RUNS, STOPPED = (f"MOVW DP,#TIMER0PRD >> 6\n MOV @TIMER0TCR,#{tcr}\n" for tcr in (0x4020, 0x4030))
TINT0 = PIE + "OR IER,#1\n MOV @PIEIER1,#0x40\n"
SERVED = "CLRC INTM\n MOVW DP,#_flag >> 6\n "
STUB = {"register": "ADC.ADCST", "value": 4}


@pytest.mark.parametrize(
    ("before", "reason"),
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
def test_a_sleep_whose_interrupts_cannot_occur(tmp_path: Path, before: str, reason: str):
    """In two of the cases the timer runs, but another interrupt than its own is enabled."""
    (sentence,) = ran(tmp_path, "IDLE", before).stuck
    assert (
        "dsp waits in IDLE for an interrupt at _c_int00 (waits.asm:" in sentence
        and f" and would for ever: {reason}" in sentence
    )


UNMODELLED = "MOVW DP,#0x7100 >> 6\n MOV AL,@0x19\n ANDB AL,#4\n SB again,EQ"  # ADCST, which no modelled module has


@pytest.mark.parametrize("before", ["NOP", RUNS, RUNS + TINT0 + "CLRC INTM", RUNS + "OR IER,#1\n CLRC INTM"])
def test_a_poll_of_an_unmodelled_register_is_reported_whatever_else_runs(tmp_path: Path, before: str):
    (sentence,) = ran(tmp_path, UNMODELLED, before + "\n NOP").stuck
    assert "and would for ever: it is not modelled; answer it by [[unit.dsp.stub]] with register = " in sentence


TICKS = """EALLOW
          MOVL  XAR4,#tick
          MOVL  XAR5,#TINT0
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#TIMER0PRD >> 6
          MOVL  XAR4,#400 - 1
          MOVL  @TIMER0PRD,XAR4
          MOV   @TIMER0TCR,#0x4020
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER1,#0x40
          OR    IER,#1
          MOV   @PIEACK,#0xFFF
          CLRC  INTM
          NOP
"""  # TINT0 every 400 cycles of 133.3 ns
ROUTINE = """
tick:     MOVB  XAR0,#40
spent:    BANZ  spent,AR0--
          {restart}
          MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#1
          IRET
"""
RESTART = "MOVW DP,#0x7000 >> 6\n EALLOW\n MOV @0x25,#0x55\n MOV @0x25,#0xAA\n EDIS"  # WDKEY
LOOKS = "LCR #look\n SB again,EQ"  # the poll, in a function that the loop calls
LOOK = "look: MOVW DP,#0x7100 >> 6\n MOV AL,@0x19\n NOP\n NOP\n ANDB AL,#4\n LRETR"
DMA = "MOV @0xCEE,#1\n OR IER,#0x40\n CLRC INTM\n MOVW DP,#_flag >> 6\n "


@pytest.mark.parametrize(("loop", "more"), [(UNMODELLED, ""), (LOOKS, LOOK)], ids=["loop", "function"])
@pytest.mark.parametrize("us", [500, 510, 520, 530, 537.2])
def test_a_poll_of_an_unmodelled_register_is_reported_in_the_middle_of_service_routines(
    tmp_path: Path, us: float, loop: str, more: str
):
    """The run ends in a service routine, in the first polls after it, or at an interrupt of a poll."""
    (sentence,) = ran(tmp_path, f"{loop}\n ESTOP0\n{more}{ROUTINE.format(restart='')}", TICKS, us=us).stuck
    place = r"_c_int00 \(waits\.asm:\d+, 0x[0-9a-f]+\) since [67]\.\d+ us"
    assert re.match(
        rf"dsp waits for ADC\.ADCST & 0x(0004|ffff) at {place} and would for ever: it is not modelled; ", sentence
    )


@pytest.mark.parametrize("us", range(500, 550, 10))
def test_a_poll_that_a_stub_answered_is_not_reported_in_the_middle_of_service_routines(tmp_path: Path, us: int):
    stub = [STUB | {"after": "0.4 ms"}]
    loop = f"{UNMODELLED}\nends: MOV @0x19,#0\n SB ends,UNC\n{ROUTINE.format(restart='')}"
    assert ran(tmp_path, loop, TICKS, us=us, stub=stub).stuck == []


def test_a_poll_that_a_stub_does_not_end_is_reported_with_the_answer(tmp_path: Path):
    (sentence,) = ran(tmp_path, UNMODELLED, stub=[STUB | {"value": 3}]).stuck
    assert sentence.endswith(
        "and would for ever: its [[unit.dsp.stub]] answers 0x0003; give a value that ends the wait, "
        "or a later one by a further stub with after"
    )


@pytest.mark.parametrize(("restart", "hangs"), [(RESTART, True), ("NOP", False)])
def test_a_poll_hangs_where_a_service_routine_restarts_the_watchdog(tmp_path: Path, restart: str, hangs: bool):
    """The watchdog overflows after 131072 OSCCLK, 4.4 ms."""
    loop = f"{UNMODELLED}\n ESTOP0\n{ROUTINE.format(restart=restart)}"
    result = ran(tmp_path, loop, TICKS, wdcr=ENABLED, us=12_000)
    assert (["would for ever" in sentence for sentence in result.stuck], result.counts["resets"]) == (
        ([True], 0) if hangs else ([], 2)
    )  # fmt: skip


@pytest.mark.parametrize("wdcr", [ENABLED, DISABLED])
def test_a_poll_that_restarts_the_watchdog_itself_hangs(tmp_path: Path, wdcr: int):
    result = ran(tmp_path, f"{RESTART}\n {UNMODELLED}", wdcr=wdcr, us=12_000)
    (sentence,) = result.stuck
    assert re.match(
        r"dsp waits for ADC\.ADCST & 0x0004 at _c_int00 \(waits\.asm:23, 0x009017\) since 4\.933 us and ", sentence
    )
    assert result.counts["resets"] == 0


def test_each_pass_of_a_loop_that_counts_and_restarts_the_watchdog_is_executed(tmp_path: Path):
    result = ran(tmp_path, f"MOVL XAR2,#9999\nspend: {RESTART}\n BANZ spend,AR2--", wdcr=ENABLED, us=6000)
    assert result.counts["resets"] == 0


def test_a_loop_over_memory_that_only_an_unmodelled_module_could_end(tmp_path: Path):
    (sentence,) = ran(tmp_path, FLAG, PIE + DMA).stuck
    assert sentence.endswith(
        "and would for ever: no module of the unit has an interrupt that IER and PIEIER enable; "
        "enable one, or name its module"
    )


def test_a_running_timer_whose_interrupt_is_not_enabled_does_not_hide_a_wait(tmp_path: Path):
    """IER enables another line, and only that line could run a service routine."""
    on = PIE + "OR IER,#1\n MOV @PIEIER1,#0x20\n CLRC INTM\n MOVW DP,#_flag >> 6\n "
    (sentence,) = ran(tmp_path, FLAG, RUNS + on).stuck
    assert "waits for _flag+1 at " in sentence


@pytest.mark.parametrize(("us", "resets"), [(500, 0), (12_000, 2)])
def test_a_poll_of_a_module_that_the_watchdog_ends_is_not_stuck(tmp_path: Path, us: int, resets: int):
    loop = "MOVW DP,#TIMER0TCR >> 6\n MOV AL,@TIMER0TCR\n TBIT AL,#15\n SB again,NTC"
    (sentence,) = ran(tmp_path, loop, STOPPED, us=us).stuck
    assert "waits for TIMER0.TCR.TIF at " in sentence
    result = ran(tmp_path, loop, STOPPED, wdcr=ENABLED, us=us)
    assert (result.counts["resets"], result.stuck) == (resets, [])


@pytest.mark.parametrize(
    ("loop", "before", "what"),
    [
        (FLAG, "NOP", "_flag+1"),
        (POINTED, "MOVL XAR4,#_flag", "_flag+1"),
        ("MOVW DP,#0x9040 >> 6\n MOV AL,@0\n SB again,EQ", "NOP", "0x9040"),
        ("MOV AL,*+XAR4[AR0]\n SB again,EQ", "MOVL XAR4,#_flag\n MOVB XAR0,#1", "_flag+1"),
        ("MOV @AL,*(0:0x9040)\n SB again,EQ", "NOP", "0x9040"),
        (LOCAL, "ADDB SP,#4\n MOV *-SP[2],#0", "0x0402"),
        (CALLED, "NOP", "memory"),
    ],
)
def test_a_loop_over_memory_that_no_interrupt_can_change(tmp_path: Path, loop: str, before: str, what: str):
    (sentence,) = ran(tmp_path, loop, before).stuck
    assert sentence.startswith(f"dsp waits for {what} at ")
    assert sentence.endswith(
        " and would for ever: only a service routine could change that, and INTM = 1; "
        "enable interrupts before the wait (CLRC INTM, bits of IER)"
    )


def test_a_loop_over_memory_that_a_service_routine_may_change(tmp_path: Path):
    assert ran(tmp_path, FLAG, RUNS + TINT0 + SERVED).stuck == []
    (sentence,) = ran(tmp_path, FLAG, STOPPED + TINT0 + SERVED).stuck
    assert "waits for _flag+1 at _c_int00 (waits.asm:" in sentence and "nothing due" in sentence


NOT_STUCK: dict[str, tuple[str, dict[str, Any]]] = {
    "an endless loop without a way out, as programs end": (ENDLESS, {}),
    "a sleep that a running timer may end": ("IDLE", {"before": RUNS + TINT0}),
    "a sleep that the watchdog ends": ("IDLE", {"wdcr": ENABLED}),
    "a loop over memory that the watchdog ends": (FLAG, {"wdcr": ENABLED}),
    "a poll of what nothing models that the watchdog ends": (UNMODELLED, {"wdcr": ENABLED}),
    "a poll that a stub will answer": (UNMODELLED, {"stub": [STUB | {"after": "0.6 ms"}]}),
    "a poll that restarts the watchdog until a stub answers": (
        f"{RESTART}\n {UNMODELLED}\nends: SB ends,UNC",
        {"stub": [STUB | {"after": "0.4 ms"}]},
    ),
    "a loop that restarts the watchdog and counts": (
        f"{RESTART}\n MOVW DP,#_flag >> 6\n INC @_flag\n {UNMODELLED}",
        {"us": 2000},
    ),
    "a poll that restarts the watchdog and reads a running timer": (
        f"{RESTART}\n MOVW DP,#TIMER0TCR >> 6\n MOV AH,@TIMER0TCR\n {UNMODELLED}",
        {"before": RUNS, "us": 2000},
    ),
}


@pytest.mark.parametrize("what", NOT_STUCK)
def test_a_program_that_can_continue_or_has_ended_is_not_stuck(tmp_path: Path, what: str):
    loop, more = NOT_STUCK[what]
    assert ran(tmp_path, loop, **more).stuck == []


@pytest.mark.parametrize(
    ("before", "loop", "end"),
    [
        ("NOP", ENDLESS, r"is in an endless loop at _c_int00 \(waits.asm:15, 0x.*\) since .*"),
        (RUNS + TINT0, "IDLE", r"waits in IDLE for an interrupt at _c_int00 \(waits.asm:\d+, 0x.*\)"),
        (
            RUNS + TINT0 + SERVED,
            FLAG,
            r"waits for _flag\+1 at _c_int00 \(waits.asm:\d+, 0x.*\) since .*",
        ),
        ("NOP", "INC @_flag\n SB again,UNC", r"computes at _c_int00 \(waits.asm:\d+, 0x.*\)"),
    ],
)
def test_a_result_shows_where_the_image_is_at_the_end(tmp_path: Path, before: str, loop: str, end: str):
    result = ran(tmp_path, loop, before)
    (sentence,) = result.ends
    assert re.fullmatch(f"dsp {end}", sentence), sentence


@pytest.mark.parametrize(("loop", "us"), [("IDLE", 500), ("ESTOP0", 500)])
def test_an_image_that_is_stuck_or_has_ended_is_reported_once(tmp_path: Path, loop: str, us: float):
    result = ran(tmp_path, loop)
    assert result.ends == [] and len(result.stuck) + len(result.notes) == 1
