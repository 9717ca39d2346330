"""Decoded instructions have the text that TI's tools show."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.processor.c28x.decoder import Instruction, decode_at, sweep

AT = 0x8000

# words and text, derived by hand from the opcode rows of SPRU430F and SPRUEO2A
SHOWN = [
    ((0x7700,), "NOP"),
    ((0x7640 | 0x00, 0x8594), "LCR #0x8594"),
    ((0x0006,), "LRETR"),
    ((0x7602,), "IRET"),
    ((0x761F, 0x01C5), "MOVW DP,#0x1c5"),
    ((0x2942,), "CLRC OVM,PAGE0"),
    ((0x3B10,), "SETC INTM"),
    ((0xE610, 0x0200), "SETFLG RNDF32=1"),
    ((0x28A9, 0x1234), "MOV @AL,#0x1234"),
    ((0x1AA9, 0x0001), "OR @AL,#1"),
    ((0x0841, 0xFFFF), "ADD *-SP[1],#-1"),
    ((0x9C7F,), "ADDB AL,#127"),
    ((0x9DFF,), "ADDB AH,#-1"),
    ((0xFFEF, 0xFFFE), "B 0x007ffe,UNC"),
    ((0x60FE,), "SB 0x007ffe,NEQ"),
    ((0xEC02,), "SBF 0x008002,EQ"),
    ((0x000C, 0x0000), "BANZ 0x008000,AR4--"),
    ((0x8F00 | 0x00, 0x8594), "MOVL XAR4,#0x8594"),
    ((0xC5BE,), "MOVL XAR7,*--SP"),
    ((0x06A9,), "MOVL ACC,@ACC"),
    ((0x06AB,), "MOVL ACC,@P"),
    ((0x92A4,), "MOV AL,@AR4"),
    ((0x9284,), "MOV AL,*XAR4++"),
    ((0x928C,), "MOV AL,*--XAR4"),
    ((0x9294,), "MOV AL,*+XAR4[AR0]"),
    ((0x92DC,), "MOV AL,*+XAR4[3]"),
    ((0x92B4,), "MOV AL,*,ARP4"),
    ((0x92BF,), "MOV AL,*AR6%++"),
    ((0xFF33,), "LSL ACC,#4"),
    ((0xFFAF,), "ASR AL,#16"),
    ((0x4C05,), "TBIT @0x5,#12"),
    ((0xFF69,), "SPM 0"),
    ((0xFF68,), "SPM +1"),
    ((0xF609,), "RPT #9"),
    ((0x2484,), "PREAD *XAR4++,*XAR7"),
    ((0x0011,), "INTR INT2"),
    ((0x0025,), "TRAP #5"),
    ((0xE802, 0x0000), "MOVIZ R0H,#0x4000"),
    ((0xE880 | 0x10, 0x0008), "ADDF32 R0H,#2.0,R1H"),
    ((0xE710, 0x0088), "ADDF32 R0H,R1H,R2H"),
    ((0xE2AF, 0x00C4), "MOV32 R0H,*+XAR4[0]"),
    ((0xE2A1, 0x00C4), "MOV32 R0H,*+XAR4[0],EQ"),
    ((0xAD14,), "MOVST0 NF,ZF"),
    ((0xB588, 0x0009), "RPTB 0x00800a,#9"),
    ((0xFFF0,), "PUSH RB"),
]


@pytest.mark.parametrize(("words", "text"), SHOWN, ids=[text for _, text in SHOWN])
def test_text(words: tuple[int, ...], text: str):
    found = decode_at(AT, words[0], words[-1])
    assert found is not None
    assert (found.text, found.words) == (text, len(words))


def test_a_sweep_returns_the_address_of_an_unknown_word_and_continues_after_it():
    found = list(sweep(AT, [0x7700, 0xFF60, 0x7640, 0x8000]))
    assert [one if isinstance(one, int) else one.text for one in found] == ["NOP", AT + 1, "LCR #0x8000"]


def test_an_instruction_cut_off_by_the_end_of_its_section_is_an_unknown_word():
    assert list(sweep(AT, [0x7640])) == [AT]


@given(st.lists(st.integers(0, 0xFFFF), max_size=12))
def test_a_sweep_of_any_words_has_no_gap_and_no_overlap(words: list[int]):
    at = AT
    for one in sweep(AT, words):
        assert at == (one.address if isinstance(one, Instruction) else one)
        at += one.words if isinstance(one, Instruction) else 1
        assert isinstance(one, int) or one.text
    assert at == AT + len(words)
