"""Passes of counting loops are skipped with the results of executing each of them."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from periph_sim.processor.c28x.encodings import by_id, encodings
from periph_sim.processor.image.boot import Stub
from periph_sim.processor.image.counting_loop import Number, Sum, passes_within, sum_of
from tests.processor.image.rig import HEAD, Rig
from tests.processor.image.test_polls import ADCST, HARDWARE, ROUTINE, both, lines
from tests.profiles import examples

DATA = "MOVW DP,#0x9140 >> 6; MOVL XAR5,#0x7054; "  # words of memory, and SCICTL2
SHORT, LONG = 1000, 100_000
# The code before the loop, and the loop; `count` is the number of passes
SHAPES = {
    "DELAY_US": ("MOVL XAR3,#{count}; MOVL ACC,@XAR3", "SUBB ACC,#1; BF {n},GEQ"),
    "to an address": ("MOVB XAR1,#0; MOVL XAR2,#{count}", "ADDB XAR1,#1; BAR {n},AR1,AR2,NEQ"),
    "BANZ": ("MOVL XAR3,#{count}", "NOP; BANZ {n},AR3--"),
    "for, in memory": ("MOV @0,#0; MOV AL,#{count}", "INC @0; CMP AL,@0; SB {n},HI"),
    "for, by a register": ("MOV @0,#0", "INC @0; MOV AL,@0; CMPB AL,#250; SB {n},LO"),
    "for, by a constant": ("MOV @0,#0", "INC @0; CMP @0,#{count}; SB {n},LO"),
    "while (n--)": ("MOV @0,#{count}", "MOV AL,@0; ADDB AL,#-1; MOV @0,AL; CMPB AL,#0; SB {n},NEQ"),
    "while (n--), 32 bits": ("MOVL XAR3,#{count}; MOVL @0,XAR3", "MOVB ACC,#1; SUBL @0,ACC; MOVL ACC,@0; SB {n},NEQ"),
    "up to, 32 bits": (
        "MOVL XAR3,#{count}; MOVL @2,XAR3; ZAPA; MOVL @0,ACC",
        "MOVL ACC,@0; ADDB ACC,#1; MOVL @0,ACC; CMPL ACC,@2; SB {n},LO",
    ),
    "time-out": ("MOVL XAR3,#{count}", "TBIT *XAR5,#3; SB x{n},TC; BANZ {n},AR3--; x{n}: NOP"),
    "time-out, in memory": ("MOV @0,#{count}", "TBIT *XAR5,#3; SB x{n},TC; DEC @0; SB {n},NEQ; x{n}: NOP"),
    "time-out, by a function": (
        "MOV @0,#{count}", "LCR #_ready; CMPB AL,#1; SB x{n},EQ; DEC @0; SB {n},NEQ; x{n}: NOP",
    ),
}  # fmt: skip
READY = " .global _ready\n_ready: ADDB SP,#2\n AND AL,*XAR5,#0x8\n MOV *-SP[1],AL\n SUBB SP,#2\n LRETR\n"
# Loops that do more than count: they use a counter in another way, or change something else
OTHERS = {
    "a string": ("MOVL XAR4,#0x9180; MOVL XAR6,#0x9210; MOV *XAR6,#1", "MOV AL,*XAR4++; SB {n},EQ"),
    "compared with a string": (
        "MOVB AL,#1; MOVL XAR4,#0x9180; MOVL XAR6,#0x9210; MOV *XAR6,#145",
        "CMP AL,*XAR4; SB x{n},EQ; ADDB AL,#1; ADDB XAR4,#1; SB {n},UNC; x{n}: NOP",
    ),
    "saturated": (
        "SETC OVM; MOVL XAR2,#400; MOV @4,#0xFF90; MOV @5,#0x7FFF; MOVB XAR3,#200",
        "SUBB XAR2,#2; MOVL ACC,@4; ADDL ACC,@XAR2; SB y{n},OV; y{n}: MOVB ACC,#0; BANZ {n},AR3--",
    ),
    "copied": ("MOVL XAR4,#0x9180; MOVL XAR6,#0x9600; MOVB XAR3,#200",
               "MOV AL,*XAR4++; MOV *XAR6++,AL; BANZ {n},AR3--"),
    "shifted": ("MOVB XAR3,#200; MOVB ACC,#5", "ROL ACC; BANZ {n},AR3--"),
    "a product": ("MOVB XAR3,#200", "MOV T,@0; INC @0; MPY P,T,@0; BANZ {n},AR3--"),
    "added up": ("MOVB XAR3,#200; MOV @0,#0; MOV @1,#0", "INC @0; MOV AL,@0; ADD @1,AL; BANZ {n},AR3--"),
    "one bit": ("MOV @0,#0", "INC @0; TBIT @0,#8; SB {n},NTC"),
    "one byte": ("MOV @0,#0", "INC @0; MOV AL,@0; MOV @1,AL; MOVB AL,#0; MOVB @1,AL.LSB; TBIT @1,#8; MOV @1,#0; "
                 "SB {n},NTC"),
    "under a condition": ("MOV @0,#0", "INC @0; MOV AL,@0; MOV @1,AL; MOVB @1,#5,LT; TBIT @1,#8; MOV @1,#0; "
                          "SB {n},NTC"),
    "an index": ("MOVB XAR0,#200; MOVL XAR4,#0x9180; MOV *+XAR4[6],#1", "MOV AL,*+XAR4[AR0]; SB x{n},NEQ; "
                 "SUBB XAR0,#1; SB {n},UNC; x{n}: NOP"),
    "compared by ARP": ("MOVB XAR0,#200; MOVB XAR1,#0; NOP *,ARP1", "ADDB XAR1,#1; CMPR 0; SB {n},NTC"),
    "a float": ("MOVB XAR3,#200; ZERO R0H", "ADDF32 R0H,#0x3F80,R0H; NOP; BANZ {n},AR3--"),
    "interrupts off and on": ("MOVB XAR3,#200", "SETC INTM; NOP; CLRC INTM; BANZ {n},AR3--"),
}  # fmt: skip


def source(before: str, loop: str, count: int = SHORT, end: str = "ESTOP0") -> str:
    code = f"{DATA}{before}; {{n}}: {loop}; {end}"
    return HEAD + lines(code.replace("#{count}", f"#{count}"), "w", count) + READY


@pytest.mark.parametrize("name", SHAPES)
def test_most_passes_of_a_counting_loop_are_skipped(name: str):
    skipped, came = both(source(*SHAPES[name]), ticks=60_000_000)
    assert came["ended"] is not None
    assert skipped > (150 if name == "for, by a register" else SHORT - 90)


def test_counts_of_more_than_16_bits_are_skipped():
    skipped, came = both(source(*SHAPES["DELAY_US"], count=65536 + 500), ticks=200_000_000)
    assert came["ended"] is not None
    assert skipped > 65536 - 300


@pytest.mark.parametrize("name", OTHERS)
def test_passes_that_do_more_than_count_are_executed(name: str):
    skipped, came = both(source(*OTHERS[name]))
    assert (skipped, came["ended"] is not None) == (0, True)


CONDITIONS = (
    "EQ",
    "GEQ",
    "GT",
    "HI",
    "HIS",
    "NOV",
)  # no condition together with its opposite, since the cycles of the pair would never change
# Instructions that set flags and advance a counter in @0 or @2:3, and values of the counter to pass
CROSSINGS = {
    "INC @0": (0, 0x8000), "DEC @0": (0, 0x8000), "INC @0; MOV AL,@0": (0, 0x8000), "ADD @0,#7": (0, 0x8000),
    "INC @0; MOVB AL,#0x10; CMP AL,@0": (0x10, 0x8000, 0x8010), "DEC @0; CMP @0,#0x1000": (0, 0x1000, 0x8000, 0x9000),
    "INC @0; MOV AL,@0; CMPB AL,#0x20": (0, 0x20, 0x8000, 0x8020), "INC @0; MOV AL,@0; ADD AL,@1": (0, 0x7FF0, 0xFFF0),
    "MOV AL,@0; ADDB AL,#-1; MOV @0,AL": (0, 0x8000), "INC @0; MOVU ACC,@0": (0, 0x8000),
    "MOVL ACC,@2; ADDB ACC,#1; MOVL @2,ACC": (0, 1 << 16, 1 << 31),
    "MOVL ACC,@2; SUBB ACC,#1; MOVL @2,ACC": (0, 1 << 31),
    "MOVB ACC,#1; ADDL @2,ACC; MOVL ACC,@2; CMPL ACC,@4": (0, 0x12340, 1 << 31, 1 << 31 | 0x12340),
    "MOVB ACC,#1; SUBL @2,ACC; MOVL ACC,@2; TEST ACC": (0, 1 << 31),
    "MOVL ACC,@2; ADDB ACC,#1; MOVL @2,ACC; CMP @2,#0x1000": (0x1000, 0x8000, 0x9000),
    "MOVL ACC,@2; ADDB ACC,#1; MOVL @2,ACC; MOV AL,#0x1000; CMP AL,@2": (0x1000, 0x8000, 0x9000),
    "MOVL ACC,@2; ADDB ACC,#1; MOVL @2,ACC; MOV AL,@2": (0x8000, 0x10000),
    "INC @0; MOVL ACC,@4; ADDU ACC,@0": (0, 0x8000, 0xDCC0),
    "DEC @0; MOVL ACC,@4; SUBU ACC,@0": (0, 0x2340, 0x8000),
}  # fmt: skip


@pytest.mark.parametrize("flags", CROSSINGS)
def test_flags_change_in_the_same_pass_as_without_skipping(flags: str):
    """A taken branch costs more than one not taken, so equal flags give equal cycles after the loop."""
    branches = "; ".join(f"SB {{n}}y{at},{condition}; {{n}}y{at}: NOP" for at, condition in enumerate(CONDITIONS))
    step = 7 if "#7" in flags else -1 if "DEC" in flags or "#-1" in flags or "SUB" in flags else 1
    constants = "MOV @4,#0x2340; MOV @5,#1; MOVB ACC,#0; ZAP OVC; MOVL XAR3,#190"
    every = 0
    for bound in CROSSINGS[flags]:
        begin = bound - 110 * step & 0xFFFF_FFFF
        counter = f"MOV @0,#{begin & 0xFFFF}; MOV @1,#0x10; MOV @2,#{begin & 0xFFFF}; MOV @3,#{begin >> 16}"
        text = source(f"{counter}; {constants}", f"{flags}; {branches}; BANZ {{n}},AR3--")
        skipped, came = both(text, ticks=40_000_000)
        assert came["ended"] is not None
        every += skipped
    assert every > 20


def test_interrupts_and_flags_end_a_loop_in_the_same_cycle_as_without_skipping():
    """SCI-A sends, and the time-out ends before TXEMPTY or after it."""
    for count in (600, 900, 60_000):
        for period in (450, 1201):
            send = "MOVL XAR5,#0x9180; MOVW DP,#0x1C1; MOV @0x7059,#0x41; MOVL XAR3,#{count}"
            wait = "{n}: TBIT @0x7054,#6; SB x{n},TC; BANZ {n},AR3--; x{n}: MOVL *XAR5,XAR3; ESTOP0"
            hardware = HARDWARE.format(baud=255, period=period, interrupts="CLRC INTM")
            text = HEAD + hardware + lines(f"{send}; {wait}", "w", count) + ROUTINE.format(every=3)
            skipped, came = both(text, ticks=60_000_000)
            assert came["ended"] is not None and skipped > 10


def test_a_stub_ends_a_counting_loop():
    loop = (
        f"MOVL XAR3,#60000; MOVW DP,#{ADCST} >> 6; w: TBIT @{ADCST},#0; SB x,TC; BANZ w,AR3--; x: MOVL XAR4,#0; ESTOP0"
    )
    for ready in range(6_000_000, 6_001_000, 241):
        skipped, came = both(
            HEAD + lines(loop, "w", 0), (Stub(0, ADCST, 0x10), Stub(ready, ADCST, 0x11)), ticks=9_000_000
        )
        assert came["ended"] is not None and skipped > 500


def test_a_wait_for_the_pll_with_a_time_out_is_skipped():
    """The clock changes at the end of the wait, or while the time-out is still being counted."""
    for count in (400, 60_000):
        lock = f"EALLOW; MOVL XAR3,#{count}; MOVW DP,#0x7011 >> 6; MOV @0x7021,#10"
        wait = "w: TBIT @0x7011,#0; SB x,TC; BANZ w,AR3--; x: RPT #200 || NOP; MOVL XAR3,#9000; d: BANZ d,AR3--; ESTOP0"
        skipped, came = both(HEAD + lines(f"{lock}; {wait}", "w", 0), ticks=40_000_000)
        assert came["ended"] is not None and skipped > 8000


def waits_of(rig: Rig) -> list[tuple[str, int]]:
    waits = rig.record_waits()
    rig.run()
    return [(one.what, one.value) for one in waits]


def test_a_time_out_is_recorded_as_a_wait_and_a_delay_is_not():
    assert waits_of(Rig(source(*SHAPES["time-out"]), "SCI-A")) == [("SCI-A.SCICTL2.all", 1), ("SCI-A.SCICTL2.all", 0)]
    assert waits_of(Rig(source(*SHAPES["DELAY_US"]))) == []


def test_a_reset_within_a_pass_leaves_memory_as_without_skipping():
    """The watchdog resets the unit after 32768 cycles; the loop continues from the count that it finds."""
    loop = "w: LCR #_ready; INC @0; MOV @1,#5; MOV AL,@0; MOV @2,AL; MOV @1,#6; MOV @2,#7; CMP @0,#1500; SB w,LO"
    for late in range(0, 33, 8):
        code = lines(f"{DATA}RPT #{late} || NOP; {loop}; ESTOP0", "w", 0)
        rigs = [Rig(HEAD.replace("#0x68", "#0x28") + code + READY, "SCI-A", skip=skip) for skip in (True, False)]
        found = []
        for rig in rigs:
            rig.run(13_040_000)
            assert not rig.dsp.resets
            while not rig.dsp.resets:
                rig.run(2000)
            found.append((rig.kernel.now, [rig.word(address) for address in (0x401, 0x9140, 0x9141, 0x9142)]))
        assert found[0] == found[1]
        assert rigs[0].program.polls_skipped > 500


def test_passes_until_a_number_reaches_the_bound():
    for value in range(-40, 40):
        for step in (-7, -3, -1, 1, 2, 5):
            passes = passes_within(Number(value, step), 8)
            parts = [((value + n * step) // 8, (value + n * step) % 8 == 0) for n in range(passes + 2)]
            assert len(set(parts[: passes + 1])) == 1
            assert parts[passes + 1] != parts[0] or not value % 8
    assert passes_within(Number(8, 0), 8) > 1 << 40


# Random loops ----------------------------------------------------------------------------

COUNTING = (
    "ADDB AL,#{k}", "ADDB AL,#-{k}", "ADDB AH,#{k}", "SUBB ACC,#{k}", "ADDB ACC,#{k}", "INC @{w}", "DEC @{w}",
    "ADD @{w},#{k}", "ADDB XAR2,#{k}", "SUBB XAR2,#{k}", "ADDB XAR6,#1", "MOV AL,@{w}", "MOV AH,@{w}",
    "MOV @{w},AL", "MOV @{w},AH",
    "MOVL ACC,@{l}", "MOVL @{l},ACC", "MOVU ACC,@{w}", "ADD AL,@{w}", "SUB AL,@{w}", "ADD @{w},AL", "SUB @{w},AL",
    "ADDL ACC,@{l}", "SUBL ACC,@{l}", "ADDL @{l},ACC", "SUBL @{l},ACC", "CMP AL,@{w}", "CMPB AL,#{k}", "CMP @{w},#{k}",
    "CMPL ACC,@{l}", "MOVZ AR2,@{w}", "MOV @{w},AR2", "MOVL XAR2,@{l}", "MOVL @{l},XAR2", "TEST ACC", "CMP AL,@AH",
    "MOV AL,@AH", "MOV @AL,AR2", "INC @AL", "MOVL ACC,@XAR2", "MOVZ AR2,@AL", "ADDU ACC,@{w}", "SUBU ACC,@{w}",
    "MOVZ AR6,@{w}",
)  # fmt: skip
OTHER = (
    "NOP", "TBIT *XAR5,#6", "MOVB AL,#{k}", "MOVB ACC,#{k}", "AND AL,*XAR5,#0x8", "MOVB AH,#{k}", "LCR #_ready",
    "RPT #{k} || NOP", "LSL ACC,#1", "MOV T,@{w}", "MOVB @{w},#{k},EQ", "MOVB @{w},#{k},LT", "NEG ACC", "ABS ACC",
    "MOVB AL.LSB,@{w}", "MOVB @{w},AL.MSB", "MOV *SP++,AL; MOV AH,*--SP", "MOV AL,*XAR6", "SETC C", "CLRC TC",
    "SAT ACC",
    "ADDCU ACC,@{w}", "NOT AL", "XOR AL,@{w}", "MOV ACC,@{w}<<4", "SETC OVM", "CLRC OVM", "ZAP OVC", "SETC SXM",
    "MOV @{w},AL,LT", "MINL ACC,@{l}", "MOVL P,ACC", "ADDL ACC,P<<PM", "DMOV @{w}", "MOV PL,@{w}",
)  # fmt: skip
JUMPS = ("SB y{n},EQ", "SB y{n},GT", "SB y{n},HIS", "SB y{n},NOV", "SB y{n},LT", "SB y{n},NC", "SB y{n},TC", "NOP")
ENDS = (0, 1, 30, 0x7F80, 0x8000, 0xFF90, 0xFFFF)


def random_loop(draw: random.Random, n: str) -> str:
    """Return a loop that counts XAR3 down and executes a few other instructions, most of which count too."""
    w, ell = (lambda: str(draw.randrange(6))), (lambda: str(2 * draw.randrange(3)))
    body = []
    for at in range(draw.randrange(1, 6)):
        pool = OTHER if draw.random() < 0.2 else COUNTING
        one = draw.choice(pool).format(k=draw.choice((1, 1, 1, 2, 3, 17)), w=w(), l=ell())
        if draw.random() < 0.3:
            one = f"{draw.choice(JUMPS).format(n=f'{n}{at}')}; {one}; y{n}{at}: NOP"
        body.append(one)
    set_up = [f"MOV @{at},#{draw.choice(ENDS) + draw.randrange(-3, 3) & 0xFFFF}" for at in range(6)]
    set_up += [f"MOVL XAR2,#{draw.choice(ENDS)}", "MOVL XAR6,#0x9180", f"MOVL ACC,@{ell()}"]
    set_up.append(f"MOVL XAR3,#{draw.randrange(60, 900)}")
    return "; ".join([*set_up, f"{n}: {'; '.join(body)}", f"BANZ {n},AR3--", "MOVL @8,ACC"])


def random_program(draw: random.Random) -> str:
    interrupts = draw.choice(("CLRC INTM", "NOP"))
    hardware = HARDWARE.format(baud=draw.randrange(1, 9), period=draw.randrange(700, 9000), interrupts=interrupts)
    loops = "".join(lines(f"{DATA}{random_loop(draw, f'l{at}')}", "", 0) for at in range(3))
    return HEAD + hardware + loops + " ESTOP0\n" + ROUTINE.format(every=3) + READY


@settings(max_examples=examples(8), deadline=None)
@given(seed=integers(0, 1_000_000))
def test_skipping_changes_nothing(seed: int):
    assert both(random_program(random.Random(seed)), ticks=60_000_000)[1]["ended"] is not None


def test_most_of_the_random_loops_are_skipped():
    skipped = [both(random_program(random.Random(seed)), ticks=60_000_000)[0] > 0 for seed in range(5)]
    assert sum(skipped) >= 3


SUMS = {
    "ADDB_ACC_8", "ADDB_AX_8s", "ADDB_XARn_7", "ADDL_ACC_loc32", "ADDL_loc32_ACC", "ADDU_ACC_loc16", "ADD_AX_loc16",
    "ADD_loc16_16s", "ADD_loc16_AX", "BANZ_off16_ARndec", "DEC_loc16", "INC_loc16", "SUBB_ACC_8", "SUBB_XARn_7",
    "SUBL_ACC_loc32", "SUBL_loc32_ACC", "SUBU_ACC_loc16", "SUB_AX_loc16", "SUB_loc16_AX",
    "BAR_off16_ARn_ARm_EQ", "BAR_off16_ARn_ARm_NEQ", "CMPB_AX_8", "CMPL_ACC_loc32", "CMP_AX_loc16", "CMP_loc16_16s",
    "TEST_ACC", "MOVL_ACC_loc32", "MOVL_loc32_ACC", "MOVU_ACC_loc16", "MOVZ_AR6_loc16", "MOVZ_AR7_loc16",
    "MOVZ_ARn_loc16", "MOV_AX_loc16", "MOV_loc16_ARn", "MOV_loc16_AX",
    *(f"MOVL_XAR{n}_loc32" for n in range(8)), *(f"MOVL_loc32_XAR{n}" for n in range(8)),
}  # fmt: skip
SIDES = {
    "SUBL_loc32_ACC": Sum("loc", "loc", -1, "ACC"), "MOVZ_ARn_loc16": Sum("XARn", "loc", 1, "0"),
    "BAR_off16_ARn_ARm_NEQ": Sum("", "ARn", -1, "ARm"), "TEST_ACC": Sum("", "ACC", -1, "0"),
}  # fmt: skip
NUMBERS = [("simm8", 0xFF, 0xFFFF), ("simm16", 0x8000, 0x8000), ("uimm8", 0xFF, 0xFF), ("1", 7, 1), ("loc", 7, None)]


def test_forms_that_are_a_sum_or_a_copy_or_a_comparison():
    assert {row.id for row in encodings() if sum_of(row) is not None} == SUMS
    assert {name: sum_of(by_id()[name]) for name in SIDES} == SIDES
    assert [Sum("AX", "AX", 1, right).number(c) for right, c, _ in NUMBERS] == [number for _, _, number in NUMBERS]
