"""Errors of machine code end the run or are noted: the stack, odd addresses, illegal words, memory without contents."""

from __future__ import annotations

import pytest

from periph_sim.processor.user_code import FirmwareLost
from tests.processor.image.rig import ENPIE, HEAD, Rig

STACK = ' .reserve ".stack", 0x400, 16\n' + HEAD
TAKEN = " OR IFR,#0x1000\n OR IER,#0x1000\n CLRC INTM\n NOP\n ESTOP0"


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        (
            STACK + "loop: PUSH ACC\n SB loop,UNC",
            r"the stack grew beyond its section .stack, 0x0400 to 0x040f; at _c_int00\+0x\w+ \(0x0090\w+\)",
        ),
        (STACK + " POP ACC\n ESTOP0", "the stack was popped below its section .stack"),
        (STACK + "_f: LCR #_f", r"the stack grew beyond .*; last jumps: .*_c_int00"),
        (HEAD + " MOVL XAR4,#0x9101\n MOVL *XAR4,ACC\n ESTOP0", "32 bits are written to the odd address 0x009101"),
        (HEAD + " MOVL XAR4,#0x9101\n MOVL ACC,*XAR4\n ESTOP0", "32 bits are read from the odd address 0x009101"),
        (
            HEAD + " .word 0xE271\n ESTOP0",
            r"F28335, but of the TMU of an F2837x; at _c_int00\+0x6 \(0x009006\), ACC=0x00000000 RPC=0x000000 "
            r"SP=0x0400 DP=0x01c0 ST0=0x0000 ST1=0x0a0b IER=0x0000 and 0 in other registers; last jumps: none",
        ),
        (HEAD + " .word 0xE5F0\n ESTOP0", "but of the VCU of an F2806x or F2837x"),
        (HEAD + " .word 0x7628\n ESTOP0", "0x7628 0x7625 is not an instruction of the F28335; at"),
        (
            HEAD + " MOVL XAR6,#5\n LB #0xA000",
            "nothing was loaded to 0x00a000, or written there; at .* XAR6=0x00000005 RPC",
        ),
        (HEAD + " .word 0\n", "0x0000 is the illegal instruction"),
        (
            HEAD + " LB #0x3F0000",
            "code is fetched from 0x3f0000, where there is no memory; .*last jumps: _c_int00 0x0090",
        ),
        (HEAD + " LB #0x7100", "code is fetched from 0x007100, where there is no memory"),
        (HEAD + " MOVL XAR4,#0x3FFFB9\n CMP *XAR4,#-2", "0x3fffb9 of the boot ROM is read: erasing and programming"),
        (HEAD + " LB #0x3FF34C", "code is fetched from 0x3ff34c: routines of the boot ROM are not modelled"),
        (HEAD + " SETC AMODE", "C2xLP"),
        (
            HEAD + " EALLOW\n MOVW DP,#0x0A89 >> 6\n MOV @0x0A89,#5",
            "flash control .* is written: erasing and programming",
        ),
        (HEAD + " NOP", "nothing was loaded to 0x009007, or written there"),
        (
            HEAD + TAKEN,
            r"^dsp: INT13 was taken at cycle \d+ with PIECTRL.ENPIE = 0, .*; at .*, ACC=0x00000000 .* last jumps",
        ),
        (HEAD + " TRAP #20", r"^dsp: the vector 20 of TRAP or INTR was taken at cycle \d+ with PIECTRL.ENPIE = 0, .*"),
        (HEAD + ENPIE + " MOV @SP,#0x7000\n TRAP #20", r"^dsp: SP = 0x7000 at cycle \d+; 0x7000 is not memory; at .*"),
        (HEAD + ENPIE + " MOV @SP,#0x2000\n INTR INT1", r"^dsp: SP = 0x2000 at cycle \d+; 0x2000 is not memory"),
        (HEAD + ENPIE + " MOV @SP,#0x7F8\n TRAP #20", r"^dsp: SP = 0x7f8 at cycle \d+; 0x0805 is not memory"),
        (HEAD + " MOV @SP,#0x7000\n" + TAKEN, r"^dsp: SP = 0x7000 at cycle \d+; 0x7000 is not memory; at .*last jumps"),
    ],
)
def test_the_run_ends_with_place_registers_and_last_jumps(source: str, sentence: str):
    with pytest.raises(FirmwareLost, match=sentence) as error:
        Rig(source).run()
    assert "\n" not in str(error.value)


