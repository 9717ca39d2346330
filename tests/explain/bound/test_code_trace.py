"""Marks of a firmware's way, and two rounds of them laid beside each other."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.explain.bound.code_trace import CodeTrace

CYCLE = Fraction(20)


def test_a_wait_that_goes_on_is_one_mark_at_its_last_read():
    """
    CPU  |code|waits ... goes on ...|
         0    20      20 -> 95
    """
    trace = CodeTrace()
    trace.note(20, "waits")
    trace.note(20, "goes on", waited=True)
    trace.amend(60)
    trace.amend(95)
    assert [(mark.tick, mark.what, mark.waited) for mark in trace.marks] == [
        (20, "waits", False),
        (95, "goes on", True),
    ]


def two_rounds(*second: tuple[int, str]) -> CodeTrace:
    """Behind a start-up: a wait that ends at 0, `read` at 100, `write` at 300; and a second round from 10000 on."""
    trace = CodeTrace()
    trace.note(-500, "start")
    for begin, marks in ((0, [(100, "read"), (300, "write")]), (10_000, second)):
        trace.note(begin, "wait", waited=True)
        for tick, what in marks:
            trace.note(begin + tick, what)
    trace.compare(1, 4, CYCLE)
    return trace


def test_two_rounds_that_take_the_same_cycles_are_even():
    assert two_rounds((100, "read"), (300, "write")).uneven(0, 20_000) == ()
    assert two_rounds((99, "read"), (301, "write")).uneven(0, 20_000) == ()  # ticks within a cycle


def test_code_that_takes_longer_the_second_time_is_uneven_in_both_rounds_and_nowhere_else():
    trace = two_rounds((100, "read"), (320, "write"))
    why = ("the code before write took 10 cycles once and 11 another time",)
    assert trace.uneven(100, 300) == trace.uneven(10_100, 10_320) == why
    assert trace.uneven(0, 100) == ()


def test_code_that_goes_another_way_or_ends_is_uneven_from_there():
    assert two_rounds((100, "read"), (300, "read")).uneven(0, 300) == ("one round came to write, the next to read",)
    assert two_rounds((100, "read")).uneven(0, 300) == ("the code before write ran once only",)
