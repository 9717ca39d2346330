"""Cycles of compiled wait loops and of blocks repeated by RPTB, compared with measured or published values."""

from __future__ import annotations

import pytest

from tests.processor.image.rig import HEAD, Rig, ended

TXRDY = "w: MOVW DP,#0x1C4 | AND AL,@0x19,#0x80 | LSR AL,#7 | SBF w,EQ"
PLLLOCKS = "w: MOV AL,@0x19 | ANDB AL,#1 | CMPB AL,#1 | SB w,NEQ"
DELAY = "w: ADDB ACC,#1 | BF w,GEQ"
CALL = "w: LCR #f | CMPB AL,#0 | BF w,EQ"
CALLED = "f: MOVW DP,#0x1C4 | AND AL,@0x19,#0x10 | LSR AL,#4 | LRETR"


def source(*code: str) -> str:
    lines = " | ".join(code).split(" | ")
    return "".join(line + "\n" if ": " in line else f" {line}\n" for line in lines)


@pytest.mark.parametrize(
    ("code", "cycles", "instructions"),
    [(TXRDY, 9, 4), (PLLLOCKS, 12, 4), (DELAY, 5, 2), (f"{CALL} | ESTOP0 | {CALLED}", 18, 7)],
)
def test_a_pass_without_stalls(code: str, cycles: int, instructions: int):
    """A register of frame 2 has two wait states; no module is there, so the wait loop never ends."""
    rig = Rig(HEAD + source("MOVW DP,#0x1C4", "MOVB ACC,#0", code), skip=False, stalls=False, odd_32bit_target=0)
    rig.run(400_000)
    began = rig.program.instructions, rig.dsp.processor.time.cycle
    rig.run(4_000_000)
    made, took = rig.program.instructions - began[0], rig.dsp.processor.time.cycle - began[1]
    assert made > 1000
    assert abs(took * instructions - made * cycles) <= 2 * cycles * instructions


@pytest.mark.parametrize("count", [8, 16, 32])
@pytest.mark.parametrize(
    ("block", "cycles"), [("MOV32 R0H,*XAR4++", 8), ("MPYF32 R1H,R0H,R0H || ADDF32 R2H,R2H,R1H", 8)]
)
def test_a_repeated_block_takes_its_cycles_times_the_count(block: str, cycles: int, count: int):
    """Eight instructions of one cycle each; RPTB takes 1 cycle before them, and the jump back takes none."""

    def took(times: int) -> int:
        body = "".join(f" {block}\n" for _ in range(8))
        code = f" MOVL XAR4,#0x9400\n .align 2\n RPTB behind,#{times - 1}\n{body}behind: NOP\n ESTOP0\n"
        return ended(HEAD + code)

    assert took(count) - took(1) == (count - 1) * cycles


SQUARES = """called: ADDB AL,#-1
 RPTB behind,@AL
 MOV32 R0H,*XAR5++
 MPYF32 R1H,R0H,R0H
 NOP
 NOP
 NOP
 MOV32 *XAR4++,R1H
behind: LRETR"""
FILL = "called: ADDB AL,#-1\n RPT @AL\n || MOV *XAR4++,AL\n LRETR"
SUM = """called: MOVL XAR6,*-SP[4]
 MOVB ACC,#0
 SUBB XAR0,#1
again: ADDL ACC,*XAR6++
 BANZ again,AR0--
 LRETR"""


@pytest.mark.parametrize("count", [8, 16, 32])
@pytest.mark.parametrize(
    ("routine", "base", "each"),
    [
        (SQUARES, 4 + 1 + 4 + 4, 6),  # LCR, ADDB, RPTB with a register, LRETR
        (FILL, 4 + 1 + 4 + 4, 1),  # RPT counts one pass less than are made
        (
            SUM,
            4 + 3 + 1 + 4 + 2 - 4,
            1 + 4,
        ),  # 1 for XAR6, 3 cycles after its load; BANZ takes 4, and 2 in the last pass
    ],
)
def test_a_routine_takes_a_base_and_a_number_of_cycles_per_element(routine: str, base: int, each: int, count: int):
    """Cycles include call and return, as TI's libraries state them."""

    def took(call: str) -> int:
        code = f"""{HEAD} MOVL XAR4,#0x9400
 MOVL XAR5,#0x9600
 MOVL XAR0,#{count}
 ADDB SP,#2
 MOV @AL,#{count}
 RPT #4 || NOP
 MOVL *-SP[2],XAR5
 RPT #4 || NOP
{call} ESTOP0
 .align 2
{routine}
"""
        return ended(code)

    assert took(" LCR #called\n") - took("") == base + each * count
