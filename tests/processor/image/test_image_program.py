"""Images on a unit: how code acts on registers, interrupts and time, shown by programs in assembly."""

from __future__ import annotations

from itertools import pairwise

import pytest

from periph_sim.core.records import Kind
from periph_sim.f28335.pie.register_map import PIECTRL
from periph_sim.processor.user_code import FirmwareError
from tests.processor.image.rig import ENPIE, HEAD, Rig, timer

CYCLE = 400  # ticks of 1/3 ns; after the reset the CPU runs at 30 MHz / 4
COUNT = 0x9100

# Timer 0 interrupts every 500 cycles; its routine counts the interrupts and does not save DP.
TIMER = (
    HEAD
    + timer(500)
    + """\
 SETC SXM,OVM
 MOVL XAR0,#0x12345
 CLRC INTM
loop: ADDB ACC,#1
 SB loop,UNC
 .global _routine
_routine: PUSH ACC
 MOVB ACC,#0
 MOVW DP,#COUNT >> 6
 INC @COUNT
 MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE1,#1
 POP ACC
 IRET
"""
)


def test_a_program_ends_at_estop0_after_the_cycles_of_the_table():
    """EALLOW 4, MOVW 1, MOV 1, EDIS 4, then ten passes of 1 + 4, the last of 1 + 4; RPT 1 and its 20."""
    rig = Rig(HEAD + " MOVB ACC,#9\nloop: SUBB ACC,#1\n BF loop,GEQ\n RPT #19 || NOP\n ESTOP0").run()
    assert rig.program.finished
    assert rig.program.returned_at == 4 + 1 + 1 + 4 + 1 + 10 * 5 + 1 + 20
    assert rig.cpu.acc == 0xFFFF_FFFF
    assert rig.program.ending("2 us").startswith("ESTOP0 ended the program at 2 us, in _c_int00+0x")


def test_an_access_has_the_wait_states_of_its_frame_and_a_read_waits_for_the_previous_write():
    """A write to frame 2 is posted; the read after it waits until the write has landed, and has two wait states."""
    alone = Rig(HEAD + " RPT #9 || NOP\n MOV AL,@0x701C\n ESTOP0").run().program.returned_at
    after_write = Rig(HEAD + " RPT #9 || NOP\n MOV @0x701B,#2\n MOV AL,@0x701C\n ESTOP0").run().program.returned_at
    assert alone == 10 + 11 + 3
    assert after_write == alone + 1 + 3


def test_interrupts_save_registers_in_memory_and_restore_them():
    rig = Rig(TIMER, "TIMER0").run(3_000_000)
    count = rig.word(COUNT)
    assert count == 14  # 1 ms has 7500 cycles, a few of which pass before the timer runs
    began = [record for record in rig.records if record.kind is Kind.IRQ and record.value]
    assert {record.what for record in began} == {"TINT0"}
    assert len(began) in (count, count + 1)
    ticks = [record.tick for record in began]
    # every 500 cycles, except for the instruction in progress at the request, at most 7 cycles
    assert {abs(after - before - 500 * CYCLE) <= 7 * CYCLE for before, after in pairwise(ticks[2:])} == {True}
    assert rig.cpu.xar[0] == 0x12345
    assert (rig.cpu.sxm, rig.cpu.ovm) == (1, 1)
    routine = rig.program.functions.named("_routine").address
    assert {record.text for record in began} == {f"_routine+0x0 ({routine:#08x})"}
    assert (
        0.3 * rig.program.instructions < 2 * rig.cpu.acc < rig.program.instructions
    )  # the loop continues where it was interrupted


def test_idle_sleeps_until_the_timer_interrupt():
    source = TIMER.replace("loop: ADDB ACC,#1\n SB loop,UNC", "loop: IDLE\n ADDB ACC,#1\n SB loop,UNC")
    rig = Rig(source, "TIMER0").run(3_000_000)
    count = rig.word(COUNT)
    assert count == 14 and rig.cpu.acc in (count, count - 1)
    assert rig.program.instructions < 60 + 14 * count


def test_trap_enters_the_routine_of_its_vector_and_returns():
    source = (
        HEAD
        + ENPIE
        + """
 EALLOW
 MOVL XAR4,#_routine
 MOVL XAR5,#0x0D80
 MOVL *XAR5,XAR4
 EDIS
 MOVB ACC,#7
 TRAP #5
 ESTOP0
 .global _routine
_routine: MOVB ACC,#9
 MOV *SP++,AL
 MOV AL,*--SP
 MOVW DP,#COUNT >> 6
 MOV @COUNT,AL
 IRET
"""
    )
    rig = Rig(source).run()
    assert rig.program.finished
    assert (rig.word(COUNT), rig.cpu.acc, rig.cpu.sp) == (9, 7, 0x400)
    assert [text for text in rig.notes() if "TRAP" in text] == [
        "TRAP or INTR took vector 5 with the PIE enabled; it is not meant for vectors 1 to 12"
    ]


