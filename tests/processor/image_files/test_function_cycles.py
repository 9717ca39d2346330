"""Cycles of each instruction of a function, with the reasons of stalls; a run takes as many."""

from __future__ import annotations

import pytest

from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.function_cycles import function_cycles
from periph_sim.processor.image_files.model import BadImage
from tests.processor.image.rig import HEAD, Rig

FUNCTION = """
 ESTOP0
 .global _f
_f: ADDB SP,#2
 MOV *-SP[1],AL
 MOV AH,*-SP[1]
 MOVL XAR4,@0x10
 MOV AL,*XAR4
 PUSH ACC
 BF there,EQ
there: B here,UNC
here: SUBB SP,#4
 LRETR
"""


def test_each_instruction_has_its_cycles_and_the_reason_for_its_stalls():
    found = function_cycles(assemble(HEAD + FUNCTION), "_f")
    assert [(row.text.split()[0], row.published, row.stall, row.why) for row in found.rows] == [
        ("ADDB", "1", 0, ""),
        ("MOV", "1", 3, "waits for SP"),
        ("MOV", "1", 3, "reads what was just written"),
        ("MOVL", "1", 0, ""),
        ("MOV", "1", 3, "waits for XAR4"),
        ("MOVL", "1", 0, "open: push_acc_cycles"),
        ("BF", "4", 0, ""),
        ("B", "7", 0, "open: b_unc_cycles"),
        ("SUBB", "1", 0, ""),
        ("LRETR", "4", 3, "waits for SP"),
    ]
    assert found.least == sum(int(row.published.split("/")[-1]) + row.stall for row in found.rows) == 34


def test_a_run_takes_the_cycles_of_the_table():
    """MOVL reads frame 2, which has 2 wait states; the LCR before takes 4 cycles, and HEAD 10."""
    source = HEAD + " LCR #_f\n" + FUNCTION
    ended = Rig(source, odd_32bit_target=0).run().program.returned_at
    assert ended == 10 + 4 + function_cycles(assemble(source), "_f").least + 2


def test_32_bits_on_the_stack_are_an_even_word_and_the_next_one():
    """SP is even in functions [SPRU514, stack alignment], so a pair of words is *-SP[4] and *-SP[3]."""
    source = HEAD + " LCR #_f\n ESTOP0\n .global _f\n_f: ADDB SP,#6\n" + " NOP\n" * 4
    source += (
        " MOVL *-SP[4],ACC\n MOV AL,*-SP[5]\n MOVL *-SP[4],ACC\n MOV AL,*-SP[3]\n SUBB SP,#6\n"
        + " NOP\n" * 4
        + " LRETR\n"
    )
    found = function_cycles(assemble(source), "_f")
    assert [row.text for row in found.rows if row.stall] == ["MOV AL,*-SP[3]"]
    assert Rig(source, odd_32bit_target=0).run().program.returned_at == 10 + 4 + found.least


READS = "reads what was just written"


