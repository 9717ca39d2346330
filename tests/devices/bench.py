"""A bench for one register chip: two wires, a controller that reads and writes, and the edges for the decoder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Literal

import numpy as np

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.target_side import TargetSide
from periph_sim.bus.i2c.transfer import BusTiming, Phase, Transfer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.devices.chips.register_chip import RegisterChip
from periph_sim.devices.register_pointer import RegisterPointer
from periph_sim.traces.capture.capture import Capture, Channel
from periph_sim.traces.decode import i2c

TIMEBASE = Timebase()  # a tick is a nanosecond
US, MS, SECOND = 1_000, 1_000_000, 1_000_000_000
FAST = BusTiming(low=1300, high=1200, hold=300, start_hold=600, start_setup=600, stop_setup=600, free=1300)  # 400 kHz
DELAY = 300


class Asked:
    """A source whose value is the number of its calls, in LSB on each axis. at: the tick of each call."""

    def __init__(self, lsb_per_unit: Fraction) -> None:
        self.at: list[int] = []
        self._lsb_per_unit = lsb_per_unit

    def __call__(self, tick: int) -> Sequence[Fraction]:
        self.at.append(tick)
        return (len(self.at) / self._lsb_per_unit,) * 3


def words(data: bytes, order: Literal["big", "little"] = "big") -> list[int]:
    return [int.from_bytes(data[i : i + 2], order, signed=True) for i in range(0, len(data), 2)]


def steady(*values: float) -> Callable[[int], Sequence[Fraction]]:
    """Return a source that always gives exactly these values."""
    exact = tuple(Fraction(str(value)) for value in values)
    return lambda tick: exact


class Bench:
    """A bus at 400 kHz. Chips are powered at 0, and a test begins at 1 s."""

    def __init__(self, *chips: RegisterChip, timing: BusTiming = FAST, begin: int = SECOND) -> None:
        self.kernel = Kernel(begin)
        recorder = Recorder()
        self.scl, self.sda = (Wire(self.kernel, name, recorder) for name in ("SCL", "SDA"))
        self.edges: dict[str, list[tuple[int, int]]] = {"SCL": [], "SDA": []}
        watch([self.scl], lambda tick, level: self.edges["SCL"].append((tick, level)))
        watch([self.sda], lambda tick, level: self.edges["SDA"].append((tick, level)))
        self.pointers = [RegisterPointer(chip, lambda: self.kernel.now) for chip in chips]
        for pointer, chip in zip(self.pointers, chips, strict=True):
            TargetSide(self.kernel, self.scl, self.sda, pointer.answer, DELAY, type(chip).__name__)
        self.controller = I2cController(self.kernel, recorder, self.scl, self.sda, timing)
        self.chips = chips
        self.done: list[Transfer] = []

    def transfer(self, *phases: Phase) -> Transfer:
        """Make a transfer and run until its STOP."""
        transfer = Transfer("test", list(phases))
        self.controller.begin(transfer, lambda done: self.kernel.stop())
        self.kernel.run_until(self.kernel.now + SECOND)
        assert not self.controller.busy
        self.done.append(transfer)
        return transfer

    def write(self, number: int, *values: int) -> bool:
        """Write pointer and data in one transfer. Return True if the address was acknowledged."""
        return self.transfer(Phase(self.address, False, bytes([number, *values]))).acked

    def read(self, number: int, count: int = 1, by_stop: bool = False) -> bytes:
        """Write the pointer and, after a repeated START (or STOP and START), read `count` bytes."""
        phases = [Phase(self.address, False, bytes([number])), Phase(self.address, True, count=count)]
        if by_stop:
            self.transfer(phases[0])
            return bytes(self.transfer(phases[1]).phases[0].got)
        return bytes(self.transfer(*phases).phases[1].got)

    def read_on(self, count: int = 1) -> bytes:
        """Read without writing the pointer first."""
        return bytes(self.transfer(Phase(self.address, True, count=count)).phases[0].got)

    @property
    def address(self) -> int:
        return self.chips[0].address

    def wait(self, ticks: int) -> None:
        self.kernel.run_until(self.kernel.now + ticks)

    def decoded(self) -> list[i2c.Transfer]:
        """The transfers that the decoder finds in the edges of the wires."""
        channels = []
        for index, (name, edges) in enumerate(self.edges.items()):
            ticks = np.array([tick for tick, _ in edges], np.int64)
            channels.append(Channel(name, index, 1, ticks))
        capture = Capture(Path("bench"), Fraction(10**9), self.kernel.now + 1, tuple(channels), sampled=False)
        return i2c.transfers(capture)
