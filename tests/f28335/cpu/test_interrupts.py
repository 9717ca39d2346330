"""CPU interrupt logic, alone and with the PIE. Rules SYS-095, 106 to 112, 124 to 129, 132 to 139, 141 to 153.

Rules about instruction boundaries in running code (SYS-130, 131) are tested with the processor.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.core.options import options_from
from periph_sim.f28335.cpu import code_costs as cpu_costs
from periph_sim.f28335.cpu.interrupts import (
    DBGM,
    DLOGINT,
    EALLOW,
    EMUINT,
    IDLESTAT,
    INTM,
    LOOP,
    M0M1MAP,
    NMI,
    OBJMODE,
    RTOSINT,
    VMAP,
    Context,
    CpuInterrupts,
    frame_of,
    int13_source,
)
from periph_sim.f28335.pie.module import Pie
from periph_sim.f28335.pie.register_map import PIEACK, PIECTRL, PIEIER, PIEIFR, line_vector
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.c28x.encodings import by_id
from tests.waves import DiagramRig

IFR_DELAY = 4


class Core(CpuInterrupts):
    """CPU interrupt logic with a memory for the contexts that interrupt entries save and IRET restores."""

    def __init__(self, options: SystemOptions) -> None:
        super().__init__(options)
        self.memory: dict[int, Context] = {}  # SP before the entry -> saved context

    def save(self, number: int, first_instruction: int) -> Context:
        context = super().save(number, first_instruction)
        self.memory[context.sp] = context
        return context

    def back(self, now: int) -> None:
        """Execute IRET with the context on the stack."""
        context = self.memory[self.returning_sp]
        self.iret(now, context.st1, context.ier)


def cpu(*, ier: int = 0xFFFF, intm: bool = False, raised: int = 0, **options: int | str | bool) -> Core:
    """Return a CPU with these interrupts enabled, ready from cycle 0. raised: a line that is requested in cycle 0."""
    core = Core(options_from(SystemOptions, dict(options)))
    core.ier = ier
    if not intm:
        core.st1 &= ~INTM
    if raised:
        core.raise_line(0, raised)
    return core


def bit(number: int) -> int:
    return 1 << number - 1


def in_isr(number: int = 9, **options: str) -> tuple[Core, int]:
    """Return a CPU that has just begun a service routine, and the present cycle."""
    core = cpu(**options, raised=number)
    core.enter(IFR_DELAY, number)
    return core, core.ready


def returned(**options: str) -> tuple[Core, int]:
    """Return a CPU and the cycle in which its routine began and was requested again; IRET is 20 cycles later."""
    core, now = in_isr(**options)
    core.raise_line(now, 9)
    core.back(now + 20)
    return core, now


class Rig(DiagramRig):
    """A PIE and a CPU connected as in the device. Each cycle of the running code is an instruction boundary.

        REQ requests lines of group 9, and REQ8 lines of group 8. ISR is 1 while a routine runs, from its
    first instruction on. TAKEN is the group of the last entry, and LINE the line of its vector.
    """

    def __init__(self, ier: int = 0xFFFF, **options: int) -> None:
        self.core = cpu(ier=ier, **options)
        self.pie = Pie(SystemOptions())
        self.pie.write(0, PIECTRL.offset, 1)
        self.pie.write(0, PIEACK.offset, 0xFFF)
        for group in (8, 9):
            self.pie.write(0, PIEIER[group - 1].offset, 0xFF)
        self.now = -1
        self.taken = 0
        self.line = 0
        self.fetch_at = NEVER
        self.begun = 0

    def drive(self, now: int, signal: str, level: int) -> None:
        if signal in ("REQ", "REQ8"):
            self.pie.request(now, 9 if signal == "REQ" else 8, level)
        elif signal == "PIEIER9":
            self.pie.write(now, PIEIER[8].offset, level)
        elif signal == "ACK9":
            self.pie.write(now, PIEACK.offset, level << 8)
        elif signal == "IRET":
            self.core.back(now)
        self.pass_on(now)

    def pass_on(self, now: int) -> None:
        for number in range(1, 13):
            if self.pie.pulses & bit(number):
                self.core.raise_line(now, number)
        self.pie.pulses = 0

    def run_until(self, time: int) -> None:
        while self.now < time:
            self.now += 1
            if self.now == self.fetch_at:
                self.line = self.pie.vector(self.now, self.taken)[0]
                self.fetch_at = NEVER
            number = self.core.next_taken(self.now)
            if number:
                self.core.enter(self.now, number)
                self.taken = number
                self.fetch_at = self.now + self.core.vector_delay

    def show(self, signal: str) -> int:
        if signal == "IFR9":
            self.core.wake(self.now)
            return self.core.ifr >> 8 & 1
        if signal == "ISR":
            return int(bool(self.core.nested) and self.now >= self.core.ready)
        return {"TAKEN": self.taken, "LINE": self.line}[signal]


# Request to first instruction -------------------------------------------------------


@pytest.mark.rule("SYS-127", "SYS-132", "SYS-138", "SYS-139")
def test_14_cycles_from_the_request_to_the_first_instruction():
    Rig().check("""
        > REQ    .1.. .... .... .... ..
        < IFR9   0... .... .... .... ..
        < TAKEN  0... .9.. .... .... ..
        < LINE   0... ..1. .... .... ..
        < ISR    0... .... .... ...1 ..
    """)


@pytest.mark.rule("SYS-127")
def test_the_ifr_bit_rises_4_cycles_after_the_request_and_stays():
    Rig(ier=0).check("""
        > REQ    .1.. .... .... ....
        < IFR9   0... .1.. .... ....
        < TAKEN  0... .... .... ....
    """)


@pytest.mark.rule("SYS-127")
@pytest.mark.parametrize(
    "instruction",
    [
        lambda core, now: core.clrc_intm(now),
        lambda core, now: core.setc_intm(now),
        lambda core, now: core.set_eallow(now, True),
        lambda core, now: core.and_ifr(now, 0xFFFF),
        lambda core, now: core.or_ier(now, 0),
        lambda core, now: core.and_ier(now, 0xFFFF),
        lambda core, now: core.idle(now),
        lambda core, now: core.idle_ends(now),
        lambda core, now: core.trap(now, 20),
        lambda core, now: core.raise_line(now, EMUINT),
    ],
)
def test_each_access_to_ifr_or_the_masks_finds_the_bit_of_a_request_that_is_due(instruction):
    core = cpu(ier=0, raised=9)
    instruction(core, IFR_DELAY)
    assert (core.ifr, core.next_wake) == (bit(9), NEVER)


@pytest.mark.rule("SYS-138", "SYS-139")
@pytest.mark.parametrize("latency", [14, 13, 15, 16])
def test_open_int_latency(latency):
    """The vector is always fetched 9 cycles before the first instruction; the rest of the latency is before that."""
    core = cpu(int_latency=latency)
    core.raise_line(100, 9)
    assert core.next_taken(103) == 0
    assert core.next_taken(104) == 9
    core.enter(104, 9)
    assert core.ready == 100 + latency
    assert 104 + core.vector_delay == 100 + latency - 9
    assert core.touched == {"int_latency", "vector_fetch_waits"}


@pytest.mark.rule("SYS-138", "SYS-139")
@pytest.mark.parametrize(
    ("waits", "isr"), [(0, "0... .... .... ...1 ..."), (1, "0... .... .... .... 1.."), (2, "0... .... .... .... .1.")]
)
def test_open_vector_fetch_waits(waits, isr):
    """The vector is chosen when its fetch begins; wait states of the fetch delay only the first instruction."""
    Rig(vector_fetch_waits=waits).check(f"""
        > REQ    .1.. .... .... .... ...
        < TAKEN  0... .9.. .... .... ...
        < LINE   0... ..1. .... .... ...
        < ISR    {isr}
    """)


@pytest.mark.rule("SYS-138")
@pytest.mark.parametrize("waits", [0, 1, 2])
def test_open_vector_fetch_waits_of_trap(waits):
    core = cpu(vector_fetch_waits=waits)
    core.trap(100, 20)
    assert (core.ready, core.touched) == (108 + waits, {"vector_fetch_waits"})


@pytest.mark.rule("SYS-139")
@given(rest=st.integers(0, 7))
def test_the_rest_of_the_current_instruction_is_added_to_the_latency(rest):
    core = cpu(raised=9)
    core.enter(IFR_DELAY + rest, 9)
    assert core.ready == 14 + rest


@pytest.mark.rule("SYS-127")
@given(at=st.lists(st.integers(0, 40), min_size=1, max_size=5))
def test_requests_in_any_cycles_set_their_ifr_bits(at):
    core = cpu(ier=0)
    numbers = dict(enumerate(sorted(at), start=1))
    for number, now in numbers.items():
        core.raise_line(now, number)
    for now in range(sorted(at)[-1], 50):
        core.wake(now)
        assert core.ifr == sum(bit(n) for n, t in numbers.items() if t + IFR_DELAY <= now)


@pytest.mark.rule("SYS-106", "SYS-107")
def test_the_vector_is_chosen_one_cycle_after_the_entry_began():
    """Line 2 is served before line 4 if it is requested up to this cycle; one cycle later it has to wait."""
    Rig().check("""
        > REQ   4... .2.. ....
        < LINE  0... .2.. ....
    """)
    Rig().check("""
        > REQ   4... ..2. ....
        < LINE  0... .4.. ....
    """)


@pytest.mark.rule("SYS-112")
def test_of_two_groups_the_lower_is_served_first():
    # The second entry begins when IRET of the first routine has been executed.
    Rig().check("""
        > REQ    1... .... .... .... .... .... .... .... ....
        > REQ8   2... .... .... .... .... .... .... .... ....
        > IRET   .... .... .... .... 1... .... .... .... ....
        < TAKEN  0... 8... .... .... .... .... 9... .... ....
        < LINE   0... .2.. .... .... .... .... .1.. .... ....
        < ISR    0... .... .... ..1. 0... .... .... .... ..1.
    """)


@pytest.mark.rule("SYS-108", "SYS-125")
def test_a_request_disabled_in_pieier_before_the_vector_fetch_runs_line_1():
    Rig().check("""
        > REQ      3... .... .... ....
        > PIEIER9  .... 0... .... ....
        < TAKEN    0... 9... .... ....
        < LINE     0... .1.. .... ....
    """)


@pytest.mark.rule("SYS-110", "SYS-137")
def test_no_interrupt_is_taken_between_the_entry_and_the_first_instruction():
    core = cpu(raised=9)
    core.raise_line(1, 1)
    core.enter(IFR_DELAY, 9)
    core.st1 &= ~INTM  # even without the mask that the entry has set
    assert [core.next_taken(now) for now in range(IFR_DELAY, 14)] == [0] * 10
    assert core.next_taken(14) == 1


# Masks and priority -------------------------------------------------------------------


@pytest.mark.rule("SYS-128")
@given(number=st.integers(1, 16), ier=st.integers(0, 0xFFFF), intm=st.booleans())
def test_an_interrupt_is_taken_if_ier_and_intm_allow_it_and_else_pending(number, ier, intm):
    core = cpu(ier=ier, intm=intm, raised=number)
    allowed = bool(ier & bit(number)) and not intm
    assert core.next_taken(10) == (number if allowed else 0)
    assert core.ifr == bit(number)
    core.or_ier(10, bit(number))
    core.clrc_intm(12)
    assert core.next_taken(14) == number


@pytest.mark.rule("SYS-129")
def test_interrupts_are_served_in_the_order_of_priority():
    core = cpu()
    order = [EMUINT, NMI, RTOSINT, *range(1, 15), DLOGINT]
    for number in reversed(order):
        core.raise_line(0, number)
    served = []
    now = 10
    while core.next_taken(now):
        served.append(core.next_taken(now))
        core.enter(now, served[-1])
        core.back(core.ready)
        now = core.ready
    assert served == order


@pytest.mark.rule("SYS-129")
def test_a_reset_clears_pending_interrupts_and_the_nesting():
    core, now = in_isr()
    for number in (EMUINT, NMI, 1):
        core.raise_line(now, number)
    core.reset(now + 10)
    assert core.next_taken(now + 10) == 0
    assert (core.ifr, core.nested, core.next_wake) == (0, 0, NEVER)


@pytest.mark.rule("SYS-129")
@pytest.mark.parametrize("number", [NMI, EMUINT])
def test_nmi_ignores_the_masks_and_leaves_ifr_and_ier(number):
    core = cpu(ier=0, intm=True)
    core.ifr = 0x55
    core.raise_line(0, number)
    assert core.next_taken(5) == number
    core.enter(5, number)
    assert (core.ifr, core.ier, core.ready) == (0x55, 0, 15)
    assert core.next_taken(core.ready) == 0


@pytest.mark.rule("SYS-095")
@pytest.mark.parametrize(
    ("xnmicr", "source"), [(0, "TINT1"), (1, "TINT1"), (0xD, "TINT1"), (2, "XNMI_XINT13"), (3, "XNMI_XINT13")]
)
def test_the_source_of_int13_depends_on_xnmicr(xnmicr, source):
    assert int13_source(xnmicr) == source


def test_st1_is_laid_out_as_in_the_manual():
    assert [INTM, DBGM, VMAP, LOOP] == [0x001, 0x002, 0x008, 0x020]
    assert [EALLOW, IDLESTAT, OBJMODE, M0M1MAP] == [0x040, 0x080, 0x200, 0x800]
    assert CpuInterrupts(SystemOptions()).st1 == 0x080B


# Entry and exit -----------------------------------------------------------------------------


@pytest.mark.parametrize(("sp", "after", "first"), [(0x400, 0x40F, 0x400), (0x401, 0x410, 0x402), (0xFFFA, 9, 0xFFFA)])
def test_sp_rises_by_15_and_wraps_at_16_bits(sp, after, first):
    core = cpu()
    core.sp = sp
    core.raise_line(0, 9)
    core.enter(IFR_DELAY, 9)
    assert (core.sp, frame_of(core.returning_sp)) == (after, first)
    core.back(core.ready)
    assert core.sp == sp


@pytest.mark.rule("SYS-132", "SYS-135", "SYS-136")
def test_registers_and_stack_after_an_entry():
    core = cpu(ier=0x0140)
    core.st1 |= LOOP | EALLOW | IDLESTAT | OBJMODE
    core.st1 &= ~DBGM
    before = core.st1
    core.ifr = bit(9) | bit(7)
    context = core.enter(2, 7)
    assert core.ifr == bit(9)
    assert (context.ier, core.ier) == (0x0140, 0x0100)
    assert context.st1 == before
    assert core.st1 == OBJMODE | VMAP | M0M1MAP | INTM | DBGM


@pytest.mark.rule("SYS-141")
def test_iret_takes_8_cycles_and_restores_ier_and_st1_except_three_bits():
    core = cpu(ier=0x0140)
    core.st1 = EALLOW | LOOP | IDLESTAT | M0M1MAP | OBJMODE | VMAP
    core.ifr = bit(9)
    core.enter(2, 9)
    core.or_ier(20, 0x8000)
    core.st1 &= ~(OBJMODE | M0M1MAP)
    core.back(40)
    assert core.ier == 0x0140
    assert core.st1 == EALLOW | OBJMODE | VMAP
    assert (core.intm, core.eallow, core.idlestat) == (0, 1, 0)
    assert core.ready == 48


@pytest.mark.rule("SYS-141")
def test_iret_leaves_the_bits_set_that_it_does_not_restore():
    core, now = in_isr()
    core.st1 |= LOOP | IDLESTAT
    core.back(now)
    assert core.st1 & (LOOP | IDLESTAT | M0M1MAP) == LOOP | IDLESTAT | M0M1MAP


@pytest.mark.rule("SYS-142", "SYS-143")
def test_open_irq_after_iret_at_once():
    core, now = returned()
    assert [core.next_taken(now + 20 + n) for n in range(9)] == [0] * 8 + [9]
    assert core.touched == {"int_latency", "irq_after_iret", "vector_fetch_waits"}


@pytest.mark.rule("SYS-142", "SYS-143")
def test_open_irq_after_iret_after_one_instruction():
    core, now = returned(irq_after_iret="after_one_instruction")
    assert core.next_taken(now + 28) == 0
    assert core.owes_instruction
    core.owes_instruction = False
    assert core.next_taken(now + 29) == 9
    assert core.touched == {"int_latency", "irq_after_iret", "vector_fetch_waits"}


def test_earliest_includes_the_instruction_after_iret():
    core, now = returned(irq_after_iret="after_one_instruction")
    assert core.earliest() == now + 29
    core.owes_instruction = False
    assert core.earliest() == now + 28


def test_an_eallow_counts_as_the_instruction_after_iret():
    core, now = returned(irq_after_iret="after_one_instruction")
    core.set_eallow(now + 28, True)
    assert core.next_taken(now + 32) == 9


@pytest.mark.rule("SYS-153")
def test_eallow_is_0_in_the_routine_and_1_again_after_it():
    core = cpu()
    core.set_eallow(0, True)
    assert (core.eallow, core.ready) == (1, 4)
    core.raise_line(0, 9)
    core.enter(4, 9)
    assert core.eallow == 0
    core.back(core.ready)
    assert core.eallow == 1
    core.set_eallow(core.ready, False)
    assert core.eallow == 0


# Masks by instruction ---------------------------------------------------------------------------


@pytest.mark.rule("SYS-144")
def test_clrc_intm_takes_2_cycles_and_enables_directly_after():
    core = cpu(intm=True, raised=9)
    core.clrc_intm(10)
    assert [core.next_taken(now) for now in (10, 11, 12)] == [0, 0, 9]


@pytest.mark.rule("SYS-145")
def test_after_setc_intm_nothing_maskable_is_taken():
    core = cpu()
    core.setc_intm(0)
    assert core.ready == 2
    core.raise_line(0, 9)
    assert [core.next_taken(now) for now in range(4, 20)] == [0] * 16
    core.raise_line(20, NMI)
    assert core.next_taken(20) == NMI


@pytest.mark.rule("SYS-146")
def test_a_request_that_arrives_in_the_cycle_of_and_ifr_wins():
    core = cpu(ier=0, raised=3)
    core.raise_line(6, 9)
    core.and_ifr(10, 0)
    assert core.ifr == bit(9)
    core.and_ifr(12, 0)
    assert core.ifr == 0


@pytest.mark.rule("SYS-124", "SYS-147")
@given(number=st.integers(1, 12))
def test_a_flag_that_firmware_sets_starts_the_interrupt_through_line_1(number):
    core = cpu(ier=0)
    pie = Pie(SystemOptions())
    pie.write(0, PIECTRL.offset, 1)
    core.ifr = bit(number)
    assert core.next_taken(2) == 0
    core.or_ier(2, bit(number))
    assert [core.next_taken(now) for now in (3, 4)] == [0, number]
    core.enter(4, number)
    assert core.ifr == 0
    assert pie.vector(4 + core.vector_delay, number) == (1, line_vector(number, 1))


# TRAP, IDLE -----------------------------------------------------------------------------------


@pytest.mark.rule("SYS-124")
@pytest.mark.parametrize("number", range(1, 13))
def test_trap_and_intr_take_the_vector_of_line_1(number):
    pie = Pie(SystemOptions())
    pie.write(0, PIECTRL.offset, 1)
    pie.write(0, PIEIER[number - 1].offset, 4)
    pie.request(0, number, 3)
    assert pie.cpu_vector(number) == line_vector(number, 1)
    assert pie.peek(1, PIEIFR[number - 1].offset) == 4
    assert [note.source for note in pie.notes] == ["SPRU430F TRAP, INTR"]


@pytest.mark.rule("SYS-148")
def test_trap_ignores_the_masks_and_leaves_ifr_and_ier():
    core = cpu(ier=bit(5), intm=True)
    core.ifr = bit(5) | bit(6)
    context = core.trap(10, 5)
    assert (core.ifr, core.ier, context.ier) == (bit(5) | bit(6), bit(5), bit(5))
    assert core.ready == 18
    assert core.st1 & (INTM | DBGM) == INTM | DBGM
    core.back(20)
    assert core.ier == bit(5)


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize(("intm", "then"), [(False, 9), (True, 0)])
def test_idle_waits_for_an_enabled_interrupt(intm, then):
    core = cpu(ier=bit(9), intm=intm)
    core.idle(0)
    assert core.idlestat == 1
    assert not core.idle_ends(4)
    core.raise_line(10, 8)  # not enabled in IER
    core.raise_line(20, 9)
    assert next(now for now in range(5, 30) if core.idle_ends(now)) == 24
    assert core.idlestat == 0
    assert core.next_taken(24) == then
    if then:
        core.enter(24, 9)
        core.back(40)
        assert core.next_taken(48) == 0  # because the instruction after IDLE has not been executed


@pytest.mark.rule("SYS-150")
def test_idle_takes_5_cycles_even_if_an_interrupt_is_pending():
    core = cpu(ier=bit(9), intm=True)
    core.ifr = bit(9)
    core.idle(10)
    assert [core.idle_ends(now) for now in (10, 14, 15)] == [False, False, True]


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize("wake", [0, 3, 16])
def test_open_idle_wake(wake):
    """IDLE begins in cycle 0. The IFR bit of a request at 20 is set at 24; the CPU continues `wake` cycles later."""
    core = cpu(ier=bit(9), idle_wake=wake)
    core.idle(0)
    core.raise_line(20, 9)
    assert next(now for now in range(5, 30) if core.idle_ends(now)) == 24
    assert (core.idlestat, core.ready, core.earliest()) == (0, 24 + wake, 24 + wake)
    assert next(now for now in range(24, 60) if core.next_taken(now)) == 24 + wake
    core.enter(24 + wake, 9)
    assert core.ready == 24 + wake + 10
    assert core.touched == {"idle_wake", "int_latency", "vector_fetch_waits"}


# Reset, and notes about broken rules -------------------------------------------------------------------


@pytest.mark.rule("SYS-151")
def test_state_after_reset():
    fresh = Core(SystemOptions())
    used, now = in_isr()
    used.raise_line(now, 3)
    used.reset(now + 1)
    for core in (fresh, used):
        assert (core.ier, core.ifr, core.sp) == (0, 0, 0x400)
        assert (core.intm, core.st1 & DBGM, core.eallow, core.idlestat) == (1, DBGM, 0, 0)
        assert core.st1 & VMAP
        assert not core.st1 & OBJMODE
        assert core.nested == 0


@pytest.mark.rule("SYS-152")
def test_iret_with_interrupts_enabled_is_reported():
    core, now = in_isr()
    core.clrc_intm(now)
    core.back(now + 10)
    assert [(note.code, note.source) for note in core.notes] == [("duty", "SPRZ272N section 3.1.2")]


@pytest.mark.rule("SYS-152")
def test_nesting_that_disables_before_iret_is_served_and_not_reported():
    core, now = in_isr(9)
    core.clrc_intm(now)
    core.raise_line(now, 1)
    inner = core.next_taken(now + 4)
    core.enter(now + 4, inner)
    core.back(core.ready)
    core.setc_intm(core.ready)
    core.back(core.ready)
    assert inner == 1
    assert core.nested == 0
    assert not core.notes


@pytest.mark.rule("SYS-126")
@pytest.mark.parametrize(("between", "reported"), [(0, True), (1, False)], ids=["directly", "with a NOP"])
def test_pieack_and_eint_without_a_nop_between_are_reported(between, reported):
    core, now = in_isr()
    core.wrote_pieack(now)
    core.clrc_intm(now + cpu_costs.SIMPLE + between)
    assert [note.source for note in core.notes] == ["SPRZ272N section 3.1.1"] * reported


def test_pieack_and_eint_outside_of_routines_are_not_reported_as_nesting():
    core = cpu(intm=True)
    core.wrote_pieack(0)
    core.clrc_intm(1)
    assert not core.notes


# Earliest cycle of an interrupt entry --------------------------------------------------------------------


@given(
    requests=st.lists(st.tuples(st.integers(0, 30), st.integers(1, 14)), max_size=4),
    ier=st.integers(0, 0x3FFF),
    intm=st.booleans(),
)
def test_earliest_is_the_first_cycle_in_which_next_taken_is_not_0(requests, ier, intm):
    core, twin = cpu(ier=ier, intm=intm), cpu(ier=ier, intm=intm)
    for now, number in sorted(requests):
        core.raise_line(now, number)
        twin.raise_line(now, number)
    taken = [now for now in range(max((t for t, _ in requests), default=0), 60) if twin.next_taken(now)]
    earliest = core.earliest()
    if taken:
        assert max(earliest, max(t for t, _ in requests)) == taken[0]
    else:
        assert earliest == NEVER


ROW_OF = """
    SIMPLE NOP_indind          EALLOW EALLOW              EDIS EDIS               AND_IER AND_IER_16
    OR_IER OR_IER_16           AND_IFR AND_IFR_16         TRAP TRAP_0_31          IRET IRET
    IDLE IDLE
