"""Edges played again, one event an edge."""

from __future__ import annotations

from periph_sim.bus.edge_player import EdgePlayer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire


def test_edges_come_when_they_are_due_and_cost_an_event_each():
    kernel = Kernel()
    wire = Wire(kernel, "RX", Recorder())
    seen: list[tuple[int, int]] = []
    watch([wire], lambda tick, level: seen.append((tick, level)))
    edges = [(10, 0), (13, 1), (20, 0), (90, 1)]
    player = EdgePlayer(kernel, wire, edges)
    kernel.run_until(50)
    assert seen == edges[:3] and player.busy
    kernel.run_until(100)
    assert seen == edges and not player.busy and kernel.events == 4


def test_no_edges_is_an_idle_line():
    kernel = Kernel()
    wire = Wire(kernel, "RX", Recorder())
    assert not EdgePlayer(kernel, wire, []).busy and wire.level == 1
