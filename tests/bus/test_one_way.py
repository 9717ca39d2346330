"""On a one-way line only the player is heard; what others would drive is seen on its back."""

from __future__ import annotations

from periph_sim.bus.one_way import OneWayWire
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch


def test_others_pull_the_back_and_hear_the_player():
    kernel = Kernel()
    wire = OneWayWire(kernel, "SDA", Recorder(), "capture")
    player, chip = wire.attach("capture"), wire.attach("dsp.SDAA")
    heard: list[tuple[int, int]] = []
    watch([wire], lambda now, level: heard.append((now, level)))
    steps = [(10, chip, 0), (20, player, 0), (30, chip, 1), (40, player, 1)]
    for at, pin, level in steps:
        kernel.call_at(at, lambda pin=pin, level=level: pin.drive(level))
    seen = []
    for at in (15, 25, 35, 45):
        kernel.run_until(at)
        seen.append((wire.level, wire.back.level))
    assert seen == [(1, 0), (0, 0), (0, 1), (1, 1)]
    assert heard == [(20, 0), (40, 1)]
    assert wire.parties() == ["capture"] and wire.back.parties() == ["dsp.SDAA"]
