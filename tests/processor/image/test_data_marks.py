"""Marks of data in an image: where data go, which uses of data decide, and equal runs with other data.

A random program starts with data in 0x8200 and following. If its `found` is None at the end, a run with other data
takes the same cycles, and only marked words differ.
"""

from __future__ import annotations

import random

import pytest

from periph_sim.processor.c28x.data_flow import BITS
from periph_sim.processor.image.counting_loop import CountingLoop
from periph_sim.processor.image.data_marks import DataMarks
from tests.processor.c28x.execution.random_instructions import FORMS, pair_of
from tests.processor.image.marked_programs import BEGIN, DATA, OTHER, known, marked, ran, words
from tests.processor.image.rig import HEAD, Rig

SENDS = " MOVW DP,#0x7050 >> 6\n"  # the page of SCI-A
PROGRAMS = 300
LENGTH = 8  # random instructions in a program
OPERANDS = (0x41, 0x05, 0x84, 0x85, 0xA1, 0xA8, 0xA9, 0xAB, 0xC4, 0xCC, 0xC5)  # values of field l
PLAIN = [row for row in FORMS if row.kind in ("core", "fpu") and "PC" not in row.writes]


@pytest.mark.parametrize(
    ("source", "found"),
    [
        (" MOV AL,*XAR4\n MOV *XAR5,AL\n", {0x8220}),
        (" MOV AL,*XAR4\n MOV *XAR5,AL\n MOVB AL,#1\n MOV *XAR5,AL\n", set()),
        (" MOV AL,*XAR4\n MOV AH,*XAR4\n MOVB AL,#1\n MOVL *XAR5,ACC\n", {0x8220, 0x8221}),
        (" MOVL ACC,*XAR4\n MOVB AH,#0\n MOV *XAR5,AH\n MOV *+XAR5[1],AL\n", {0x8221}),
        (" MOV AL,*XAR4\n MOV *XAR5,AL\n MOV *+XAR5[1],#0\n MOVL ACC,*XAR5\n MOV *+XAR5[2],AL\n", {0x8220, 0x8222}),
        (" MOV AL,*XAR4\n MOV *XAR5,#0\n MOV *+XAR5[1],AL\n MOVL ACC,*XAR5\n MOV *+XAR5[2],AL\n", {0x8221, 0x8222}),
        (" RPT #3 || MOV *XAR5++,#0\n MOVL XAR7,#0x8202\n RPT #3 || PREAD *--XAR5,*XAR7\n", {*range(0x8220, 0x8224)}),
        (" MOVL XAR7,#0x8220\n RPT #1 || PWRITE *XAR7,*XAR4++\n", {0x8220, 0x8221}),
        (" MOV AL,*XAR4\n MOV *XAR5,AL\n MOVB AL,#0\n MOVB *+XAR5[0],AL.LSB\n", {0x8220}),
        (" MOVL XAR7,#0x3F8200\n PREAD AL,*XAR7\n MOV *XAR5,AL\n", {0x8220}),
        (" MOVL XAR6,#0x3F8220\n MOV AL,*XAR4\n MOV *XAR6,AL\n", {0x8220}),
        (" MOVL XAR6,#0x3F8200\n MOV AL,*XAR6\n MOV *XAR5,AL\n", {0x8220}),
        (" MOV AL,*XAR4\n MOV *XAR5,#0\n MOVB *+XAR5[0],AL.LSB\n MOVB AL,#0\n MOVB *+XAR5[1],AL.LSB\n", {0x8220}),
        (" MOV32 R0H,*XAR4\n I32TOF32 R1H,R0H\n NOP\n MOV32 *XAR5,R1H\n", {0x8220, 0x8221}),
        (" MOV AL,*XAR4\n CMPB AL,#3\n MOVB AL,#0\n ADDCU ACC,*+XAR4[0]\n MOV *XAR5,AL\n", {0x8220}),
        (" PUSH XAR5\n MOVL XAR5,*XAR4\n MOVL *--SP,XAR5\n SUBB SP,#2\n MOVL XAR5,#0x8220\n", {0x0400, 0x0401}),
    ],
)
def test_words_that_data_reach(source: str, found: set[int]) -> None:
    marks, _ = marked(BEGIN + source)
    stack = {*range(0x400, 0x500)} - found
    assert (words(marks) - stack, marks.found) == (found, None)


