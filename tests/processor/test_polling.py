"""Skipped waiting equals brute-force polling: same cycles, whatever the period, the phase and the interrupts."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import TIMED_OUT, Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.dsp import Dsp, DspPlan
from tests.processor.bench import Bench, recorder_of

flag_changes = st.lists(
    st.tuples(st.integers(1, 400), st.integers(0, 3), st.sampled_from([-1, -1, -1, 0, 1])), max_size=14
)


def firmware(bench: Bench, lead: int, kind: str):
    flags, cpu = bench.flags, bench.cpu

    def isr(name: str, cost: int) -> None:
        bench.note(f"{name} in")
        cpu.compute(cost)
        if name == "IRQ1":
            bench.waits.spin(lambda: flags.STATUS.A == 0)
        bench.pie_regs.PIEACK.all = 1
        bench.note(f"{name} out")

    cpu.program.handle("SEQ1INT", lambda: isr("IRQ0", 7))
    cpu.program.handle("SEQ2INT", lambda: isr("IRQ1", 23))

    def main() -> None:
        cpu.compute(lead)
        while True:
            if kind == "one field":
                bench.waits.spin(lambda: flags.STATUS.A == 1)
            elif kind == "either field":
                bench.waits.spin(lambda: flags.STATUS.A == 1 or flags.STATUS.B == 1)
            else:
                bench.waits.spin(lambda: flags.STATUS.A == 1 and flags.STATUS.B == 1)
            bench.note("seen")
            bench.waits.spin(lambda: flags.STATUS.A == 0)
            bench.note("gone")
            flags.STATUS.C = 1

    return main


def log_of(changes, lead, kind, loop, skip, interrupts=True, hz=150_000_000):
    bench = Bench(list(changes), code=replace(BARE, poll_pass=loop), skip_polls=skip, hz=Fraction(hz))
    if interrupts:
        bench.enable()
    log = bench.run(firmware(bench, lead, kind), 900)
    return log, bench


@settings(max_examples=120, deadline=None)
@given(
    changes=flag_changes,
    lead=st.integers(0, 40),
    kind=st.sampled_from(["one field", "either field", "both fields"]),
    loop=st.integers(3, 31),
    interrupts=st.booleans(),
)
def test_skipping_equals_polling(changes, lead, kind, loop, interrupts):
    skipped, _ = log_of(changes, lead, kind, loop, True, interrupts)
    polled, brute = log_of(changes, lead, kind, loop, False, interrupts)
    assert skipped == polled
    assert brute.cpu.program.polls_skipped == 0


@settings(max_examples=60, deadline=None)
@given(changes=flag_changes, lead=st.integers(0, 40), ppm=st.integers(-300, 300))
def test_skipping_equals_polling_on_a_clock_that_does_not_divide(changes, lead, ppm):
    hz = Fraction(150_000_000) * (1_000_000 + ppm) / 1_000_000
    skipped, _ = log_of(changes, lead, "either field", 10, True, hz=hz)
    polled, _ = log_of(changes, lead, "either field", 10, False, hz=hz)
    assert skipped == polled


def until(bench: Bench, condition: Callable[[], object]) -> Callable[[], None]:
    """Firmware that waits for the condition, and notes when it was seen."""

    def main() -> None:
        bench.waits.spin(condition)
        bench.note("seen")

    return main


@pytest.mark.parametrize("wait", [1_000, 1_000_000, 1_000_000_000])
def test_a_wait_costs_the_same_number_of_events_however_long_it_is(wait):
    bench = Bench([(wait, 1, -1)])
    log = bench.run(until(bench, lambda: bench.flags.STATUS.A == 1), wait + 100)
    assert bench.kernel.events == 3  # the start, the flag, the resumption
    (_, cycle) = log[0]
    assert wait <= cycle - 5 <= wait + 10  # at most one pass late, then the read's end and the branch not taken


def test_polls_are_ten_cycles_apart_and_see_the_flag_at_the_read():
    """One pass: read 1 + 2 wait states, branch back 7. A flag of cycle f is seen by the first read at or after f."""
    for flag in range(5, 40):
        bench = Bench([(flag, 1, -1)])
        main = until(bench, lambda flags=bench.flags: flags.STATUS.A == 1)
        reads = [2 + 10 * k for k in range(10)]
        seen = next(r for r in reads if r >= flag)
        assert bench.run(main, 200) == [("seen", seen + 1 + 4)]


def test_a_flag_that_is_gone_before_the_next_read_is_missed():
    bench = Bench([(14, 1, -1), (20, 0, -1)])
    assert bench.run(until(bench, lambda: bench.flags.STATUS.A == 1), 500) == []


def test_a_spin_on_a_register_that_a_read_changes_is_polled_for_real():
    bench = Bench([(50, 1, -1), (60, 1, -1)])
    bench.run(until(bench, lambda: bench.flags.COUNT.N == 2), 300)
    assert bench.log == []  # every pass took what had come so far: never two at once
    assert bench.cpu.program.polls_skipped == 0


@pytest.mark.parametrize("skip", [True, False])
def test_a_wait_for_a_bit_in_the_upper_half_of_a_32_bit_register_ends(skip):
    """GPIO28 is bit 28 of GPADAT: the wire behind it falls and rises while firmware waits for both."""
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "RX", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO",), {28: wire}, skip_polls=skip))
    seen: list[int] = []

    def main() -> None:
        gpio = dsp.module("GPIO")
        for level in (0, 1):
            dsp.spin(lambda level=level: level == gpio.GPADAT.GPIO28)
            seen.append(level)

    dsp.start(main)
    kernel.call_at(20_000, lambda: hand.drive(0))
    kernel.call_at(60_000, lambda: hand.drive(1))
    kernel.run_until(100_000)
    assert seen == [0, 1]


def test_a_write_on_its_way_lands_though_the_wait_behind_it_is_skipped():
    """A pass of 3 cycles, its read outside of the block; the write before it lands 4 cycles after its issue."""
    bench = Bench([(1, 4, -1)], options=SystemOptions(write_lands=4), code=replace(BARE, poll_pass=3))

    def main() -> None:
        bench.cpu.compute(10)
        bench.flags.STATUS.all = 4  # C, which a 1 clears
        bench.note(f"{bench.waits.spin(lambda: bench.pie_regs.PIEIER1.INTx1, timeout=100)} C={bench.chip.status}")

    assert bench.run(main, 50) == []
    assert bench.chip.status == 0, "the wait still lasts"


def test_a_wait_is_skipped_on_behind_an_interrupt_that_cut_into_it():
    """Passes of 6 cycles up to the flag in cycle 9000: all but a handful are skipped."""
    bench = Bench([(100, 0, 0), (9000, 1, -1)], code=replace(BARE, poll_pass=6))
    bench.enable()
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("served"))
    assert bench.run(until(bench, lambda: bench.flags.STATUS.A == 1), 10_000) == [("served", 115), ("seen", 9007)]
    assert bench.cpu.program.polls_skipped > 1490 and bench.kernel.events == 5


def test_waits_with_thousands_of_reads_in_a_pass_are_recorded():
    recorder, records = recorder_of(Kind.WAIT)
    bench = Bench([(60_000, 1, -1)], recorder=recorder)

    def all_read() -> bool:
        return max([bench.flags.STATUS.A for _ in range(3000)]) == 1

    def main() -> None:
        bench.waits.spin(all_read)
        bench.waits.spin(lambda: not all_read(), timeout=1)

    bench.run(main, 200_000)
    assert [(record.what, record.value) for record in records] == 2 * [("FLAGS.STATUS.A", 1), ("FLAGS.STATUS.A", 0)]
    assert [record.text for record in records if not record.value] == ["", TIMED_OUT]


def test_an_interrupt_asked_for_behind_a_wait_waits_for_the_end_of_an_instruction():
    """The write behind the wait asks for it; the instruction of 1000 cycles goes on, and B rises meanwhile."""
    bench = Bench([(1000, 1, -1), (1500, 3, -1)])
    bench.enable()
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("served"))
    write = bench.chip.write

    def ask(now: int, offset: int, value: int) -> None:
        write(now, offset, value)
        bench.chip.requests |= 1

    bench.chip.write = ask  # type: ignore[method-assign]

    def main() -> None:
        bench.waits.spin(lambda: bench.flags.STATUS.A == 1)
        bench.flags.STATUS.all = 0
        bench.cpu.instruction(1000)
        bench.note(f"B={bench.flags.STATUS.B}")

    assert bench.run(main, 5000) == [("served", 2018), ("B=1", 2029)]
    assert bench.kernel.events == 5


def asked(
    changes: list[tuple[int, int, int]], work: int = 0, *, skip: bool = True
) -> tuple[list[tuple[str, int]], int]:
    """Return what a wait for A reads, with `work` cycles in its condition, and the number of its evaluations."""
    bench = Bench(changes, code=replace(BARE, poll_pass=10), skip_polls=skip)
    asked: list[int] = []

    def condition() -> bool:
        asked.append(bench.cpu.cycle)
        bench.cpu.compute(work)
        return bool(bench.flags.STATUS.A)

    return bench.run(until(bench, condition), 600), len(asked)


def test_a_condition_is_asked_again_only_where_a_bit_that_it_read_differs():
    """A comes and goes between two reads three times; then it comes and stays."""
    glitches = [(104, 1, -1), (107, 0, -1), (204, 1, -1), (207, 0, -1), (304, 1, -1), (307, 0, -1)]
    seen, times = asked([*glitches, (400, 1, -1)])
    assert times == 2  # the first pass, and the one that ends the wait
    polled, every_pass = asked([*glitches, (400, 1, -1)], skip=False)
    assert seen == polled == [("seen", 402 + 1 + 4)] and every_pass == 41


@pytest.mark.parametrize("work", [1, 7])
def test_a_condition_that_takes_time_of_its_own_is_asked_in_each_pass_that_is_made(work):
    glitches = [(104, 1, -1), (105, 0, -1), (204, 1, -1), (206, 0, -1), (304, 1, -1), (309, 0, -1), (400, 1, -1)]
    seen, times = asked(glitches, work)
    polled, every_pass = asked(glitches, work, skip=False)
    assert seen == polled and 2 < times < every_pass
