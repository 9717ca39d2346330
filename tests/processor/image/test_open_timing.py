"""Each setting for an undocumented instruction timing of an image has its effect, exact to the cycle."""

from __future__ import annotations

import struct

import pytest

from periph_sim.core.options import Value
from periph_sim.core.records import Kind
from tests.processor.image.rig import ENPIE, HEAD, VECTOR, Rig, ended, timer

# Interrupts ---------------------------------------------------------------------------------------------------------

CYCLE = 400  # ticks; the CPU runs at 30 MHz / 4


def asleep(intm: str, **options: Value) -> tuple[int, int]:
    """Run a program that sleeps in IDLE until timer 0; return the cycle of ESTOP0 and the tick of the entry."""
    source = f"{HEAD}{timer(200)} {intm} INTM\n IDLE\n ESTOP0\n .global _routine\n_routine: IRET\n"
    rig = Rig(source, "TIMER0", **options).run()
    assert rig.program.returned_at is not None
    entered = [record.tick for record in rig.records if record.kind is Kind.IRQ and record.value]
    return rig.program.returned_at, entered[0] if entered else 0


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize("wake", [0, 1, 16])
def test_open_idle_wake(wake: int):
    """IDLE ends later by this, whether the service routine is entered or, with INTM = 1, is not."""
    through, entered = asleep("CLRC")
    past, _ = asleep("SETC")
    assert past + 10 + 8 == through  # the entry after the IFR bit is set, and IRET
    assert asleep("SETC", idle_wake=wake) == (past + wake, 0)
    assert asleep("CLRC", idle_wake=wake) == (through + wake, entered + wake * CYCLE)


@pytest.mark.rule("SYS-138", "SYS-139")
@pytest.mark.parametrize("waits", [0, 1, 2])
def test_open_vector_fetch_waits(waits: int):
    """This delays the entry by an interrupt and by TRAP."""
    through, entered = asleep("CLRC")
    assert asleep("CLRC", vector_fetch_waits=waits) == (through + waits, entered + waits * CYCLE)
    trap = f"{HEAD}{ENPIE}{VECTOR} TRAP #5\n ESTOP0\n .global _routine\n_routine: IRET\n".replace("0x0D4C", "0x0D80")
    assert ended(trap, vector_fetch_waits=waits) == ended(trap, vector_fetch_waits=0) + waits


# The FPU ------------------------------------------------------------------------------------------------------------

FLOATS = {"0x4000": 2.0, "0x4040": 3.0, "0x3F80": 1.0}


def floats(code: str, **options: Value) -> tuple[list[float], list[str], int | None]:
    """Run code after R0H = 2.0, R1H = 3.0 and R2H = 1.0; return R0H to R7H, the notes and the cycle of the end."""
    loads = "".join(f" MOVIZ R{n}H,#{number}\n" for n, number in enumerate(FLOATS))
    body = "\n".join(f" {line.strip()}" for line in code.split(";"))
    rig = Rig(f"{HEAD}{loads}{body}\n ESTOP0\n", **options).run()
    return [struct.unpack("f", struct.pack("I", bits))[0] for bits in rig.cpu.r], rig.notes(), rig.program.returned_at


@pytest.mark.parametrize(
    ("code", "register", "result", "before"),
    [
        # the result arrives one instruction later, whichever that is
        ("MPYF32 R2H,R0H,R1H ; MOV32 R3H,R2H", 3, 6.0, 1.0),
        ("MPYF32 R2H,R0H,R1H ; NOP ; MOV32 R3H,R2H", 3, 6.0, 6.0),
        ("MPYF32 R2H,R0H,R1H ; ADDF32 R3H,R2H,R2H ; NOP ; NOP", 3, 12.0, 2.0),
        ("ADDF32 R2H,R0H,R1H ; SUBF32 R2H,R2H,R0H ; NOP", 2, 3.0, -1.0),
        ("ADDF32 R2H,R0H,R1H ; MOV32 R3H,R2H ; MOV32 R4H,R2H", 4, 5.0, 5.0),
        # conversions
        ("F32TOI16 R3H,R1H ; I16TOF32 R4H,R3H ; NOP", 4, 3.0, 0.0),
        # one cycle, so there is no delay slot
        ("NEGF32 R2H,R1H ; MOV32 R3H,R2H", 3, -3.0, -3.0),
        # pairs: the sum is late, the load is not
        ("MPYF32 R2H,R0H,R1H ; NOP ; MPYF32 R3H,R2H,R0H || ADDF32 R4H,R2H,R2H ; MOV32 R5H,R4H", 5, 12.0, 0.0),
        ("MOV32 *SP++,R1H ; MPYF32 R2H,R0H,R1H || MOV32 R3H,*--SP ; MOV32 R4H,R3H", 4, 3.0, 3.0),
        # the delay slot writes the same register and is overwritten
        ("MPYF32 R2H,R0H,R1H ; MOV32 R2H,R0H ; MOV32 R3H,R2H", 3, 2.0, 6.0),
        # from the last instruction of a block to its first one
        ("ZERO R3H ; RPTB end,#1 ; ADDF32 R4H,R3H,R1H ; NOP ; NOP ; NOP ; NOP ; NOP ; NOP ; NOP\nend_:"
         " ADDF32 R3H,R3H,R0H\nend: NOP", 4, 5.0, 3.0),
    ],
)  # fmt: skip
def test_open_fpu_delay_slot(code: str, register: int, result: float, before: float):
    """The setting only affects the values that are read in a delay slot, and no cycles."""
    at_once, notes, ended = floats(code)
    late, notes_late, ended_late = floats(code, fpu_delay_slot="old_value")
    assert (at_once[register], late[register]) == (result, before)
    assert (ended, notes) == (ended_late, notes_late)