def test_writes_without_eallow_are_ignored_and_a_frame_without_model_is_noted_once():
    rig = Rig(
        HEAD + " MOV @0x701C,#0xFFFF\n MOVW DP,#0x7100 >> 6\n MOV @0x7100,#5\n MOV AL,@0x7100\n MOV AH,@0x7101\n"
        " MOVW DP,#0xC08 >> 6\n MOV @0xC0C,#0\n ESTOP0"
    ).run()
    assert rig.program.finished and rig.cpu.acc == 5
    notes = rig.notes()
    assert [text for text in notes if "without EALLOW" in text] == [
        "PCLKCR0 of SYS was written without EALLOW; the write is ignored"
    ]
    assert [text for text in notes if "it keeps what is written" in text] == [
        "ADC at 0x7100 is not modelled; it keeps what is written",
        "TIMER1 at 0x0c0c is not in this unit (name it in modules); it keeps what is written",
    ]


def test_unprogrammed_flash_reads_as_erased_and_the_part_id_can_be_read():
    rig = Rig(
        HEAD + " MOVL XAR4,#0x330000\n MOV AL,*XAR4\n MOVL XAR4,#0x380090\n MOV AH,*XAR4\n LCR #0x380080\n ESTOP0"
    )
    assert (rig.run().cpu.acc, rig.program.finished) == (0x00EF_FFFF, True)


def test_the_boot_rom_reads_0_and_is_noted():
    rig = Rig(HEAD + " MOVL XAR4,#0x3FFFBA\n MOV AL,*XAR4++\n MOV AH,*XAR4\n ESTOP0").run()
    assert rig.program.finished and rig.cpu.acc == 0
    assert rig.notes() == ["boot ROM: 0x3fffba is read as 0; its contents are not modelled"]


def test_code_in_flash_and_data_at_both_ends():
    code = '.sect ".text", 0x330000\n_c_int00: MOVW DP,#datum >> 6\n MOV AL,@datum\n ESTOP0\n'
    source = code + '.sect ".econst", 0x9200\ndatum: .word 0x1234'
    rig = Rig(source).run()
    assert (rig.cpu.acc, rig.program.finished) == (0x1234, True)


def test_iret_returns_through_a_stack_frame_that_the_program_wrote():
    """An RTOS starts a task in this way: 14 words from 0x420, SP after them, IRET."""
    frame = (0, 0x1234, 0x5678, 0x9ABC, 0, 0, 7, 0, 0x0A0B, 0x3FF, 0, 0, "_task & 0xFFFF", "_task >> 16")
    stores = "".join(f" MOV *XAR4++,#{word}\n" for word in frame)
    source = HEAD + f" MOVL XAR4,#0x420\n{stores} MOV @SP,#0x42F\n IRET\n .space 4\n .global _task\n_task: ESTOP0"
    rig = Rig(source).run()
    assert rig.program.finished
    assert (rig.cpu.acc, rig.cpu.sp, rig.cpu.dp, rig.cpu.xar[0] & 0xFFFF) == (0x9ABC_5678, 0x420, 0x3FF, 7)


def test_a_vector_of_0_ends_the_run():
    with pytest.raises(FirmwareError, match=r"interrupt TINT0 was taken, but its vector is 0; at _c_int00\+0x"):
        Rig(TIMER.replace(" MOVL *XAR5,XAR4\n", ""), "TIMER0").run()


def test_a_watchdog_reset_restarts_the_program_and_keeps_memory():
    rig = Rig(HEAD.replace("#0x68", "#0x28") + " MOVW DP,#COUNT >> 6\n INC @COUNT\nloop: SB loop,UNC")
    rig.run(60_000_000)
    assert rig.dsp.resets >= 1
    assert rig.word(COUNT) == rig.dsp.resets + 1


def test_a_write_directly_before_estop0_lands():
    rig = Rig(HEAD + " MOVW DP,#TCR >> 6\n MOVL XAR4,#5000\n MOVL @TCR-2,XAR4\n ESTOP0", "TIMER0").run()
    assert rig.program.finished
    assert rig.dsp.sockets["TIMER0"].chip.peek(rig.dsp.processor.time.cycle, 2) == 5000


def test_places_name_the_function_and_the_instruction():
    rig = Rig(HEAD + " LCR #_f\n .global _f\n_f: MOV AL,@0x701C\nloop: SB loop,UNC").run(20_000)
    reads = [record for record in rig.records if record.kind is Kind.ACCESS and record.what == "R SYS.PCLKCR0"]
    assert [record.text for record in reads] == [f"_f+0x0 ({rig.program.functions.named('_f').address:#08x})"]


