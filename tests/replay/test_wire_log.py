"""Wires of a run as a capture."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.bus.edge_player import EdgePlayer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.replay.wire_log import WireLog


def test_a_log_has_the_edges_at_their_ticks_without_pulses_of_no_duration():
    kernel, recorder = Kernel(), Recorder()
    wires = [Wire(kernel, name, recorder) for name in ("SCL", "SDA")]
    log = WireLog(*wires)
    assert (log.last_edge, log.edge_count) == (0, 0)
    EdgePlayer(kernel, wires[0], [(5, 0), (9, 1), (20, 0)])
    EdgePlayer(kernel, wires[1], [(7, 0), (7, 1), (8, 0)])
    kernel.run_until(20)
    capture = log.capture(Timebase(150_000_000), kernel.now)
    scl, sda = capture.channels
    assert (scl.name, scl.initial, scl.edges.tolist(), scl.levels.tolist()) == ("SCL", 1, [5, 9, 20], [0, 1, 0])
    assert (sda.edges.tolist(), sda.levels.tolist()) == ([8], [0])
    assert (log.last_edge, log.edge_count) == (20, 4)
    assert (capture.rate, capture.length) == (Fraction(3_000_000_000), 21)
