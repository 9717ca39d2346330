"""A rig for timing diagrams: an I2C controller on two wires, and a partner that pulls them low at given ticks.

One column is UNIT ticks; the controller's times are multiples of a column.
"""

from __future__ import annotations

from functools import partial

from msgspec.structs import replace

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.transfer import BusTiming, Phase, Transfer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire

UNIT = 10
TIMING = BusTiming(
    low=2 * UNIT, high=2 * UNIT, hold=UNIT, start_hold=UNIT, start_setup=UNIT, stop_setup=UNIT, free=3 * UNIT
)


class I2cRig:
    """The controller, its partner and the edges of the wires.

    Rows of a diagram: SCL and SDA are the levels of the wires; scl and sda are what the partner drives (0 pulls low).
    """

    def __init__(
        self, stuck_after: int = 0, clear_after: int = 0, filter_width: int = 0, gives_up: bool = False
    ) -> None:
        self.kernel = Kernel()
        recorder = Recorder()
        self.marks: list[tuple[str, int]] = []
        recorder.subscribe([Kind.BUS], lambda record: self.marks.append((record.what, record.value)))
        self.wires = {name: Wire(self.kernel, name, recorder) for name in ("SCL", "SDA")}
        self.partner = {name.lower(): wire.attach("partner") for name, wire in self.wires.items()}
        self.edges: list[tuple[int, str, int]] = []
        for name, wire in self.wires.items():
            watch([wire], partial(self._edge, name))
        self.over: list[Transfer] = []
        self.stuck: list[tuple[int, str, list[str]]] = []
        self.controller = I2cController(
            self.kernel,
            recorder,
            self.wires["SCL"],
            self.wires["SDA"],
            replace(TIMING, filter=filter_width),
            stuck_after=stuck_after,
            clear_after=clear_after,
            gives_up=gives_up,
            on_stuck=lambda wire: self.stuck.append((self.kernel.now, wire.name, wire.held_by())),
        )

    def begin(self, *phases: Phase) -> Transfer:
        transfer = Transfer("test", list(phases))
        self.controller.begin(transfer, self.over.append)
        return transfer

    def pull(self, *moves: tuple[int, str, int]) -> None:
        """Schedule moves of the partner, which pulls or releases a line: (tick, line, level)."""
        for tick, line, level in moves:
            self.kernel.call_at(tick, partial(self.partner[line].drive, level))

    def _edge(self, name: str, tick: int, level: int) -> None:
        self.edges.append((tick, name, level))

    def drive(self, now: int, signal: str, level: int) -> None:
        self.pull((now, signal, level))

    def run_until(self, time: int) -> None:
        self.kernel.run_until(time)

    def show(self, signal: str) -> int:
        return self.wires[signal].level
