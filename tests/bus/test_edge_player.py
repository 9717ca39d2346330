"""Replay of edges: one event for each edge; on a one-way wire only the player drives, and others drive its back."""

from __future__ import annotations

from periph_sim.bus.edge_player import EdgePlayer, OneWayWire
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire


def test_edges_are_replayed_at_their_ticks_with_one_event_each():
    kernel = Kernel()
    wire = Wire(kernel, "RX", Recorder())
    seen: list[tuple[int, int]] = []
    watch([wire], lambda tick, level: seen.append((tick, level)))
    edges = [(10, 0), (13, 1), (20, 0), (90, 1)]
    EdgePlayer(kernel, wire, edges)
    kernel.run_until(50)
    assert seen == edges[:3]
    kernel.run_until(100)
    assert seen == edges and kernel.events == 4


def test_a_line_without_edges_is_idle():
    kernel = Kernel()
    wire = Wire(kernel, "RX", Recorder())
    EdgePlayer(kernel, wire, [])
    kernel.run_until(100)
    assert (kernel.events, wire.level) == (0, 1)


def test_other_parties_drive_the_back_and_observe_the_player():
    kernel = Kernel()
    wire = OneWayWire(kernel, "SDA", Recorder())
    player, chip = wire.attach("capture"), wire.attach("dsp.SDAA")
    observed: list[tuple[int, int]] = []
    watch([wire], lambda now, level: observed.append((now, level)))
    steps = [(10, chip, 0), (20, player, 0), (30, chip, 1), (40, player, 1)]
    for at, pin, level in steps:
        kernel.call_at(at, lambda pin=pin, level=level: pin.drive(level))
    seen = []
    for at in (15, 25, 35, 45):
        kernel.run_until(at)
        seen.append((wire.level, wire.back.level))
    assert seen == [(1, 0), (0, 0), (0, 1), (1, 1)]
    assert observed == [(20, 0), (40, 1)]
    assert wire.parties() == ["capture"] and wire.back.parties() == ["dsp.SDAA"]