@pytest.mark.parametrize(
    ("source", "how"),
    [
        (" TBIT *XAR4,#0\n SB next,TC\nnext: NOP\n", "data decide a branch"),
        (" CMP *XAR4,#5\n NOP\n SB next,GT\nnext: NOP\n", "data decide a branch"),
        (" MOV AL,*XAR4\n MOV T,#3\n LSL AL,T\n CMPB AL,#3\n B next,HI\nnext: NOP\n", "data decide a branch"),
        (" MOVZ AR1,*XAR4\n BANZ next,AR1--\nnext: NOP\n", "data decide a branch"),
        (" MOV AL,*XAR4\n ADD AL,*XAR4\n MOVB AL,#1\n SB next,NOV\nnext: NOP\n", "data decide a branch"),
        (" LOOPNZ *XAR4,#0\n", "data decide the effect of an instruction"),
        (" MOVZ AR0,*XAR4\n MOV AL,*+XAR5[AR0]\n", "data decide the address of an access"),
        (" MOV AL,*XAR4\n ANDB AL,#1\n MOVZ AR7,AL\n ADDL @XAR7,ACC\n PREAD AL,*XAR7\n", "data decide the address"),
        (" MOV AL,*XAR4\n CMPB AL,#3\n MOVB *XAR5,#1,EQ\n", "data decide the effect of an instruction"),
        (" MOV32 R0H,*XAR4\n CMPF32 R0H,#0.0\n MOV32 R1H,R2H,EQ\n", "data decide the effect of an instruction"),
        (" AND *+XAR4[0],#3\n RPT *XAR4 || NOP\n", "data decide the effect of an instruction"),
        (" PUSH *XAR4\n POP DP\n", "data decide the effect of an instruction"),
        (" PUSH *XAR4\n POP ST0\n", None),
        (" MOV AL,*XAR4\n MOVW DP,#0x6FC0 >> 6\n MOV @0x6FC2,AL\n", "data are written to GPASET"),
        (" MOV AL,*XAR4\n MOVL XAR6,#0x0D4C\n MOV *XAR6,AL\n", "data are written to memory outside of RAM"),
        (f" MOV AL,*XAR4\n{SENDS} MOV @0x7059,AL\n", None),
        (f" MOV AL,*XAR4\n{SENDS} MOV @0x7054,AL\n", "data are written to SCICTL2"),
        (f"{SENDS} MOV AL,@0x7057\n SB next,NEQ\nnext: NOP\n", "data decide a branch"),
        (f"{SENDS} MOV @0x7059,#5\n MOV AL,@0x7059\n SB next,NEQ\nnext: NOP\n", "data decide a branch"),
        (" MOVW DP,#0x6FC0 >> 6\n TBIT @0x6FC0,#3\n SB next,TC\nnext: NOP\n", "data decide a branch"),
        (" MOVW DP,#0x7900 >> 6\n MOV @0x7909,#0x0420\n", "I2CMDR makes the module a master"),
        (" MOVW DP,#0x7900 >> 6\n MOV @0x7909,#0x0020\n OR @0x7909,#0x40\n", "I2CMDR makes the module a master"),
        (" MOVW DP,#0x7900 >> 6\n MOV @0x7909,#0x0220\n MOV AL,*XAR4\n MOV @0x7908,AL\n", None),
        (" MOVW DP,#0x7900 >> 6\n MOV AL,@0x7906\n SB next,NEQ\nnext: NOP\n", None),
        (
            " MOV ACC,*XAR4\n ANDB AL,#0\n OR AL,#0x7700\n MOVL XAR6,#next\n MOV *XAR6,AL\nnext: NOP\n",
            "data are executed as an instruction",
        ),
        (f"{SENDS} MOV AL,@0x7055\n SB next,NEQ\nnext: NOP\n", None),
        # PUSH writes I2CMDR, and then I2CISRC
        (
            " MOV AL,#0x7909\n MOV @SP,AL\n MOVL XAR0,#0x0420\n MOVL XAR1,#0\n PUSH AR1:AR0\n",
            "I2CMDR makes the module a master",
        ),
        # of two uses, the first one is named
        (" MOVZ AR0,*XAR4\n TBIT *XAR4,#0\n SB next,TC\nnext: MOV AL,*+XAR5[AR0]\n", "data decide a branch"),
    ],
)
def test_uses_of_data_that_decide(source: str, how: str | None) -> None:
    marks, rig = marked(BEGIN + source, "SCI-A", "GPIO", "I2C-A")
    if how is None:
        assert marks.found is None
    else:
        assert marks.found is not None and how in marks.found.how
        assert rig.program.place_at(marks.found.address).startswith("_c_int00")


