"""Passes of polling loops are skipped with the results of executing each of them."""

from __future__ import annotations

import random
from collections.abc import Iterable

from hypothesis import given, settings
from hypothesis.strategies import integers

from periph_sim.core.records import Kind
from periph_sim.processor.image.boot import Stub
from periph_sim.processor.image.cpu import TIMING
from tests.processor.image.rig import HEAD, Rig
from tests.profiles import examples

ADCST, COUNT, FLAG = 0x7119, 0x9100, 0x9101
SCICTL2 = "SCI-A.SCICTL2.all"

# SCI-A at its fastest; timer 0 requests every PERIOD cycles, and its routine counts and sets FLAG at each 5th interrupt
HARDWARE = """
 EALLOW
 MOVW DP,#0x7010 >> 6
 MOV @0x701C,#0x0400
 MOV @0x701B,#0
 MOVL XAR4,#_routine
 MOVL XAR5,#0x0D4C
 MOVL *XAR5,XAR4
 EDIS
 MOVW DP,#0x7050 >> 6
 MOV @0x7050,#7
 MOV @0x7051,#3
 MOV @0x7053,#{baud}
 MOV @0x7051,#0x23
 MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE0,#1
 MOV @0x0CE2,#0x40
 MOVW DP,#0x0C00 >> 6
 MOVL XAR6,#{period}
 MOVL @0x0C02,XAR6
 MOV @0x0C04,#0x4020
 OR IER,#1
 {interrupts}
"""
ROUTINE = """
 .global _routine
_routine: ADDB SP,#1
 PUSH ACC
 PUSH DP
 MOVW DP,#0x9100 >> 6
 INC @0x9100
 MOV AL,@0x9100
 CMPB AL,#{every}
 SB quick,LT
 MOV @0x9101,#1
 MOV @0x9100,#0
quick: MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE1,#1
 POP DP
 POP ACC
 SUBB SP,#1
 IRET
"""
SEND = "MOVW DP,#0x1C1; MOV @0x7059,#0x41; RPT #80 || NOP; MOV @0x7059,#0x42; "
WAITS = (
    # TXRDY by TBIT, by a mask, and by a function
    SEND + "{n}: TBIT @0x7054,#7; SB {n},NTC",
    SEND + "{n}: MOVW DP,#0x1C1; AND AL,@0x7054,#0x80; LSR AL,#7; SBF {n},EQ",
    SEND + "{n}: LCR #_ready; CMPB AL,#0; BF {n},EQ",
    # wait until the transmitter is empty; the value is stored and loaded again
    SEND + "{n}: MOV AL,@0x7054; MOV *SP++,AL; MOV AL,*--SP; TBIT @AL,#6; SB {n},NTC",
    # a flag that the service routine sets
    "MOVW DP,#0x9100 >> 6; MOV @0x9101,#0; {n}: NOP; MOV AL,@0x9101; SB {n},EQ",
    # the timer's counter is read, so no two passes are equal
    "MOVW DP,#0x0C00 >> 6; {n}: MOV AL,@0x0C00; CMPB AL,#0x80; SB {n},HI",
    # a count down, and a time-out with a flag
    "MOVL XAR3,#{count}; {n}: BANZ {n},AR3--",
    SEND + "MOVL XAR3,#{count}; {n}: TBIT @0x7054,#7; SB x{n},TC; BANZ {n},AR3--; x{n}: NOP",
    # the passes are counted in memory
    SEND + "{n}: MOVW DP,#0x9110 >> 6; INC @0x9110; MOVW DP,#0x1C1; TBIT @0x7054,#7; SB {n},NTC",
    # two registers
    SEND + "{n}: MOV AL,@0x7054; AND AL,@0x7055; MOV AH,@0x7054; TBIT @AH,#6; SB {n},NTC",
)
FOR_FLAG = 4
READY = " .global _ready\n_ready: ADDB SP,#2\n AND AL,@0x7054,#0x80\n MOV *-SP[1],AL\n SUBB SP,#2\n LRETR\n"


def lines(wait: str, name: str, count: int) -> str:
    """Return a wait as lines of source."""
    code = wait.format(n=name, count=count).split("; ")
    return "".join(f"{line}\n" if ": " in line else f" {line}\n" for line in code)


def outcome(rig: Rig) -> dict[str, object]:
    """Return the state of a run that a program can observe."""
    interrupts = [(record.tick, record.what, record.value) for record in rig.records if record.kind is Kind.IRQ]
    memory = [rig.word(address) for address in (*range(0x400, 0x440), *range(0x9000, 0x9200))]
    return {
        "ended": rig.program.returned_at,
        "instructions": rig.program.instructions,
        "state": rig.cpu.state()[:TIMING],
        "pc": rig.cpu.pc,
        "memory": memory,
        "interrupts": interrupts,
        "events of SCI": rig.dsp.sockets["SCI-A"].chip.peek(rig.dsp.processor.time.cycle, 4),
    }


def both(source: str, stubs: Iterable[Stub] = (), ticks: int = 6_000_000) -> tuple[int, dict[str, object]]:
    """Compare runs with and without skipping; return the skipped passes and the outcome, which is the same."""
    skipping, executing = (Rig(source, "SCI-A", "TIMER0", stubs=stubs, skip=skip) for skip in (True, False))
    waits = [rig.record_waits() for rig in (skipping, executing)]
    skipping.run(ticks)
    executing.run(ticks)
    assert executing.program.polls_skipped == 0
    assert outcome(skipping) == outcome(executing)
    assert [wait[1:] for wait in waits[0]] == [wait[1:] for wait in waits[1]]
    return skipping.program.polls_skipped, outcome(skipping)


