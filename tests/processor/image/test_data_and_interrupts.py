"""Marks of data across interrupts: contexts that are saved and restored, and late results of the FPU.

    program --interrupt--> context in memory --IRET--> program

Marked parts of registers give marked words of the context, and these mark the parts again when they are restored.
"""

from __future__ import annotations

import pytest

from periph_sim.f28335.cpu.interrupts import CONTEXT_SP
from periph_sim.processor.c28x.data_flow import BITS
from periph_sim.processor.image.data_marks import DataMarks
from tests.processor.image.marked_programs import BEGIN, known, marked, words
from tests.processor.image.rig import HEAD, Rig, timer

FLAGS = {"C", "N", "OVC", "OVM", "PM", "SXM", "TC", "V", "Z"}
# For each word of a context, the parts of registers that IRET restores from it and that data may reach.
CONTEXT = (FLAGS, {"T"}, {"AL"}, {"AH"}, {"PL"}, {"PH"}, {"AR0"}, {"AR1"}, *[set[str]()] * 6)
HERE = 0x9800  # the address to which IRET returns
LOOP = (
    BEGIN
    + """\
 MOVB XAR6,#20
 CLRC INTM
"""
)
ROUTINE = """
 .global _routine
_routine: PUSH XAR4
 MOVL XAR4,#0x8200
 {use}
 POP XAR4
 MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE1,#1
 IRET
"""


@pytest.mark.parametrize(
    ("loop", "use", "found", "how"),
    [
        # the routine leaves data in AL and in the flags N and Z, which IRET restores: none reach the program
        (" MOVB AL,#0\n RPT #60 || NOP\n NOP\n MOV *XAR5++,AL\n", "MOV AL,*XAR4", set(), None),
        # the program has data in AL, which the interrupt saves and IRET restores
        (" MOV AL,*XAR4\n RPT #60 || NOP\n NOP\n MOV *XAR5++,AL\n", "MOVB AL,#0", {*range(0x8220, 0x8235)}, None),
        # the same at an odd SP
        (
            " MOV AL,*XAR4\n RPT #60 || NOP\n NOP\n MOV *XAR5++,AL\n ADDB SP,#1\n",
            "MOVB AL,#0",
            {*range(0x8220, 0x8235)},
            None,
        ),
        # AR2 is not saved
        (" NOP\n MOV *XAR5,AR2\n RPT #60 || NOP\n", "MOVZ AR2,*XAR4", {0x8220}, None),
        # N and Z are data, TC is not, when the interrupt comes between the test and the branch
        (" MOV AL,*XAR4\n TBIT *XAR5,#0\n RPT #60 || NOP\n SB on,TC\non: NOP\n", "NOP", set(), None),
        (" MOV AL,*XAR4\n TBIT *XAR5,#0\n RPT #60 || NOP\n SB on,NEQ\non: NOP\n", "NOP", set(), "decide a branch"),
    ],
)
def test_marks_of_registers_that_an_interrupt_saves(loop: str, use: str, found: set[int], how: str | None) -> None:
    source = f"{timer(100)}{LOOP}again:{loop} BANZ again,AR6--\n SETC INTM\n ESTOP0\n{ROUTINE.format(use=use)}"
    marks, rig = marked(source, "TIMER0")
    assert sum(one.what == "TINT0" for one in rig.records) > 10
    assert words(marks) - {*range(0x400, 0x440)} == found
    assert (marks.found is None) if how is None else (marks.found is not None and how in marks.found.how)


@pytest.mark.parametrize(("at", "parts"), list(enumerate(CONTEXT)))
def test_iret_restores_the_marks_of_a_context(at: int, parts: set[str]) -> None:
    """Data in a word of a context reach these parts; data in any other word decide how the program continues."""
    seen = []
    for value in (0, 0xFFFF if parts else 0):
        rig = Rig(HEAD + f' ADDB SP,#{CONTEXT_SP}\n IRET\n .sect "here",{HERE}\n ESTOP0')
        for word in range(len(CONTEXT)):
            rig.cpu.fill(0x400 + word, HERE if word == 12 else value if word == at else 0)
        rig.cpu.marks = DataMarks((0x400 + at,))
        rig.run()
        assert rig.program.finished
        seen.append(rig)
    marks = seen[0].cpu.marks
    assert marks is not None
    assert {name for name, bit in BITS.items() if marks.registers & bit} == parts
    assert known(seen[0]) == known(seen[-1])
    assert (marks.found is None) if parts else (marks.found is not None and "IRET" in marks.found.how)


def test_a_context_has_the_marks_of_the_parts_that_iret_restores() -> None:
    everything, inside = sum(BITS.values()), set[str]().union(*CONTEXT)
    for part, bit in BITS.items():
        marks = DataMarks()
        marks.registers = bit
        marks.entered(0x400)
        marks.registers = everything
        marks.returned(0x400, 0)
        found = {name for name, each in BITS.items() if marks.registers & each}
        assert found == {*BITS} - inside | ({part} & inside), part


@pytest.mark.parametrize(
    ("code", "use", "found"),
    [
        # the result is clean, and the old value is marked
        (" MOV32 R0H,*XAR4\n I32TOF32 R0H,R2H\n", "", set()),
        # the result is marked, and the routine replaces it
        (" I32TOF32 R0H,R1H\n", " ZERO R0H\n", set()),
        (" I32TOF32 R0H,R1H\n", "", {0x8220, 0x8221}),
    ],
)
def test_results_of_the_fpu_arrive_before_a_service_routine(code: str, use: str, found: set[int]) -> None:
    """One of the interrupts occurs after the instruction whose result is late, before its delay slot."""
    places = {}
    for cycles in range(65, 75):
        source = f"{timer(cycles)}{BEGIN} MOV32 R1H,*XAR4\n ZERO R2H\n CLRC INTM\n RPT #60 || NOP\n{code}"
        source += " .global _slot\n_slot: NOP\n NOP\n NOP\n ESTOP0\n .global _routine\n_routine:"
        marks, rig = marked(f"{source}{use} MOV32 *XAR5,R0H\n", "TIMER0", fpu_delay_slot="old_value")
        places[rig.program.place_at(rig.word(0x40C))] = words(marks)
    assert next(reached for place, reached in places.items() if place.startswith("_slot+0x0 ")) == found
