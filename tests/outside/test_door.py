"""The hold of our own side on wires that lead outside: what its changes are, seen from there."""

from __future__ import annotations

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire
from periph_sim.outside.door import Change, Door


def test_a_hold_that_does_not_outlast_its_instant_is_no_change() -> None:
    """A chip lets SDA go as soon as its fall has settled; at 7 it pulls again, and holds it."""
    kernel = Kernel()
    sda, scl = (Wire(kernel, name, Recorder()) for name in ("SDA", "SCL"))
    door = Door(kernel, {"SDA": sda, "SCL": scl}, lambda tick, levels: None)
    chip, clock = sda.attach("chip"), scl.attach("chip")
    held = iter([1, 1, 0])  # what the chip does once its pull has settled
    watch([sda], lambda tick, level: None if level else chip.drive(next(held)))
    kernel.call_at(3, lambda: chip.drive(0))
    kernel.call_at(5, lambda: clock.drive(0))
    kernel.call_at(5, lambda: chip.drive(0))
    kernel.call_at(7, lambda: chip.drive(0))
    kernel.run_until(4)
    assert door.changes() == []
    kernel.run_until(8)
    assert door.changes() == [Change(5, "SCL", 0), Change(7, "SDA", 0)]
    assert door.changes() == []
