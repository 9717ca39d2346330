"""The time of one CPU: errors in its firmware, a change of its clock, and firmware that is killed and started again."""

from __future__ import annotations

import sys
from fractions import Fraction

import pytest

from periph_sim.core.chip import NEVER
from periph_sim.f28335.cpu.interrupts import NMI
from periph_sim.processor.user_code import FirmwareError
from tests.processor.bench import Bench

TICKS = 20  # a cycle


def line() -> int:
    return sys._getframe(1).f_lineno


def test_an_error_in_periph_sim_itself_is_raised_unchanged():
    bench = Bench([])
    with pytest.raises(TypeError):
        bench.run(lambda: bench.cpu.compute("ten"), 100)


@pytest.mark.parametrize(("message", "text"), [(("too hot",), "too hot"), ((), "no message")])
def test_an_error_of_firmware_is_reported_with_its_line(message: tuple[str, ...], text: str):
    bench = Bench([])
    raised: list[int] = []

    def main() -> None:
        raised.append(line() + 1)
        raise OverflowError(*message)

    with pytest.raises(FirmwareError) as error:
        bench.run(main, 100)
    assert str(error.value) == f"dsp: OverflowError at line {raised[0]} of test_cpu_time.py: {text}"


def test_a_firmware_error_raised_by_firmware_is_unchanged():
    bench = Bench([])

    def main() -> None:
        raise FirmwareError("the sensor does not answer")

    with pytest.raises(FirmwareError) as error:
        bench.run(main, 100)
    assert str(error.value) == "the sensor does not answer"


@pytest.mark.parametrize("how", ["instruction", "compute"])
@pytest.mark.parametrize("hz", [75_000_000, 300_000_000])
def test_firmware_continues_at_the_rate_of_a_retuned_clock(hz: int, how: str):
    """The clock changes after 400 of 1000 cycles."""
    bench = Bench([])
    ended: list[int] = []

    def main() -> None:
        getattr(bench.cpu, how)(1000)
        ended.append(bench.kernel.now)

    def retune() -> None:
        bench.clock.retune(400, Fraction(hz))
        bench.processor.time.reclock()

    bench.kernel.call_at(400 * TICKS, retune)
    bench.cpu.start(main)
    bench.kernel.run_until(100_000)
    assert bench.cpu.cycle == 1000
    assert ended == [400 * TICKS + 600 * TICKS * 150_000_000 // hz]
    assert bench.kernel.events == 3  # start, change, end


def test_killed_firmware_runs_its_finally_and_its_posted_writes_do_not_land():
    bench = Bench([(1, 4, -1)])

    def main() -> None:
        try:
            bench.cpu.compute(10)
            bench.flags.STATUS.all = 4  # would clear C two cycles later, if it landed
            bench.cpu.compute(1000)
        finally:
            bench.note("ended")

    bench.cpu.start(main, delay=5)
    bench.kernel.run_until(16 * TICKS)
    bench.processor.kill()
    bench.processor.time.reclock()  # must do nothing, since the CPU waits for nothing
    assert bench.log == [("ended", 16)]
    bench.kernel.run_until(2000 * TICKS)
    assert (bench.chip.status, bench.cpu.program.finished, bench.kernel.next_time()) == (4, False, NEVER)
    assert bench.processor.causing_statement() is None


def test_an_interrupt_does_not_wake_killed_firmware():
    bench = Bench([])
    bench.cpu.start(lambda: bench.cpu.compute(1000))
    bench.kernel.run_until(10 * TICKS)
    bench.processor.kill()
    bench.processor.request(20, NMI)
    assert bench.kernel.next_time() == NEVER


def test_firmware_can_be_started_again():
    bench = Bench([])
    bench.cpu.start(lambda: (bench.cpu.compute(49), bench.flags.STATUS.__setattr__("all", 4), bench.cpu.compute(100)))
    bench.kernel.run_until(50 * TICKS)  # a write is posted
    bench.processor.kill()
    bench.cpu.start(lambda: (bench.cpu.compute(30), bench.note("end")), delay=7)
    bench.kernel.run_until(1000 * TICKS)
    assert bench.log == [("end", 50 + 7 + 30)] and bench.cpu.program.finished


def test_an_interrupt_caused_by_a_read_interrupts_the_computation_after_it():
    """The read of COUNT in cycle 102, after its second wait state, schedules an interrupt for five cycles later."""
    bench = Bench([])
    bench.enable()
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("served"))
    read, chip = bench.chip.read, bench.chip

    def promise(now: int, offset: int) -> int:
        bench.note("read")
        chip.changes.append((now + 5, 1, 0))
        chip.next_wake = now + 5
        return read(now, offset)

    chip.read = promise  # type: ignore[method-assign]
    log = bench.run(lambda: (bench.cpu.compute(100), bench.flags.COUNT.all, bench.cpu.compute(1000)), 2000)
    assert log == [("read", 102), ("served", 102 + 5 + 14)]


def test_kernel_time_is_that_of_the_access_when_a_write_lands_or_a_read_has_effects():
    """Reads without side effects are made earlier, since no other party can notice."""
    bench = Bench([])
    seen: list[tuple[str, int, int]] = []
    read, write = bench.chip.read, bench.chip.write

    def reads(now: int, offset: int) -> int:
        seen.append(("R", now, bench.kernel.now))
        return read(now, offset)

    def writes(now: int, offset: int, value: int) -> None:
        seen.append(("W", now, bench.kernel.now))
        write(now, offset, value)

    bench.chip.read, bench.chip.write = reads, writes  # type: ignore[method-assign]

    def main() -> None:
        for _ in range(10):
            _ = bench.flags.STATUS.all
        _ = bench.flags.COUNT.all
        bench.flags.STATUS.all = 0
        for _ in range(10):
            _ = bench.flags.STATUS.all

    bench.run(main, 1000)
    assert seen == [("R", 32, 32 * TICKS), ("W", 35, 35 * TICKS)]