@pytest.mark.parametrize(
    ("read", "what", "field"),
    [
        ("TBIT @0x7011,#0", "R SYS.PLLSTS", "PLLLOCKS"),
        ("AND AL,@0x7011,#0x0180", "R SYS.PLLSTS", "DIVSEL"),
        ("AND AL,@0x7011,#0x0101", "R SYS.PLLSTS", ""),  # bits of two fields
        ("AND AL,@0x7011,#0xFFFF", "R SYS.PLLSTS", ""),
        ("MOV AL,@0x7011", "R SYS.PLLSTS", ""),
        ("TBIT @0x6FC1,#2", "R GPIO.GPADAT", "GPIO18"),  # the upper half
        ("TBIT @0x6FC0,#2", "R GPIO.GPADAT", "GPIO2"),
    ],
)
def test_an_instruction_that_names_bits_names_their_field(read: str, what: str, field: str):
    """A plain read of the same word, after an instruction that names bits, names no field."""
    address = read.partition("@")[2].partition(",")[0]
    rig = Rig(HEAD + f" MOVW DP,#{address} >> 6\n {read}\n MOV AH,@{address}\n ESTOP0", "GPIO").run(20_000)
    reads = [record for record in rig.records if record.kind is Kind.ACCESS and record.what == what]
    assert [record.field for record in reads] == [field, ""]
    assert reads[0].value == reads[1].value


def test_external_memory_is_noted_once_per_zone():
    zone = (
        " MOVL XAR4,#0x100000\n MOV *XAR4,#5\n MOV AL,*XAR4\n MOVL XAR5,#0x4000\n MOV AH,*XAR5\n MOV AH,*XAR5\n ESTOP0"
    )
    rig = Rig(HEAD + zone).run()
    assert rig.cpu.acc == 5
    assert rig.notes() == [
        f"{name}: {address} is treated as memory with 1 wait state, the minimum of XINTF; XTIMING is not modelled"
        for name, address in (("XINTF zone 6", "0x100000"), ("XINTF zone 0", "0x004000"))
    ]


START = ' .sect ".text", 0x9000\n .global _c_int00\n_c_int00: '


@pytest.mark.rule("SYS-133", "SYS-134")
@pytest.mark.parametrize(("sp", "first"), [(0x400, 0x400), (0x401, 0x402)], ids=["even", "odd"])
def test_an_entry_stores_seven_pairs_at_even_addresses(sp: int, first: int):
    set_ar = "MOVL XAR0, #0x8888\n MOVL XAR1, #0x9999\n "
    rig = Rig(START + set_ar + "TRAP #20\n ESTOP0\n .global _routine\n_routine: ESTOP0")
    rig.dsp.pie.write(0, PIECTRL.offset, 1)
    rig.dsp.processor.bus.ram.put_word32(0x0D00 + 2 * 20, 0x9006)
    cpu = rig.cpu
    cpu.sp, cpu.xt, cpu.acc, cpu.p, cpu.dp, cpu.dbgstat = sp, 0x1111_0000, 0x2222_3333, 0x4444_5555, 0x66, 0x77
    cpu.put_ier(0xAAAA)
    st0, st1 = cpu.st0(), cpu.whole_st1()
    rig.run()
    stored = [st0, 0x1111, 0x3333, 0x2222, 0x5555, 0x4444, 0x8888, 0x9999, st1, 0x66, 0xAAAA, 0x77, 0x9005, 0]
    assert [rig.word(first + n) for n in range(14)] == stored
    assert cpu.sp == sp + 15


@pytest.mark.rule("SYS-149")
@pytest.mark.parametrize(("clears", "left"), [(True, 0x20), (False, 0x30)])
@pytest.mark.parametrize("enabled", [0x20, 0x30])
def test_open_intr_clears_ifr(clears: bool, left: int, enabled: int):
    rig = Rig(START + "INTR INT5\n ESTOP0\n .global _routine\n_routine: ESTOP0", intr_clears_ifr=clears)
    rig.dsp.pie.write(0, PIECTRL.offset, 1)
    rig.dsp.processor.bus.ram.put_word32(0x0D80, 0x9002)
    rig.cpu.put_ier(enabled)
    rig.cpu.put_ifr(0x30)
    rig.run()
    assert (rig.cpu.whole_ifr(), rig.cpu.whole_ier(), rig.word(0x400 + 10)) == (left, 0x20, enabled)
    assert rig.dsp.core.touched == {"intr_clears_ifr", "vector_fetch_waits"}
