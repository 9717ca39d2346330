"""Firmware that waits does itself what is due meanwhile: nobody can tell, and stacks are changed for others only."""

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
    """An agent that calls a function. The kernel does not know: to it, it is as any other."""

    def __init__(self, bench: Bench, cycle: int, does: Callable[[], object], phase: int = TIMER) -> None:
        self.does = does
        bench.kernel.schedule(cycle * TICKS, self, 0, phase)

    def act(self, tag: int) -> None:
        self.does()


@contextmanager
def switches() -> Iterator[list[str]]:
    """The changes of stack that are made meanwhile."""
    made: list[str] = []
    before = greenlet.settrace(lambda event, _: made.append(event))
    try:
        yield made
    finally:
        greenlet.settrace(before)


def firmware_frames() -> list[str]:
    """The functions of this file on the present stack."""
    frame, names = sys._getframe(1), []
    while frame is not None:
        if frame.f_code.co_filename == __file__:
            names.append(frame.f_code.co_name)
        frame = frame.f_back
    return names


def waits(bench: Bench, times: int) -> Callable[[], None]:
    """Firmware that sees A rise and fall so often."""

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
def test_one_unit_waits_as_often_as_it_likes_and_its_stack_is_entered_once_and_left_once(times: int):
    bench = Bench(toggles(times))
    bench.cpu.start(waits(bench, times))
    with switches() as made:
        bench.kernel.run_until(10_000 * TICKS)
    assert len(bench.log) == 2 * times
    assert made == ["switch", "switch"]


def test_of_two_units_the_stack_changes_as_often_as_the_one_that_goes_on_changes():
    one = Bench(toggles(20, every=200))
    two = Bench(toggles(20, begin=200, every=200), beside=one, name="other", base=0x7200)
    for bench in (one, two):
        bench.cpu.start(waits(bench, 20))
    one.kernel.run_until(50 * TICKS)  # both wait
    with switches() as made:
        one.kernel.run_until(10_000 * TICKS)
    assert len(one.log) == len(two.log) == 40
    assert len(made) == 2 * 40 + 1  # to who sees its flag change each time, and out
    alone = Bench(toggles(20, begin=200, every=200))
    alone.run(waits(alone, 20), 10_000)
    assert two.log == alone.log


def test_a_plain_function_is_called_from_home_and_never_above_firmware():
    bench, seen = Bench([]), {}

    def firmware() -> None:
        bench.cpu.compute(100)

    bench.cpu.start(firmware)
    Acts(bench, 10, lambda: seen.update(agent=firmware_frames()))
    bench.kernel.call_at(20 * TICKS, lambda: seen.update(plain=firmware_frames()))
    bench.kernel.run_until(200 * TICKS)
    assert "firmware" in seen["agent"], "the way on which no stack is changed"
    assert "firmware" not in seen["plain"] and bench.cpu.program.finished


@pytest.mark.parametrize("plain", [True, False])
def test_an_exception_of_somebody_else_is_raised_at_home_and_firmware_does_not_see_it(plain: bool):
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
    bench.kernel.run_until(200 * TICKS)  # whoever takes it as told may go on
    assert bench.log == [("end", 100)]


def test_events_without_end_are_told_at_home():
    bench = Bench([])

    def again() -> None:
        Acts(bench, 10, again)

    Acts(bench, 10, again)
    bench.cpu.start(lambda: bench.cpu.compute(100))
    with pytest.raises(SimulationStuck, match=r"events at t=200 without time passing; the last: Acts"):
        bench.kernel.run_until(200 * TICKS)


def test_an_error_of_firmware_whose_turn_came_in_the_wait_of_another_is_its_own():
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


def test_a_unit_is_ended_and_begun_again_while_another_waits():
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


def test_firmware_that_is_ended_and_refuses_to_never_goes_on():
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
def test_a_run_may_end_in_the_middle_of_a_wait_and_go_on(cycles: int):
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


def test_units_are_ended_from_outside_in_the_middle_of_two_waits():
    """One of them gave the other its turn in its own wait."""
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


def test_the_cause_of_what_firmware_does_is_its_own_whoever_acted_meanwhile():
    """An agent acts under a record of its own in the middle of a wait: nothing of it is left to the firmware."""
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


def test_a_place_is_that_of_the_waiting_statement_also_for_those_who_ask_in_the_wait():
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


def test_a_program_that_is_to_go_on_in_what_it_began_itself_is_told():
    """A replay in the middle of a wait goes over the very instant at which that wait ends."""
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
