"""Waiting firmware runs the event loop itself, with the same results; stacks are switched only between units."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import greenlet
import pytest

from periph_sim.core.agent import Agent
from periph_sim.core.kernel import CHIP, TIMER, SimulationStuck
from periph_sim.processor.user_code import FirmwareError
from tests.processor.bench import Bench

TICKS = 20  # of a cycle


class Acts(Agent):
    """An agent that calls a function when its event is due."""

    def __init__(self, bench: Bench, cycle: int, does: Callable[[], object], phase: int = TIMER) -> None:
        self.does = does
        bench.kernel.schedule(cycle * TICKS, self, 0, phase)

    def act(self, tag: int) -> None:
        self.does()


@contextmanager
def switches() -> Iterator[list[str]]:
    """Collect the switches between stacks."""
    made: list[str] = []
    before = greenlet.settrace(lambda event, _: made.append(event))
    try:
        yield made
    finally:
        greenlet.settrace(before)


def firmware_frames() -> list[str]:
    """Return the functions of this file on the current stack."""
    frame, names = sys._getframe(1), []
    while frame is not None:
        if frame.f_code.co_filename == __file__:
            names.append(frame.f_code.co_name)
        frame = frame.f_back
    return names


def waits(bench: Bench, times: int) -> Callable[[], None]:
    """Return firmware that waits `times` times for A to rise and to fall."""

    def firmware() -> None:
        for _ in range(times):
            bench.waits.spin(lambda: bench.flags.STATUS.A == 1)
            bench.note("up")
            bench.waits.spin(lambda: bench.flags.STATUS.A == 0)
            bench.note("down")

    return firmware


def toggles(times: int, begin: int = 100, every: int = 50) -> list[tuple[int, int, int]]:
    return [(begin + every * n, (n + 1) % 2, -1) for n in range(2 * times)]


@pytest.mark.parametrize("times", [1, 40])
def test_the_stack_of_a_single_unit_is_entered_and_left_once_for_any_number_of_waits(times: int):
    bench = Bench(toggles(times))
    bench.cpu.start(waits(bench, times))
    with switches() as made:
        bench.kernel.run_until(10_000 * TICKS)
    assert len(bench.log) == 2 * times
    assert made == ["switch", "switch"]


def test_with_two_units_stacks_are_switched_only_when_the_other_unit_continues():
    one = Bench(toggles(20, every=200))
    two = Bench(toggles(20, begin=200, every=200), beside=one, name="other", base=0x7200)
    for bench in (one, two):
        bench.cpu.start(waits(bench, 20))
    one.kernel.run_until(50 * TICKS)  # both units wait
    with switches() as made:
        one.kernel.run_until(10_000 * TICKS)
    assert len(one.log) == len(two.log) == 40
    assert len(made) == 2 * 40 + 1  # one to the unit whose flag changes each time, and one out at the end
    alone = Bench(toggles(20, begin=200, every=200))
    alone.run(waits(alone, 20), 10_000)
    assert two.log == alone.log


def test_a_plain_callback_is_called_from_the_outer_loop_and_not_on_the_stack_of_firmware():
    bench, seen = Bench([]), {}

    def firmware() -> None:
        bench.cpu.compute(100)

    bench.cpu.start(firmware)
    Acts(bench, 10, lambda: seen.update(agent=firmware_frames()))
    bench.kernel.call_at(20 * TICKS, lambda: seen.update(plain=firmware_frames()))
    bench.kernel.run_until(200 * TICKS)
    assert "firmware" in seen["agent"], "no stack is switched for an agent"
    assert "firmware" not in seen["plain"] and bench.cpu.program.finished


@pytest.mark.parametrize("plain", [True, False])
def test_an_exception_of_another_party_is_raised_in_the_outer_loop_and_not_in_firmware(plain: bool):
    bench, fault = Bench([]), ValueError("of a model")

    def fail() -> None:
        raise fault

    def firmware() -> None:
        try:
            bench.cpu.compute(100)
        except BaseException:
            bench.note("seen")
            raise
        bench.note("end")

    bench.cpu.start(firmware)
    if plain:
        bench.kernel.call_at(10 * TICKS, fail)
    else:
        Acts(bench, 10, fail)
    with pytest.raises(ValueError, match="of a model") as raised:
        bench.kernel.run_until(200 * TICKS)
    names = [entry.name for entry in raised.traceback]
    assert raised.value is fault and names[-1] == "fail" and "firmware" not in names
    assert bench.log == [] and bench.kernel.now == 10 * TICKS
    bench.kernel.run_until(200 * TICKS)  # a caller that handles the exception may continue the run
    assert bench.log == [("end", 100)]


def test_endless_events_at_one_instant_are_reported_in_the_outer_loop():
    bench = Bench([])

    def again() -> None:
        Acts(bench, 10, again)

    Acts(bench, 10, again)
    bench.cpu.start(lambda: bench.cpu.compute(100))
    with pytest.raises(SimulationStuck, match=r"events at t=200 without time passing; the last: Acts"):
        bench.kernel.run_until(200 * TICKS)


def test_an_error_of_firmware_that_ran_in_the_wait_of_another_is_not_raised_in_the_latter():
    one = Bench([])
    two = Bench([], beside=one, name="other", base=0x7200)

    def patient() -> None:
        try:
            one.cpu.compute(500)
        finally:
            one.note("end")

    def faulty() -> None:
        two.cpu.compute(100)
        raise KeyError("no such table")

    one.cpu.start(patient)
    two.cpu.start(faulty)
    with pytest.raises(FirmwareError, match=r"other: KeyError at line \d+ of test_turns.py: no such table"):
        one.kernel.run_until(1000 * TICKS)
    assert one.log == [] and two.cpu.program.place() is None
    one.kernel.run_until(1000 * TICKS)
    assert one.log == [("end", 500)]


def test_a_unit_is_killed_and_started_again_while_another_waits():
    one = Bench(toggles(4))
    two = Bench([], beside=one, name="other", base=0x7200)

    def endless() -> None:
        try:
            while True:
                two.cpu.compute(30)
        finally:
            two.note("ended")

    def begin_again() -> None:
        two.processor.kill()
        two.cpu.start(lambda: (two.cpu.compute(10), two.note("again")), delay=5)

    one.cpu.start(waits(one, 4))
    two.cpu.start(endless)
    one.kernel.call_at(123 * TICKS, begin_again)
    one.kernel.run_until(2000 * TICKS)
    assert two.log == [("ended", 120), ("again", 123 + 5 + 10)]
    assert len(one.log) == 8


def test_killed_firmware_that_waits_in_its_finally_does_not_continue():
    bench = Bench([])

    def firmware() -> None:
        try:
            bench.cpu.compute(100)
        finally:
            bench.note("ended")
            bench.cpu.compute(100)
            bench.note("never")

    bench.cpu.start(firmware)
    bench.kernel.call_at(20 * TICKS, lambda: bench.processor.kill())
    Acts(bench, 30, lambda: bench.note("somebody else"))
    bench.kernel.run_until(1000 * TICKS)
    bench.cpu.start(lambda: bench.note("again"))
    bench.kernel.run_until(2000 * TICKS)
    assert [what for what, _ in bench.log] == ["ended", "somebody else", "again"]


@pytest.mark.parametrize("cycles", [50, 210])
def test_a_run_may_end_within_a_wait_and_continue(cycles: int):
    bench = Bench(toggles(10))
    bench.cpu.start(waits(bench, 10))
    ends: list[int] = []
    for end in range(cycles, 2000, cycles):
        bench.kernel.run_until(end * TICKS)
        ends.append(bench.kernel.now)
        assert bench.kernel.nested_owner is None
    whole = Bench(toggles(10))
    whole.run(waits(whole, 10), 2000)
    assert bench.log == whole.log and ends == [end * TICKS for end in range(cycles, 2000, cycles)]


def test_a_run_is_stopped_from_inside_a_wait():
    bench = Bench(toggles(10))
    bench.cpu.start(waits(bench, 10))
    Acts(bench, 300, bench.kernel.stop)
    bench.kernel.run_until(2000 * TICKS)
    assert bench.kernel.now == 300 * TICKS
    bench.kernel.run_until(2000 * TICKS)
    assert len(bench.log) == 20


def test_two_waiting_units_can_be_killed_from_outside():
    """The event loop of one unit's wait runs the other unit."""
    one = Bench(toggles(3))
    two = Bench(toggles(3, begin=125), beside=one, name="other", base=0x7200)
    ended: list[str] = []

    def run(bench: Bench, name: str) -> Callable[[], None]:
        def firmware() -> None:
            try:
                waits(bench, 10)()
            finally:
                ended.append(name)

        return firmware

    one.cpu.start(run(one, "one"))
    two.cpu.start(run(two, "two"))
    one.kernel.run_until(2000 * TICKS)
    for bench in (one, two):
        bench.processor.kill()
    assert ended == ["one", "two"]


