"""A wire is low while anybody pulls, remembers who, and tells only what outlasts an event."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.kernel import Kernel, SimulationStuck
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.wire import Wire


def wired(*who: str):
    kernel = Kernel()
    wire = Wire(kernel, "SDA", Recorder())
    told: list[tuple[int, int]] = []
    wire.watch(lambda tick, level: told.append((tick, level)))
    return kernel, wire, [wire.attach(name) for name in who], told


def test_low_wins_and_the_last_to_let_go_raises_the_line():
    kernel, wire, (a, b), told = wired("controller", "target")
    for tick, pin, level in ((1, a, 0), (2, b, 0), (3, a, 1), (4, b, 1)):
        kernel.at(tick, lambda pin=pin, level=level: pin.drive(level))
    kernel.run_until(3)
    assert wire.held_by() == ["target"] and wire.level == 0
    kernel.run_until(4)
    assert told == [(1, 0), (4, 1)]


def test_a_pulse_inside_one_event_is_heard_by_nobody():
    kernel, _, (a,), told = wired("a")
    kernel.at(1, lambda: (a.drive(0), a.drive(1)))
    kernel.run_until(1)
    assert told == []


def test_a_hand_over_inside_one_event_shows_no_glitch():
    kernel, wire, (a, b), told = wired("a", "b")
    kernel.at(1, lambda: a.drive(0))
    kernel.at(2, lambda: (a.drive(1), b.drive(0)))
    kernel.run_until(2)
    assert told == [(1, 0)] and wire.held_by() == ["b"]


def test_an_answer_in_the_same_instant_is_told_after_every_watcher_heard_the_cause():
    kernel = Kernel()
    wire = Wire(kernel, "SCL", Recorder())
    a, b = wire.attach("a"), wire.attach("b")
    log: list[str] = []
    wire.watch(lambda tick, level: (log.append(f"first {level}"), b.drive(0) if level else None))
    wire.watch(lambda tick, level: log.append(f"second {level}"))
    kernel.at(1, lambda: a.drive(0))
    kernel.at(2, lambda: a.drive(1))
    kernel.run_until(2)
    assert log == ["first 0", "second 0", "first 1", "second 1", "first 0", "second 0"]


def test_wires_that_never_rest_are_told():
    kernel = Kernel()
    wire = Wire(kernel, "SDA", Recorder())
    pin = wire.attach("a")
    wire.watch(lambda tick, level: pin.drive(1 - level))
    kernel.at(1, lambda: pin.drive(0))
    with pytest.raises(SimulationStuck, match="wires did not come to rest at t=1"):
        kernel.run_until(1)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 1)), max_size=60))
def test_the_level_is_the_and_of_all_parties(moves):
    kernel, wire, pins, told = wired("a", "b", "c", "d")
    held = [1] * 4
    for tick, (who, level) in enumerate(moves, 1):
        kernel.at(tick, lambda who=who, level=level: pins[who].drive(level))
        kernel.run_until(tick)
        held[who] = level
        assert wire.level == min(held)
    levels = [level for _, level in told]
    assert all(a != b for a, b in pairwise(levels))


def test_an_edge_is_recorded_with_who_pulls_and_is_the_cause_of_what_follows():
    kernel, recorder, seen = Kernel(), Recorder(), []
    recorder.subscribe([Kind.EDGE, Kind.NOTE], seen.append)
    wire = Wire(kernel, "SDA", recorder)
    pin = wire.attach("target")
    wire.watch(lambda tick, level: recorder.emit(tick, Kind.NOTE, "watcher", "heard", level))
    kernel.at(4, lambda: pin.drive(0))
    kernel.run_until(4)
    edge, heard = seen
    assert (edge.kind, edge.tick, edge.where, edge.value, edge.text, edge.cause) == (
        Kind.EDGE,
        4,
        "SDA",
        0,
        "target",
        0,
    )
    assert heard.cause == edge.number and recorder.cause == 0