@pytest.mark.parametrize(
    ("address", "name"),
    [
        *zip(range(0x7050, 0x7054), ("SCICCR", "SCICTL1", "SCIHBAUD", "SCILBAUD"), strict=True),
        (0x705C, "SCIFFCT"),
        (0x7070, "XINT1CR"),
        (0x6F86, "GPAMUX1"),
        (0x6FE0, "GPIOXINT1SEL"),
        (0x701C, "PCLKCR0"),
        (0x701E, "LPMCR0"),
        (0x7054, ""),  # SCICTL2
        (0x705B, ""),  # SCIFFRX
        (0x6FC2, ""),  # GPASET
    ],
)
def test_a_write_to_a_register_that_controls_reception_while_frames_come(address: int, name: str) -> None:
    source = f" EALLOW\n MOVL XAR6,#{address}\n MOV AL,*XAR6\n MOV *XAR6,AL\n"
    before, after = (marked(source, "SCI-A", "GPIO", "XINT", frames=frames)[0].found for frames in (False, True))
    assert before is None
    if name:
        assert after is not None
        assert after.how == f"{name} is written while frames come, and data can decide what is received"
    else:
        assert after is None


def test_a_late_result_of_the_fpu_is_marked_although_the_delay_slot_writes_the_same_register() -> None:
    source = " MOV32 R1H,*XAR4\n NOP\n I32TOF32 R0H,R1H\n ZERO R0H\n NOP\n MOV32 *XAR5,R0H\n"
    source += " ZERO R0H\n MOV32 *+XAR5[2],R0H\n"
    marks, rig = marked(BEGIN + source, fpu_delay_slot="old_value")
    assert rig.word(0x8220) | rig.word(0x8221) << 16 != 0
    assert words(marks) == {0x8220, 0x8221}


def test_the_delay_slot_of_the_fpu_reads_a_marked_old_value() -> None:
    source = " ZERO R1H\n MOV32 R0H,*XAR4\n I32TOF32 R0H,R1H\n MOV32 *XAR5,R0H\n NOP\n MOV32 *+XAR5[2],R0H\n"
    marks, rig = marked(BEGIN + source, fpu_delay_slot="old_value")
    assert (rig.word(0x8220), rig.word(0x8222)) == (0x1234, 0)
    assert words(marks) == {0x8220, 0x8221}


@pytest.mark.parametrize("period", range(999, 1009))
def test_a_replayed_read_of_a_line_is_marked(period: int) -> None:
    """The timer ends the wait at any instruction of a pass, and the reads before it are replayed."""
    source = f" MOVW DP,#0x0C00 >> 6\n MOVL XAR6,#{period}\n MOVL @0x0C02,XAR6\n MOV @0x0C04,#0x4020\n"
    source += " MOVL XAR6,#0x6FC0\nagain: MOV AL,*XAR6\n TBIT @0x0C04,#15\n SB again,NTC\n MOV *XAR5,AL\n"
    marks, rig = marked(BEGIN + source, "TIMER0", "GPIO")
    assert rig.program.polls_skipped > 0
    assert words(marks) == {0x8220}


@pytest.mark.parametrize("address", [0x7056, 0x7057, 0x7059, *range(0x7046, 0x704A), 0x7908, 0x6FC0, 0x6FC8, 0x6FD0])
def test_a_read_of_a_register_with_data_or_of_lines_is_marked(address: int) -> None:
    source = f" MOVL XAR6,#{address}\n MOV AL,*XAR6\n MOV *XAR5,AL\n"
    assert words(marked(BEGIN + source, "SCI-A", "SPI-A", "GPIO", "I2C-A")[0]) == {0x8220}


def test_a_change_of_marks_changes_the_state_of_the_cpu() -> None:
    cpu = Rig(HEAD).cpu
    cpu.marks = DataMarks(DATA)
    seen = [cpu.is_as_before(), cpu.is_as_before()]
    cpu.marks.registers = 1
    seen += [cpu.is_as_before(), cpu.is_as_before()]
    cpu.marks.forget(0x8200)
    assert [*seen, cpu.is_as_before(), cpu.is_as_before()] == [False, True, False, True, False, True]


