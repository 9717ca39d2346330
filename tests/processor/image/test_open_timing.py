"""Each answer to what TI leaves open about the time of an image's instructions, to the cycle."""

from __future__ import annotations

import pytest

from periph_sim.core.options import Value
from periph_sim.core.records import Kind
from tests.processor.image.rig import HEAD, Rig

# Interrupts ---------------------------------------------------------------------------------------------------------

VECTOR = """
 MOVL XAR4,#_routine
 EALLOW
 MOVL XAR5,#0x0D4C
 MOVL *XAR5,XAR4
 EDIS
"""
TIMER = (
    VECTOR
    + """
 MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE0,#1
 MOV @0x0CE2,#0x40
 MOVW DP,#0x0C00 >> 6
 MOVL XAR6,#199
 MOVL @0x0C02,XAR6
 MOV @TCR,#0x4020
 OR IER,#1
"""
)
CYCLE = 400  # ticks: the CPU runs on a quarter of 30 MHz


def asleep(intm: str, **options: Value) -> tuple[int, int]:
    """A program that sleeps in IDLE until timer 0: (the cycle of ESTOP0, the tick of the routine's first one)."""
    source = f"{HEAD}{TIMER} {intm} INTM\n IDLE\n ESTOP0\n .global _routine\n_routine: IRET\n"
    rig = Rig(source, "TIMER0", **options).run()
    assert rig.program.returned_at is not None
    entered = [record.tick for record in rig.records if record.kind is Kind.IRQ and record.value]
    return rig.program.returned_at, entered[0] if entered else 0


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize("wake", [0, 1, 16])
def test_open_idle_wake(wake: int):
    """Both ways out of IDLE come later by this: through the service routine, and with INTM = 1 past it."""
    through, entered = asleep("CLRC")
    past, _ = asleep("SETC")
    assert past + 10 + 8 == through  # the entry behind the IFR bit, and IRET
    assert asleep("SETC", idle_wake=wake) == (past + wake, 0)
    assert asleep("CLRC", idle_wake=wake) == (through + wake, entered + wake * CYCLE)


@pytest.mark.rule("SYS-138", "SYS-139")
@pytest.mark.parametrize("waits", [0, 1, 2])
def test_open_vector_fetch_waits(waits: int):
    """Of an interrupt and of TRAP."""
    through, entered = asleep("CLRC")
    assert asleep("CLRC", vector_fetch_waits=waits) == (through + waits, entered + waits * CYCLE)
    trap = f"{HEAD}{VECTOR} TRAP #5\n ESTOP0\n .global _routine\n_routine: IRET\n".replace("0x0D4C", "0x0D0A")
    took = [Rig(trap, vector_fetch_waits=n).run().program.returned_at for n in (0, waits)]
    assert took[0] is not None and took[1] == took[0] + waits