"""


def test_instruction_costs_are_those_of_the_table_of_encodings():
    words = ROW_OF.split()
    table = {name: by_id()[row].cycles for name, row in zip(words[::2], words[1::2], strict=True)}
    table["SB_NOT_TAKEN"] = by_id()["SB_off8_COND"].not_taken
    table["SB_ALWAYS"] = by_id()["SB_off8_COND"].cycles_of({"k": 15})[0]
    for mnemonic in ("SETC", "CLRC"):
        table[f"{mnemonic}_INTM"] = by_id()[f"{mnemonic}_mode"].cycles_of({"y": 1 << 4})[0]
    table |= {"IFR_DELAY": 4, "VECTOR_AND_SAVE": 9}  # the costs of other things than instructions
    assert table == {name: value for name, value in vars(cpu_costs).items() if isinstance(value, int)}


def test_iret_returns_through_a_frame_that_firmware_made_up():
    """A real-time kernel starts its first task, which was never interrupted, in this way."""
    core = cpu(ier=0, intm=True)
    core.sp = 0x41F
    core.iret(5, OBJMODE | VMAP | M0M1MAP, 0x0040)
    assert (core.sp, core.ier, core.st1) == (0x410, 0x0040, OBJMODE | VMAP | M0M1MAP)
    assert (core.nested, core.ready) == (0, 13)


# Reset during entries and exits ------------------------------------------------------------------------------


def test_after_a_reset_during_an_entry_an_nmi_is_taken_at_once():
    core, now = in_isr(9, irq_after_iret="after_one_instruction")
    core.raise_line(now, 1)
    core.clrc_intm(now)
    core.enter(now + 4, 1)
    core.reset(now + 6)  # the first instruction of the routine would be at now + 14
    core.raise_line(now + 6, NMI)
    assert (core.ready, core.next_taken(now + 6), core.earliest()) == (now + 6, NMI, now + 6)


def test_after_a_reset_no_instruction_after_iret_is_required():
    core, now = in_isr(9, irq_after_iret="after_one_instruction")
    core.back(now)
    assert core.owes_instruction
    core.reset(now + 1)
    assert not core.owes_instruction


def test_a_reset_clears_an_ifr_bit_that_was_set_in_its_cycle():
    core = cpu(ier=0, raised=3)
    core.wake(IFR_DELAY)
    assert core.ifr == bit(3)
    core.reset(IFR_DELAY)
    core.and_ifr(IFR_DELAY, 0)
    assert core.ifr == 0


@pytest.mark.parametrize("number", [NMI, EMUINT])
def test_earliest_of_a_request_that_cannot_be_masked(number):
    core = cpu(ier=0, intm=True)
    core.setc_intm(10)
    core.raise_line(10, number)
    assert core.earliest() == 12
