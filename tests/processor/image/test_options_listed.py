"""Programs whose records change with an option of the system: each run also lists that option as assumed."""

from __future__ import annotations

import pytest

from periph_sim.core.options import Value
from periph_sim.core.records import Record
from tests.processor.image.rig import HEAD, Rig
from tests.processor.image.test_open_timing import TIMER

ROUTINE = " .global _routine\n_routine: IRET\n"
SLEEP = f"{HEAD}{TIMER} CLRC INTM\n IDLE\n ESTOP0\n{ROUTINE}"
CLOCK_READ = f"{HEAD} MOV AL,@0x7029\n NOP\n ESTOP0\n"
STALL = f"{HEAD} MOVW DP,#0x9100 >> 6\n MOVL XAR4,@0\n MOV AL,*XAR4\n ESTOP0\n"
JUMP = f"{HEAD} .align 2\n LB #there\n .space 1\nthere: MOVL XAR6,#0x12345\n ESTOP0\n"
SCENES: dict[str, tuple[str, Value]] = {  # option -> program, the answer that is not the default
    "int_latency": (SLEEP, 16),
    "vector_fetch_waits": (SLEEP, 2),
    "idle_wake": (SLEEP, 7),
    "pf2_read_ws": (CLOCK_READ, 5),
    "pf2_write_ws": (CLOCK_READ, 5),
    "write_lands": (CLOCK_READ, 4),
    "stalls": (STALL, False),
    "saram_conflict": (STALL, 1),
    "odd_32bit_target": (JUMP, 0),
}


def ran(program: str, **options: Value) -> tuple[list[Record], int | None, set[str]]:
    """The records, the cycle of the end, and the options that are listed as assumed."""
    rig = Rig(program, "TIMER0", **options).run()
    return rig.records, rig.program.returned_at, rig.dsp.touched


@pytest.mark.parametrize("option", SCENES)
def test_an_option_that_changes_the_records_is_listed_with_either_answer(option: str):
    program, other = SCENES[option]
    *by_default, listed_by_default = ran(program)
    *by_other, listed_by_other = ran(program, **{option: other})
    assert by_default != by_other
    assert f"system.{option}" in listed_by_default & listed_by_other
