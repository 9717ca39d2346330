"""A wire is low while at least one party pulls it; changes that end within their tick are not reported."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.kernel import CPU, Kernel, SimulationStuck
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.sampler import Sampler, watch
from periph_sim.core.wire import MAX_PARTIES, Wire


def wired(*who: str):
    kernel = Kernel()
    wire = Wire(kernel, "SDA", Recorder())
    changes: list[tuple[int, int]] = []
    watch([wire], lambda tick, level: changes.append((tick, level)))
    return kernel, wire, [wire.attach(name) for name in who], changes


def recorded(*kinds: Kind) -> tuple[Kernel, Recorder, Wire, list[Record]]:
    """Return a kernel, its recorder, a wire, and the list of the wire's records of these kinds."""
    kernel, recorder, seen = Kernel(), Recorder(), list[Record]()
    recorder.subscribe(kinds, seen.append)
    return kernel, recorder, Wire(kernel, "SDA", recorder), seen


def test_the_line_rises_when_its_last_party_releases_it():
    kernel, wire, (a, b), changes = wired("controller", "target")
    for tick, pin, level in ((1, a, 0), (2, b, 0), (3, a, 1), (4, b, 1)):
        kernel.call_at(tick, lambda pin=pin, level=level: pin.drive(level))
    kernel.run_until(3)
    assert wire.held_by() == ["target"] and wire.level == 0
    kernel.run_until(4)
    assert changes == [(1, 0), (4, 1)]


def test_a_pulse_within_one_tick_is_not_reported():
    kernel, _, (a,), changes = wired("a")
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(1, lambda: a.drive(1))
    kernel.run_until(1)
    assert changes == []


def test_a_hand_over_within_one_tick_has_no_glitch():
    kernel, wire, (a, b), changes = wired("a", "b")
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(2, lambda: a.drive(1))
    kernel.call_at(2, lambda: b.drive(0))
    kernel.run_until(2)
    assert changes == [(1, 0)] and wire.held_by() == ["b"]


def test_a_wire_has_its_old_level_until_the_end_of_the_phase_in_which_it_changes():
    kernel, wire, (a,), _ = wired("a")
    seen = []
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(1, lambda: seen.append(wire.level))
    kernel.call_at(1, lambda: seen.append(wire.level), CPU)
    kernel.run_until(1)
    assert seen == [1, 0]


@pytest.mark.parametrize("first", [0, 1])
def test_wires_that_change_in_one_tick_are_reported_together(first: int):
    kernel, recorder, seen = Kernel(), Recorder(), []
    recorder.subscribe([Kind.EDGE, Kind.NOTE], seen.append)
    wires = [Wire(kernel, name, recorder) for name in ("SCL", "SDA")]
    pins = [wire.attach("master") for wire in wires]
    changes: list[tuple[int, int]] = []
    watch(wires, lambda tick, levels: (changes.append((tick, levels)), recorder.emit(tick, Kind.NOTE, "it", "heard")))
    for pin in (pins[first], pins[1 - first]):
        kernel.call_at(1, partial(pin.drive, 0))
    kernel.call_at(2, partial(pins[1].drive, 1))
    kernel.run_until(2)
    assert changes == [(1, 0b00), (2, 0b10)]
    scl, sda, heard, rise, then = seen
    assert [edge.where for edge in (scl, sda, rise)] == ["SCL", "SDA", "SDA"]
    assert (heard.cause, then.cause) == (scl.number, rise.number), (
        "the cause is the edge of the first line that changed"
    )


def test_a_line_of_a_sampler_follows_a_wire_or_is_set_directly():
    kernel, wire, (a,), _ = wired("a")
    changes: list[tuple[int, int]] = []
    sampler = Sampler(kernel, wire.recorder, lambda tick, levels: changes.append((tick, levels)), 0b111)
    sampler.listen(0, wire)
    moves = [
        (1, lambda: (a.drive(0), sampler.put(2, 0))),  # the wire, and a line that is set directly
        (2, lambda: sampler.put(2, 0)),  # no change
        (3, lambda: sampler.put(0, 1)),  # the line is no longer connected to the wire
        (4, lambda: a.drive(1)),
        (5, sampler.request_sample),
        (6, lambda: sampler.listen(1, wire)),
        (7, lambda: a.drive(0)),
    ]
    for tick, move in moves:
        kernel.call_at(tick, move)
    kernel.run_until(9)
    assert changes == [(1, 0b010), (3, 0b011), (5, 0b011), (7, 0b001)]


def test_watching_nothing_is_a_mistake():
    with pytest.raises(ValueError, match="no wire to watch"):
        watch([], print)


@given(st.permutations([(0, 1), (1, 2), (2, 3)]), st.integers(0, 1))
def test_the_cause_of_an_edge_does_not_depend_on_the_order_of_calls(calls: list[tuple[int, int]], level: int):
    """The cause is the latest record under which a party pulled, for a fall, or released the line, for a rise."""
    kernel, recorder, wire, seen = recorded(Kind.EDGE)
    pins = [wire.attach(name) for name in "abc"]
    for pin in pins:
        pin.drive(1 - level)
    kernel.run_until(0)
    seen.clear()

    def drive(who: int, cause: int) -> None:
        recorder.cause = cause
        pins[who].drive(level)
        recorder.cause = 0

    for call in calls:
        kernel.call_at(5, partial(drive, *call))
    kernel.run_until(5)
    assert [(edge.tick, edge.value, edge.cause) for edge in seen] == [(5, level, 3)]