def test_the_cause_of_firmware_is_kept_while_others_act_in_its_wait():
    """An agent sets a cause within the wait; the cause of the firmware is not affected."""
    bench, causes = Bench(toggles(1)), {}
    recorder = bench.recorder

    def under_a_record() -> None:
        causes["agent finds"] = recorder.cause
        recorder.cause = 7
        Acts(bench, 60, lambda: causes.update(later=recorder.cause), CHIP)
        recorder.cause = 0

    def firmware() -> None:
        recorder.cause = 5
        bench.waits.spin(lambda: bench.flags.STATUS.A == 1)
        causes["firmware"] = recorder.cause

    Acts(bench, 50, under_a_record)
    bench.run(firmware, 500)
    assert causes == {"agent finds": 0, "later": 0, "firmware": 5}


def test_the_causing_statement_within_a_wait_is_the_waiting_one():
    bench, places = Bench([]), []

    def look() -> None:
        places.append(bench.processor.causing_statement())

    def firmware() -> None:
        bench.cpu.compute(100)

    bench.cpu.start(firmware)
    bench.kernel.call_at(20 * TICKS, look)
    bench.kernel.run_until(200 * TICKS)
    line = firmware.__code__.co_firstlineno + 1
    assert [str(place) for place in places] == [f"firmware:{line}"]
    assert bench.processor.causing_statement() is None or bench.cpu.program.finished


def test_continuing_a_program_within_its_own_event_is_refused():
    """A replay within a wait passes the instant at which that wait ends."""
    bench = Bench([])

    class Replays(Agent):
        def act(self, tag: int) -> None:
            if tag:
                bench.kernel.schedule(bench.kernel.now, bench.processor)
            else:
                bench.kernel.replay(5 * TICKS, self, 1)

    bench.cpu.start(lambda: bench.cpu.compute(100))
    bench.kernel.schedule(10 * TICKS, Replays())
    with pytest.raises(RuntimeError, match="dsp cannot continue inside an event that it started itself"):
        bench.kernel.run_until(200 * TICKS)
