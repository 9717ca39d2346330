"""Skipped waits take the same cycles as executing every poll, for any period, phase and interrupts."""

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
    """Return firmware that waits for the condition, and then makes a note."""

    def main() -> None:
        bench.waits.spin(condition)
        bench.note("seen")

    return main


@pytest.mark.parametrize("wait", [1_000, 1_000_000, 1_000_000_000])
def test_a_wait_of_any_length_takes_the_same_number_of_events(wait):
    bench = Bench([(wait, 1, -1)])
    log = bench.run(until(bench, lambda: bench.flags.STATUS.A == 1), wait + 100)
    assert bench.kernel.events == 3  # the start, the flag, the resumption
    (_, cycle) = log[0]
    assert wait <= cycle - 5 <= wait + 10  # at most one pass late, then the end of the read and the branch not taken


def test_polls_are_ten_cycles_apart_and_see_the_flag_at_the_read():
    """A pass is a read with 2 wait states and a branch of 7 cycles. The first read at or after the flag sees it."""
    for flag in range(5, 40):
        bench = Bench([(flag, 1, -1)])
        main = until(bench, lambda flags=bench.flags: flags.STATUS.A == 1)
        reads = [2 + 10 * k for k in range(10)]
        seen = next(r for r in reads if r >= flag)
        assert bench.run(main, 200) == [("seen", seen + 1 + 4)]


def test_a_flag_that_is_cleared_before_the_next_read_is_missed():
    bench = Bench([(14, 1, -1), (20, 0, -1)])
    assert bench.run(until(bench, lambda: bench.flags.STATUS.A == 1), 500) == []


def test_polls_of_a_register_that_a_read_changes_are_not_skipped():
    bench = Bench([(50, 1, -1), (60, 1, -1)])
    bench.run(until(bench, lambda: bench.flags.COUNT.N == 2), 300)
    assert bench.log == []  # every pass clears the count, so it never becomes 2
    assert bench.cpu.program.polls_skipped == 0


@pytest.mark.parametrize("skip", [True, False])
def test_a_wait_for_a_bit_in_the_upper_half_of_a_32_bit_register_ends(skip):
    """GPIO28 is bit 28 of GPADAT; its wire falls and rises while firmware waits for both."""
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


def test_a_posted_write_lands_although_the_wait_after_it_is_skipped():
    """A pass of 3 cycles reads outside of the protected block; the write lands 4 cycles after its issue."""
    bench = Bench([(1, 4, -1)], options=SystemOptions(write_lands=4), code=replace(BARE, poll_pass=3))

    def main() -> None:
        bench.cpu.compute(10)
        bench.flags.STATUS.all = 4  # C, which a 1 clears
        bench.note(f"{bench.waits.spin(lambda: bench.pie_regs.PIEIER1.INTx1, timeout=100)} C={bench.chip.status}")

    assert bench.run(main, 50) == []
    assert bench.chip.status == 0, "the wait still lasts"


def test_a_wait_is_skipped_again_after_an_interrupt():
    """Passes take 6 cycles and the flag is set in cycle 9000: nearly all of them are skipped."""
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


def test_an_interrupt_requested_after_a_wait_is_taken_at_the_end_of_the_instruction():
    """The write after the wait requests it; the instruction of 1000 cycles is completed, and B rises meanwhile."""
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


def evaluations(
    changes: list[tuple[int, int, int]], work: int = 0, *, skip: bool = True
) -> tuple[list[tuple[str, int]], int]:
    """Return the log of a wait for A with `work` cycles in its condition, and how often the condition was evaluated."""
    bench = Bench(changes, code=replace(BARE, poll_pass=10), skip_polls=skip)
    evaluated: list[int] = []

    def condition() -> bool:
        evaluated.append(bench.cpu.cycle)
        bench.cpu.compute(work)
        return bool(bench.flags.STATUS.A)

    return bench.run(until(bench, condition), 600), len(evaluated)


def test_a_condition_is_evaluated_again_only_when_a_bit_that_it_read_differs():
    """A is set and cleared three times between two reads; then it is set and stays."""
    glitches = [(104, 1, -1), (107, 0, -1), (204, 1, -1), (207, 0, -1), (304, 1, -1), (307, 0, -1)]
    seen, times = evaluations([*glitches, (400, 1, -1)])
    assert times == 2  # the first pass, and the one that ends the wait
    polled, every_pass = evaluations([*glitches, (400, 1, -1)], skip=False)
    assert seen == polled == [("seen", 402 + 1 + 4)] and every_pass == 41


@pytest.mark.parametrize("work", [1, 7])
def test_a_condition_that_computes_is_evaluated_in_each_executed_pass(work):
    glitches = [(104, 1, -1), (105, 0, -1), (204, 1, -1), (206, 0, -1), (304, 1, -1), (309, 0, -1), (400, 1, -1)]
    seen, times = evaluations(glitches, work)
    polled, every_pass = evaluations(glitches, work, skip=False)
    assert seen == polled and 2 < times < every_pass