def test_open_fpu_delay_slot_is_noted_once_a_place():
    loop = "MOVB XAR0,#9 ; again: ; MPYF32 R2H,R0H,R1H ; MOV32 R3H,R2H ; BANZ again,AR0--"
    rig = Rig(HEAD + loop.replace(";", "\n").replace(" again:", "again:") + "\n ESTOP0\n").run()
    assert rig.notes() == [
        "MOV32 at 0x009009 reads R2H in the delay slot of MPYF32 at 0x009007: the setting "
        "fpu_delay_slot selects whether it gets the new result"
    ]
    assert list(rig.dsp.processor.notes.counts.values()) == [1]
    assert "fpu_delay_slot" in rig.dsp.processor.core.touched


def test_the_flags_of_an_overflow_are_as_late_as_the_result():
    """MOVST0 does not see LVF in the delay slot; one instruction later it does."""
    for between, seen in (("", 0), ("NOP ; ", 1)):
        code = f"MOVIZ R0H,#0x7F00 ; MPYF32 R1H,R0H,R0H ; {between}MOVST0 LVF ; NOP ; NOP"
        rig = Rig(HEAD + "\n".join(f" {line.strip()}" for line in code.split(";")) + "\n ESTOP0\n",
                  fpu_delay_slot="old_value").run()  # fmt: skip
        assert rig.cpu.v == seen


@pytest.mark.parametrize("answer", ["at_once", "old_value"])
def test_a_late_result_arrives_before_the_service_routine_of_an_interrupt(answer: str):
    """Four instructions are repeated, and timer 0 interrupts after each one of them in turn."""
    seen = []
    for shift in range(4):
        body = " MPYF32 R2H,R0H,R1H\n NOP\n MOV32 R2H,R3H\n NOP\n" * 60
        routine = " .global _routine\n_routine: MOV32 R7H,R2H\n ESTOP0\n"
        loads = " MOVIZ R0H,#0x4000\n MOVIZ R1H,#0x4040\n MOVIZ R3H,#0x3F80\n MOV32 R2H,R3H\n"
        source = f"{HEAD}{loads}{timer(200)} CLRC INTM\n" + " NOP\n" * shift + body + " ESTOP0\n" + routine
        rig = Rig(source, "TIMER0", fpu_delay_slot=answer).run()
        seen.append(struct.unpack("f", struct.pack("I", rig.cpu.r[7]))[0])
    assert sorted(seen) == [1.0, 1.0, 6.0, 6.0]


# Flash --------------------------------------------------------------------------------------------------------------

PAGE, RAND = 5, 5  # wait states, those of 150 MHz
ROW, OTP = 0x30_0000, 0x38_0400
CONSTANT = 0x30_0800


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize(
    ("base", "instructions", "more"),
    [(ROW, 1, 15), (ROW, 3, 15 + 16 - 2), (OTP, 1, 31), (OTP, 3, 31 + 32 - 2), (0x9800, 3, 0)],
)
def test_flash_and_otp_after_reset(base: int, instructions: int, more: int):
    """32 bits at a time, the first after 15 or 31 cycles; meanwhile two instructions of them were executed."""
    body = " NOP\n" * instructions
    there = f'{HEAD} LB #there\n .sect "code", {base:#x}\nthere:{body} ESTOP0\n .space 8\n'
    assert ended(there) - ended(f"{HEAD} LB #there\nthere:{body} ESTOP0\n") == more


def from_flash(code: str, *, enpipe: int = 1, **options: Value) -> int:
    """Return the cycles from the jump to ESTOP0 that code takes in flash, beyond those that it takes in L1."""

    def at(base: int, constant: int) -> int:
        body = "\n".join(f" {line.strip()}" for line in code.split(";"))
        source = (
            f"{HEAD} EALLOW\n MOVW DP,#0x0A80 >> 6\n MOV @0x0A86,#{PAGE << 8 | RAND}\n MOV @0x0A80,#{enpipe}\n EDIS\n"
            f" MOVL XAR4,#{constant:#x}\n MOVL XAR7,@XAR4\n LB #there\n"
            f' .sect "code", {base:#x}\nthere:\n{body}\n ESTOP0\n .space 8\n'
            f' .sect "constant", {constant:#x}\n .word 7, 8\n'
        )
        return ended(source, **options)

    return at(ROW, CONSTANT) - at(0x9800, 0x9F00)