def program(draw: random.Random) -> str:
    """Return waits in a random order, with random interrupts."""
    interrupts = draw.choice(("CLRC INTM", "CLRC INTM", "NOP"))
    possible = [wait for wait in WAITS if interrupts != "NOP" or wait is not WAITS[FOR_FLAG]]
    waits = "".join(
        lines(draw.choice(possible), f"w{number}", draw.randrange(200)) + " NOP\n" * draw.randrange(4)
        for number in range(draw.randrange(3, 9))
    )
    hardware = HARDWARE.format(baud=draw.randrange(1, 9), period=draw.randrange(150, 1500), interrupts=interrupts)
    return HEAD + hardware + waits + " ESTOP0\n" + ROUTINE.format(every=draw.randrange(1, 4)) + READY


def test_which_waits_are_skipped():
    skipped = []
    for wait in WAITS:
        hardware = HARDWARE.format(baud=8, period=2999, interrupts="CLRC INTM")
        source = HEAD + hardware + lines(wait, "w", 50) + " ESTOP0\n" + ROUTINE.format(every=2) + READY
        passes, came = both(source)
        assert came["ended"] is not None
        skipped.append(passes > 0)
    assert skipped == [True, True, True, True, True, False, False, False, False, True]


@settings(max_examples=examples(6), deadline=None)
@given(seed=integers(0, 1_000_000))
def test_skipping_changes_nothing(seed: int):
    assert both(program(random.Random(seed)), ticks=20_000_000)[1]["ended"] is not None


def test_a_wait_for_the_lock_of_the_pll_is_skipped():
    """The clock changes at the end of the wait."""
    wait = "w: MOV AL,@0x7011; ANDB AL,#1; CMPB AL,#1; SBF w,NEQ; EDIS; RPT #200 || NOP; ESTOP0"
    source = HEAD + lines(f"EALLOW; MOVW DP,#0x7011 >> 6; MOV @0x7021,#10; {wait}", "w", 0)
    skipped, came = both(source, ticks=20_000_000)
    assert came["ended"] is not None and skipped > 2000


def test_a_stub_ends_a_wait():
    wait = HEAD + f" MOVW DP,#{ADCST} >> 6\nloop: MOV AL,@{ADCST}\n TBIT @AL,#0\n SB loop,NTC\n ESTOP0"
    for ready in range(300_000, 300_000 + 5000, 1201):
        skipped, came = both(wait, (Stub(0, ADCST, 0x10), Stub(ready, ADCST, 0x11)))
        assert skipped > 20 and came["ended"] is not None


def test_a_watchdog_reset_ends_a_skipped_wait():
    wait = HEAD.replace("#0x68", "#0x28") + f" MOVW DP,#{ADCST} >> 6\nloop: MOV AL,@{ADCST}\n SB loop,EQ\n ESTOP0"
    rigs = [Rig(wait, skip=skip).run(14_000_000) for skip in (True, False)]
    assert [rig.dsp.resets for rig in rigs] == [1, 1]
    assert rigs[0].program.polls_skipped > 1000 and rigs[1].program.polls_skipped == 0
    assert rigs[0].cpu.state()[:TIMING] == rigs[1].cpu.state()[:TIMING]


def test_a_watchdog_reset_ends_a_wait_for_a_register_that_it_changes():
    """SCICTL2 reads 0xC0 until the reset stops the SCI's clock; that wait ends in the record, and a new one begins."""
    clock = "EALLOW; MOVW DP,#0x7010 >> 6; MOV @0x701C,#0x0400; EDIS; MOVW DP,#0x7050 >> 6"
    wait = HEAD.replace("#0x68", "#0x28") + lines(f"{clock}; w: MOV AL,@0x7054; SB w,NEQ; ESTOP0", "w", 0)
    rigs = [Rig(wait, "SCI-A", skip=skip) for skip in (True, False)]
    waits = [rig.record_waits() for rig in rigs]
    for rig in rigs:
        rig.run(14_000_000)
    assert [rig.dsp.resets for rig in rigs] == [1, 1]
    assert rigs[0].cpu.state()[:TIMING] == rigs[1].cpu.state()[:TIMING]
    recorded = [[(one.tick, one.what, one.value) for one in some] for some in waits]
    assert [one[1:] for one in recorded[0]] == [(SCICTL2, 1), (SCICTL2, 0), (SCICTL2, 1)]
    assert recorded[0] == recorded[1]


def test_a_bit_that_is_not_tested_changes_while_a_pass_is_examined():
    """TXRDY and TXEMPTY change some time after the loop has begun; it is still skipped."""
    for before in range(120):
        wait = f"MOVW DP,#0x1C1; MOV @0x7059,#0x41; RPT #{before} || NOP; w: TBIT @0x7054,#0; SB w,NTC"
        hardware = HARDWARE.format(baud=1, period=60_000, interrupts="NOP")
        rig = Rig(HEAD + hardware + lines(wait, "w", 0) + " ESTOP0\n" + ROUTINE.format(every=2), "SCI-A", "TIMER0")
        rig.run(1_500_000)
        assert rig.cpu.polls.asleep, before
