"""Accesses to constant addresses that are found in a few instructions."""

from __future__ import annotations

import pytest

from periph_sim.processor.c28x.decoder import sweep
from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.constants import accesses

Found = list[tuple[int, int, str]]


def found(code: str, *functions: str) -> Found:
    """Return address, width and kind of each access; `functions` are labels at which other functions begin."""
    image = assemble(f' .sect ".text", 0x8000\n_c_int00: NOP\n{code}\n')
    starts = frozenset(one.address for one in image.symbols if one.name in functions)
    (section,) = image.sections
    return [(one.address, one.width, one.how) for one in accesses(sweep(section.run, section.words), starts)]


@pytest.mark.parametrize("n", range(8))
def test_every_address_register_is_followed_through_every_mode(n: int):
    """The register starts at 0x7000. *XARn++ and *--XARn change it by the width of the access, indices do not."""
    p = f"XAR{n}"
    code = f"""
     MOVL {p},#0x7000
     MOV AL,*{p}++
     MOVL ACC,*{p}++
     MOV *{p},AL
     MOVL *--{p},ACC
     MOV AL,*--{p}
     ADDB {p},#5
     SUBB {p},#2
     MOV *+{p}[7],AL
     MOV AL,*{p}
     MOVB {p},#0x10
     MOV AL,*{p}
     MOVL {p},ACC
     MOV AL,*{p}
    """
    assert found(code) == [
        (0x7000, 16, "r"), (0x7001, 32, "r"), (0x7003, 16, "w"), (0x7001, 32, "w"), (0x7000, 16, "r"),
        (0x700A, 16, "w"), (0x7003, 16, "r"), (0x10, 16, "r"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("MOVW DP,#0x1C4\n MOV @0x3F,AL\n MOVL ACC,@0", [(0x713F, 16, "w"), (0x7100, 32, "r")]),
        ("MOV @3,AL", []),  # DP is unknown
        ("MOVZ DP,#0x3\n MOV @1,AL", [(0xC1, 16, "w")]),
        (
            "MOVW DP,#0xFC05\n MOV DP,#0x3FE\n MOV @1,AL",
            [(0xFFFE << 6 | 1, 16, "w")],
        ),  # MOV DP only sets the low ten bits
        ("MOV DP,#0x3FE\n MOV @1,AL", []),
        ("MOVW DP,#2\n POP DP\n MOV @1,AL", []),
        ("MOVL XAR4,#0x7000\n MOVB XAR0,#3\n MOV AL,*+XAR4[AR0]\n MOV AL,*+XAR4[AR1]", [(0x7003, 16, "r")]),
        (
            "MOVL XAR4,#0x7000\n MOVL XAR1,#0x10002\n MOV AL,*+XAR4[AR1]",
            [(0x7002, 16, "r")],
        ),  # only the low 16 bits of AR1 count
        ("MOVL XAR4,#0x7000\n MOVL @XAR4,ACC\n MOV AL,*XAR4", []),
        ("MOVL XAR4,#0x7000\n MOVL ACC,@XAR4\n MOV AL,*XAR4", [(0x7000, 16, "r")]),
        (
            "MOVL XAR4,#0x7000\n MOVL XAR5,#0x7100\n ADRK #5\n MOV AL,*XAR5",
            [],
        ),  # ADRK changes the register that ARP selects, which is unknown
        ("MOVL XAR4,#0x7000\n NOP *,ARP4\n MOV AL,*++\n MOV AL,*XAR4", []),  # the same for *++
        ("MOVL XAR6,#0x7000\n MOV AL,*AR6%++\n MOV AL,*XAR6", []),
        ("MOVL XAR4,#0x7000\n MOVB AL.LSB,*+XAR4[5]", [(0x7002, 16, "r")]),  # the index counts bytes
        ("MOVB AR6,#8\n MOV AL,*XAR6", []),  # the upper half is unknown
        ("MOVL XAR7,#0x17000\n MOVB AR7,#8\n MOV AL,*XAR7", [(0x10008, 16, "r")]),
        ("MOV AL,*XAR4++\n MOV AL,*XAR4\n ADDB XAR4,#1\n MOV AL,*XAR4", []),
        ("MOV *(0:0x0EFF),@AL\n MOV *(0:0x0F00),@AL\n MOV *(0:0x0F2F),@AL", [(0xEFF, 16, "w")]),
        ("MOV @AL,*(0:0x0F30)\n MOV *(0:0x7900),@AL", [(0xF30, 16, "r"), (0x7900, 16, "w")]),
        ("MOV32 *(0:0x9000),@ACC\n MOV32 @ACC,*(0:0x9002)", [(0x9000, 32, "w"), (0x9002, 32, "r")]),
    ],
)
def test_known_and_unknown_addresses(code: str, expected: Found):
    assert found(code) == expected


def test_the_stored_value_is_known_if_an_address_register_has_a_constant():
    code = "MOVL XAR4,#0x7000\n MOVL XAR5,#0x8123\n MOVL *XAR4,XAR5\n MOVL *XAR4,XAR6\n MOV *XAR4,AR5\n MOVL *XAR4,ACC"
    (section,) = assemble(f' .sect ".text", 0x8000\n_c_int00: {code}\n').sections
    stored = [(one.width, one.value) for one in accesses(sweep(section.run, section.words), frozenset())]
    assert stored == [(32, 0x8123), (32, None), (16, None), (32, None)]


STORE = "MOV *XAR4,AL\n"
KNOWN = [(0x7000, 16, "w")]


@pytest.mark.parametrize(
    ("code", "functions", "expected"),
    [
        (f"SB f,EQ\n {STORE} f: {STORE}", [], KNOWN * 2),
        (f"SB f,EQ\n MOVL XAR4,ACC\n SB f,UNC\n f: {STORE}", [], KNOWN),  # the state of the first branch to f
        (f"LRETR\n f: {STORE}", [], []),  # no instruction is known to lead here
        (f"back: NOP\n MOVL XAR4,ACC\n SB back,UNC\n {STORE}", [], []),  # a branch backwards makes the state unknown
        (f"LCR #f\n {STORE} f: {STORE}", [], []),
        (f"f: {STORE}", ["f"], []),
        (f"SB g,EQ\n LRETR\n f: SB h,UNC\n g: {STORE} h: LRETR", ["f"], []),  # a branch from another function
        (f".word 0xFF60\n {STORE}", [], []),
        (f"SB f,EQ\n LRETR\n .word 0xFF60\n f: {STORE}", [], []),
    ],
)
def test_known_values_follow_forward_branches_of_one_function(code: str, functions: list[str], expected: Found):
    assert found(f"MOVL XAR4,#0x7000\n {code}", *functions) == expected