@pytest.mark.parametrize("in_memory", [False, True])
def test_a_pass_that_changes_marks_does_more_than_count(in_memory: bool) -> None:
    rig = Rig(HEAD)
    rig.cpu.marks = DataMarks(DATA)
    loop = CountingLoop(rig.cpu, rig.dsp.processor.time, rig.dsp.processor.bus.ram, lambda _: None)
    if in_memory:
        rig.cpu.marks.forget(DATA.start)
    else:
        rig.cpu.marks.registers = 1
    assert loop.passes({}) == 0
    assert loop.does_more


def test_states_with_other_marks_of_words_differ() -> None:
    n_and_z = [DataMarks(), DataMarks()]
    for marks, flag in zip(n_and_z, "NZ", strict=True):
        marks.registers = BITS[flag]
        marks.entered(0x400)
    states = [one.normal_state(0, 0)["memory"] for one in (*n_and_z, *map(DataMarks, ((), DATA, DATA[1:], OTHER)))]
    assert all(states.count(state) == 1 for state in states)


def test_an_instruction_marks_only_the_words_that_it_writes() -> None:
    """The first instruction only reads data."""
    rig, _ = ran([0x06C4, 0x7625], [0] * len(DATA), 0)  # MOVL ACC,*XAR4; ESTOP0
    assert rig.cpu.marks is not None
    assert words(rig.cpu.marks) == set()


def test_cleared_words_have_no_mark() -> None:
    rig = Rig(HEAD)
    rig.cpu.marks = DataMarks(DATA)
    rig.cpu.forget(range(0x8204, 0x8210))
    assert [address for address, mark in enumerate(rig.cpu.marks.memory) if mark] == [*range(0x8200, 0x8204)]


def test_a_loop_whose_marks_still_change_is_not_taken_for_a_wait() -> None:
    """Each pass moves the mark by one word; the words are equal, so the CPU state and the memory repeat."""
    moves = "".join(f" MOV AL,*+XAR5[{at}]\n MOV *+XAR5[{at + 1}],AL\n" for at in range(6, -1, -1))
    source = f"{BEGIN} MOVL XAR5,#0x8210\n MOV AL,*XAR4\n MOV *XAR5,AL\n"
    source += f" MOVB XAR6,#5\nagain: MOVW DP,#0x0C00 >> 6\n{moves} TBIT @0x0C04,#14\n SB again,NTC\n"
    rig = Rig(HEAD + source.replace("MOVB XAR6,#5", "MOV AH,#0") + " ESTOP0")
    for address in (*DATA, *OTHER):
        rig.cpu.fill(address, 0x1234)
    rig.cpu.marks = DataMarks(DATA)
    rig.run()
    assert rig.program.asleep_since is not None
    assert words(rig.cpu.marks) == {*range(0x8210, 0x8218)}


# Random programs ----------------------------------------------------------------------------------------------


def program(draw: random.Random) -> list[int]:
    """Return random instructions after two that read data."""
    code = [0x06C4, 0xE2AF, 0x00C4]  # MOVL ACC,*XAR4; MOV32 R0H,*XAR4
    for _ in range(LENGTH):
        row = draw.choice(PLAIN if draw.random() < 0.9 else FORMS)
        pair = pair_of(row, draw)
        if "l" in row.fields and draw.random() < 0.8:
            place, field = row.fields["l"], draw.choice(OPERANDS)
            pair = pair & ~(place.mask << place.shift) | field << place.shift
        code += [pair >> 16, pair & 0xFFFF][: row.words]
    return [*code, 0x7625]  # ESTOP0


def test_random_programs_that_do_not_use_data_run_equally_with_other_data() -> None:
    draw, undecided, used = random.Random(3), 0, 0
    for number in range(PROGRAMS):
        code = program(draw)
        one, other = (ran(code, [draw.getrandbits(16) for _ in DATA], number) for _ in range(2))
        marks = one[0].cpu.marks
        assert marks is not None
        if marks.found is None and one[1].startswith("at "):
            undecided += 1
            used += marks.registers != 0
            assert one[1] == other[1], [hex(word) for word in code]
            assert known(one[0]) == known(other[0]), [hex(word) for word in code]
    assert undecided > PROGRAMS / 4 and used > PROGRAMS / 8