@pytest.mark.parametrize(
    ("code", "stalls"),
    [
        ("MOV *-SP[2],AL\n MOV AL,*-SP[2]", [(0, ""), (3, READS)]),
        ("MOV *-SP[2],AL\n NOP\n MOV AL,*-SP[2]", [(0, ""), (0, ""), (2, READS)]),
        ("MOV *-SP[2],AL\n MOV *SP++,AH\n MOV AL,*-SP[2]", [(0, "")] * 3),  # another word, since SP has changed
        ("MOV *-SP[2],AL\n MOV AH,*--SP\n MOV AL,*-SP[2]", [(0, "")] * 3),
        ("MOV *-SP[2],AL\n ADDB SP,#1\n MOV AL,*-SP[2]", [(0, ""), (0, ""), (3, "waits for SP")]),
        ("MOV @2,AL\n MOVZ DP,#3\n MOV AL,@2", [(0, "")] * 3),  # another page
        ("MOV @2,AL\n MOV AL,*-SP[2]", [(0, "")] * 2),
        ("MOV @0x3F,AL\n MOV AL,*-SP[1]", [(0, "")] * 2),
        ("POP DP\n MOV AL,@3", [(0, ""), (3, "waits for DP")]),
        ("MOVL XAR6,@2\n MOVL XAR7,@4\n MOV *+XAR6[AR0],AL", [(0, ""), (0, ""), (2, "waits for XAR6")]),
        (
            "MOVL XAR7,@4\n MOVL XAR6,@2\n CMPR 0\n MOVL *XAR7,XAR6",
            [(0, ""), (0, ""), (0, ""), (2, "waits for XAR6 and XAR7")],
        ),
        ("MOV @1,AL\n MOVL ACC,@0", [(0, ""), (3, READS)]),
        ("MOVL @0x10,ACC\n MOV AL,@0x10", [(0, ""), (3, READS)]),
        ("MOVL @0x10,ACC\n MOV AL,@0x11", [(0, ""), (3, READS)]),
        ("MOVL @0x10,ACC\n MOV AL,@0x12", [(0, "")] * 2),
        ("MOVL @0x10,ACC\n MOV AL,@0x0F", [(0, "")] * 2),
        ("INC @1\n MOV AL,@1", [(0, ""), (3, READS)]),
        ("MOV AL,@1\n MOV AL,@1", [(0, "")] * 2),
        ("MOV *XAR4,AL\n MOV AL,*XAR4", [(0, "")] * 2),  # unknown, since it is through a pointer
    ],
)
def test_stalls_of_a_few_instructions(code: str, stalls: list[tuple[int, str]]):
    found = function_cycles(assemble(f' .sect "code", 0x8000\n .global _c_int00\n_c_int00: {code}\n'), "_c_int00")
    assert [(row.stall, row.why) for row in found.rows] == stalls
    assert found.least == sum(int(row.published) + row.stall for row in found.rows)


WAITS = "fetched with 1 wait state"


@pytest.mark.parametrize(
    ("begin", "reasons"),
    [(0xBFFF, ["", WAITS]), (0xC000, [WAITS, WAITS]), (0xFFFE, [WAITS, WAITS]), (0xFFFF, [WAITS, ""])],
)
def test_code_in_memory_with_wait_states_has_the_reason(begin: int, reasons: list[str]):
    source = f' .sect "code", {begin:#x}\n .global _c_int00\n_c_int00: NOP\n ESTOP0\n'
    assert [row.why for row in function_cycles(assemble(source), "_c_int00").rows] == reasons


def test_unknown_words_and_an_instruction_cut_off_by_its_section_have_rows():
    """0xE271 is an instruction of a TMU; 0x2809 begins MOV loc16,#16bit, whose second word is missing."""
    source = ' .sect "code", 0x8000\n .global _c_int00\n_c_int00: .word 0xE271, 0x7700, 0x2809\n'
    found = function_cycles(assemble(source + " NOP\n .entry _c_int00\n"), "_c_int00")
    assert found.rows[0] == (0x8000, ".word 0xe271", "", 0, "not an instruction", "")
    assert [row.text for row in found.rows] == [".word 0xe271", "NOP", "MOV @0x9,#0x7700"]
    cut = function_cycles(assemble(' .sect "code", 0x8000\n_c_int00: NOP\n .word 0x2809\n'), "_c_int00")
    assert [row.text for row in cut.rows] == ["NOP", "MOV @0x9,#0"]


def test_an_unknown_function_is_refused():
    with pytest.raises(BadImage, match=r"there is no function '_g'; .*_f"):
        function_cycles(assemble(HEAD + FUNCTION), "_g")


def test_a_conditional_branch_has_the_cycles_of_both_outcomes():
    """SB without a condition takes 4 cycles [SPRU430F, SB]; CLRC INTM takes 2, and LOOPZ 5 per pass."""
    code = " ESTOP0\n .global _f\n_f: SB _f,NEQ\n B _f,EQ\n LOOPZ @AL,#1\n CLRC INTM\n SB _f,UNC\n"
    found = function_cycles(assemble(HEAD + code), "_f")
    assert [row.published for row in found.rows] == ["7/4", "7/4", "5", "2", "4"]
    assert found.least == 4 + 4 + 5 + 2 + 4