def test_a_stack_pointer_set_to_another_section_is_that_of_a_task():
    rig = Rig(STACK + " MOV @SP,#0x9400\n PUSH ACC\n PUSH ACC\n MOV @SP,#0x400\n PUSH ACC\n ESTOP0").run()
    assert (rig.program.finished, rig.cpu.sp) == (True, 0x402)


@pytest.mark.parametrize("reserved", ["0x0, 0x100", "0x9800, 1"])  # at the reset SP is elsewhere; one word is no stack
def test_a_stack_section_without_sp_at_the_reset_or_of_one_word_is_not_checked(reserved: str):
    rig = Rig(f' .reserve ".stack", {reserved}\n{HEAD} PUSH ACC\n MOV @SP,#0x9800\n PUSH ACC\n ESTOP0').run()
    assert (rig.program.finished, rig.cpu.sp) == (True, 0x9802)


def test_32_bit_accesses_by_an_odd_stack_pointer_use_the_even_address():
    rig = Rig(HEAD + " ADDB SP,#1\n MOVB ACC,#5\n MOVL *SP++,ACC\n MOVB ACC,#0\n MOVL ACC,*--SP\n ESTOP0").run()
    assert (rig.program.finished, rig.cpu.acc, rig.word(0x400)) == (True, 5, 5)


def test_an_instruction_that_rpt_cannot_repeat_is_executed_once_and_noted():
    """RPT of an instruction that can be repeated is not noted."""
    rig = Rig(HEAD + " RPT #3\n || INC @AR1\n RPT #3\n || ADDB XAR2,#1\n RPT #3\n || NOP\n ESTOP0").run()
    assert rig.program.finished and rig.cpu.xar[2] == 1
    assert [text for text in rig.notes() if "RPT" in text] == [
        f"RPT precedes an instruction that cannot be repeated, at {at}; it is executed once"
        for at in ("0x009007", "0x009009")
    ]


def test_l0_to_l3_are_mirrored_at_0x3f8000():
    """This holds for data and code: words written in one range are read and executed in the other."""
    swap = " MOVL XAR4,#0x9100\n MOV *XAR4,#0x9A07\n MOV *+XAR4[1],#0x0006\n"  # MOVB AL,#7; LRETR
    again = " MOVL XAR5,#0x3F9100\n MOV *XAR5,#0x9A09\n LCR #0x3F9100\n MOV @AR3,AL\n"  # MOVB AL,#9
    call = " LCR #0x3F9100\n MOV @AR2,AL\n"
    third = " MOVL ACC,*XAR5\n MOVL XAR6,@ACC\n MOV *XAR4,#0x9A0B\n LCR #0x3F9100\n ESTOP0"
    rig = Rig(HEAD + swap + call + again + third).run()
    assert rig.program.finished
    assert [rig.cpu.xar[n] for n in (2, 3, 6)] == [7, 9, 0x0006_9A09] and rig.cpu.acc & 0xFFFF == 11


def test_sections_that_share_memory_are_noted():
    rig = Rig(' .reserve ".ebss", 0x40E, 4\n' + STACK + " ESTOP0").run()
    assert rig.notes() == [
        "sections .stack and .ebss share 0x00040e to 0x00040f: unless this is a UNION in the linker's command file, "
        "one overwrites the other"
    ]


def test_a_read_of_memory_without_contents_is_noted_once_per_function():
    source = " MOVL XAR4,#0x9100\n MOV AL,*XAR4++\n MOV AL,*XAR4\n LCR #_f\n ESTOP0\n .global _f\n"
    rig = Rig(HEAD + " MOVL XAR5,#0x9110\n MOV *XAR5,#0\n MOV AL,*XAR5\n" + source + "_f: MOVL ACC,*+XAR4[3]\n LRETR")
    notes = [text for text in rig.run().notes() if "has not been written" in text]
    assert [text[: text.index(",")] for text in notes] == ["_c_int00 reads 0x9100", "_f reads 0x9104"]