def nops(count: int) -> str:
    return " ; ".join(["NOP"] * count)


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize("model", ["beside_reads", "shared_with_reads", "two_words_ahead"])
@pytest.mark.parametrize(
    ("code", "more"),
    [
        (nops(3), 5),  # the first word has four instructions, and arrives in cycle 5
        (nops(4), 11 - 4),  # the second arrives in cycle 11
        (nops(8), 17 - 8),
        (nops(24), 41 - 24),
        ("RPT #40 || NOP ; " + nops(2 + 3), 5),  # words fetched meanwhile
        ("LB #there + 4 ; NOP ; NOP ; " + nops(3), 5 + 5),  # a jump, here to the next word, waits for a new fetch
    ],
)
def test_flash_with_prefetch_delivers_64_bits_at_a_time(model: str, code: str, more: int):
    assert from_flash(code, flash_model=model) == more


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize("model", ["beside_reads", "shared_with_reads", "two_words_ahead"])
@pytest.mark.parametrize(("code", "more"), [(nops(1), 5), (nops(2), 11 - 2), (nops(8), 29 - 8)])
def test_flash_without_prefetch_delivers_32_bits_at_a_time(model: str, code: str, more: int):
    assert from_flash(code, enpipe=0, flash_model=model) == more


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize(("model", "more"), [("beside_reads", 5), ("shared_with_reads", 5), ("two_words_ahead", 5 + 1)])
def test_open_flash_model_how_far_it_runs_ahead(model: str, more: int):
    """A repeated NOP to cycle 46; two more NOPs end the first word in 48, and four end the second in 52.

    beside_reads       the third word was fetched before
    two_words_ahead    its fetch begins in 48, when the place of the first is free, and ends in 54; it is needed in 53
    """
    assert from_flash("RPT #40 || NOP ; " + nops(2 + 4), flash_model=model) == more


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize(
    ("model", "eighth", "ninth"),
    [("beside_reads", 17, 18), ("shared_with_reads", 20, 23), ("two_words_ahead", 17, 18)],
)
def test_open_flash_model_a_read_of_data(model: str, eighth: int, ninth: int):
    """Three NOPs in 5 to 7, then in 8 a load of a constant in flash, whose wait states are 5.

    cycle               5 6 7 8 9 10 11      14  16 17    18        23
    fetches             word 1 ----->| word 2 ------>|
    beside_reads        . . . load waits ----> next in 14 ... the ninth instruction in 18: word 2 is there in 17
    shared_with_reads   . . . waits  | load waits --->| next in 17 to 20; word 2 from 17 on, there in 23
    """
    load = f"{nops(3)} ; MOV AL,*XAR4"
    assert from_flash(f"{load} ; {nops(3)}", flash_model=model) == eighth - 7
    assert from_flash(f"{load} ; {nops(4)}", flash_model=model) == ninth - 8


@pytest.mark.rule("SYS-039")
@pytest.mark.parametrize(("model", "waits"), [("beside_reads", 0), ("shared_with_reads", 4), ("two_words_ahead", 0)])
def test_open_flash_model_a_read_of_program_memory(model: str, waits: int):
    """PREAD in 7 waits for a fetch that ends in 11, if it shares the port; it takes 2 cycles and 5 wait states."""
    assert from_flash(f"{nops(2)} ; PREAD @AL,*XAR7", flash_model=model) == 5 + 5 + waits


@pytest.mark.rule("SYS-039")
def test_the_default_flash_model_is_that_of_the_manual():
    """Data reads wait for a prefetch in progress [SPRUFB0D 2.2]."""
    code = f"{nops(3)} ; MOV AL,*XAR4 ; {nops(4)}"
    shared, beside = (from_flash(code, flash_model=model) for model in ("shared_with_reads", "beside_reads"))
    assert from_flash(code) == shared == beside + 23 - 18


@pytest.mark.rule("SYS-039")
def test_code_outside_flash_reads_data_in_flash_without_waiting_for_cancelled_fetches():
    source = (
        f"{HEAD} EALLOW\n MOVW DP,#0x0A80 >> 6\n MOV @0x0A86,#0x505\n MOV @0x0A80,#1\n EDIS\n"
        f" MOVL XAR4,#{CONSTANT:#x}\n LB #there\nback: MOV AL,*XAR4\n ESTOP0\n"
        f' .sect "code", {ROW:#x}\nthere: LB #back\n .space 8\n'
        f' .sect "constant", {CONSTANT:#x}\n .word 7, 8\n'
    )
    assert ended(source, flash_model="beside_reads") == ended(source, flash_model="shared_with_reads")