def test_a_change_made_by_a_watcher_is_reported_after_all_watchers_received_its_cause():
    kernel = Kernel()
    wire = Wire(kernel, "SCL", Recorder())
    a, b = wire.attach("a"), wire.attach("b")
    log: list[str] = []
    watch([wire], lambda tick, level: (log.append(f"first {level}"), b.drive(0) if level else None))
    watch([wire], lambda tick, level: log.append(f"second {level}"))
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(2, lambda: a.drive(1))
    kernel.run_until(2)
    assert log == ["first 0", "second 0", "first 1", "second 1", "first 0", "second 0"]


def test_a_sampler_that_leaves_a_wire_during_a_notification_is_still_notified():
    kernel, wire, (a,), _ = wired("a")
    changes: list[tuple[int, int]] = []
    watch([wire], lambda tick, level: leaving.put(0, level))
    watch([wire], lambda tick, level: None)
    leaving = watch([wire], lambda tick, levels: changes.append((tick, levels)))
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(2, lambda: a.drive(1))
    kernel.run_until(1)
    assert changes == [(1, 0)]
    kernel.run_until(2)
    assert changes == [(1, 0), (2, 1)]


def test_wires_that_do_not_settle_end_the_run():
    kernel = Kernel()
    wire = Wire(kernel, "SDA", Recorder())
    pin = wire.attach("a")
    watch([wire], lambda tick, level: pin.drive(1 - level))
    kernel.call_at(1, lambda: pin.drive(0))
    with pytest.raises(SimulationStuck, match="wires did not settle at t=1"):
        kernel.run_until(1)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 1)), max_size=60))
def test_the_level_is_the_and_of_all_parties(moves):
    kernel, wire, pins, changes = wired("a", "b", "c", "d")
    held = [1] * 4
    for tick, (who, level) in enumerate(moves, 1):
        kernel.call_at(tick, lambda who=who, level=level: pins[who].drive(level))
        kernel.run_until(tick)
        held[who] = level
        assert wire.level == min(held)
    levels = [level for _, level in changes]
    assert all(a != b for a, b in pairwise(levels))


def test_an_edge_is_recorded_with_the_pulling_party_and_is_the_cause_of_its_effects():
    kernel, recorder, wire, seen = recorded(Kind.EDGE, Kind.NOTE)
    pin = wire.attach("target")
    watch([wire], lambda tick, level: recorder.emit(tick, Kind.NOTE, "watcher", "heard", level))
    kernel.call_at(4, lambda: pin.drive(0))
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


def test_each_change_of_the_parties_that_hold_a_line_low_is_recorded():
    """a     \\____/
    b         \\__________/
    c                  \\__/       falls in the tick in which b releases the line
    EDGE  a            HOLD: "a, b", "b", then "c", and the rise
    """
    kernel, _, wire, seen = recorded(Kind.EDGE, Kind.HOLD)
    a, b, c = (wire.attach(name) for name in "abc")
    moves = {1: [(a, 0)], 3: [(b, 0)], 4: [(a, 1), (a, 1)], 6: [(b, 1), (c, 0)], 8: [(c, 1)]}
    for tick, moved in moves.items():
        for pin, level in moved:
            kernel.call_at(tick, lambda pin=pin, level=level: pin.drive(level))
    kernel.run_until(9)
    assert [(r.tick, r.kind, r.value, r.text) for r in seen] == [
        (1, Kind.EDGE, 0, "a"),
        (3, Kind.HOLD, 0, "a, b"),
        (4, Kind.HOLD, 0, "b"),
        (6, Kind.HOLD, 0, "c"),
        (8, Kind.EDGE, 1, ""),
    ]


def test_the_cause_of_another_party_holding_a_line_is_the_record_under_which_it_pulled():
    kernel, _, wire, seen = recorded(Kind.EDGE, Kind.HOLD)
    a, b = wire.attach("a"), wire.attach("b")
    watch([wire], lambda tick, level: b.drive(0))
    kernel.call_at(1, lambda: a.drive(0))
    kernel.call_at(5, lambda: a.drive(1))
    kernel.run_until(9)
    assert [(r.kind, r.text, r.cause) for r in seen] == [
        (Kind.EDGE, "a", 0),
        (Kind.HOLD, "a, b", seen[0].number),
        (Kind.HOLD, "b", 0),
    ]


def test_a_wire_has_as_many_parties_as_its_mask_has_bits():
    wire = Wire(Kernel(), "SDA", Recorder())
    pins = [wire.attach(f"party {n}") for n in range(MAX_PARTIES)]
    assert len({pin.mask for pin in pins}) == MAX_PARTIES
    with pytest.raises(ValueError, match="wire SDA: one more would be party 63; a wire has up to 62"):
        wire.attach("one more")


def test_a_line_that_no_mask_holds_is_refused():
    kernel, recorder = Kernel(), Recorder()
    sampler = Sampler(kernel, recorder, lambda now, levels: None)
    with pytest.raises(ValueError, match="wire SDA would be line 62; a sampler has lines 0 to 61"):
        sampler.listen(MAX_PARTIES, Wire(kernel, "SDA", recorder))
