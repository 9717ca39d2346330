"""The devices of a case on a bus, and a controller whose transfers are written like those of the I2C specification.

bus.do("50 W 00 1c 07 Sr 50 R 2")  ->  "50 00 1c 07 Sr 50 aa bb"      the bytes on the wires; ! is a NACK
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.transfer import BusTiming, Phase, Transfer
from periph_sim.scene.case.model import Case
from periph_sim.scene.case.origin import Source
from periph_sim.scene.scene import Scene

SECOND = 10**9  # ticks; a scene without units counts nanoseconds
FAST = BusTiming(low=1300, high=1200, hold=300, start_hold=600, start_setup=600, stop_setup=600, free=1300)  # 400 kHz


class Bus:
    """A bus with devices.

    folder: folder of the case. faults: its [[fault]] tables. device: its [device.NAME] tables.
    """

    def __init__(
        self,
        folder: Path | None = None,
        seed: int = 0,
        faults: tuple[dict[str, Any], ...] = (),
        **device: dict[str, Any],
    ) -> None:
        tables = {"name": "devices", "duration": "1 s", "seed": seed, "fault": faults, "device": device}
        case = Case.model_validate(tables)
        if folder is not None:
            case = case.from_source(Source(folder / "case.toml", ""))
        self.scene = Scene(case)
        self.kernel = self.scene.kernel
        wires = self.scene.wires
        self.controller = I2cController(self.kernel, self.scene.recorder, wires["SCL"], wires["SDA"], FAST)
        self.last = Transfer("", [])

    def do(self, text: str) -> str:
        """Make a transfer, run until its STOP, and return the bytes on the wires."""
        self.last = Transfer("test", [_phase(part) for part in text.split(" Sr ")])
        self.controller.begin(self.last, lambda done: self.kernel.stop())
        self.kernel.run_until(self.kernel.now + SECOND)
        return " Sr ".join(_bytes_on_wires(phase) for phase in self.last.phases if phase.start_at >= 0)

    def wait(self, ticks: int) -> None:
        self.kernel.run_until(self.kernel.now + ticks)

    def notes(self, name: str) -> list[str]:
        return [note.text for note in self.scene.devices[name].log.notes]


def _phase(text: str) -> Phase:
    address, way, *rest = text.split()
    if way == "R":
        return Phase(int(address, 16), True, count=int(rest[0]))
    return Phase(int(address, 16), False, bytes.fromhex("".join(rest)))


def _bytes_on_wires(phase: Phase) -> str:
    data = phase.got if phase.read else phase.data[: len(phase.acks)]
    acks = [True] * len(phase.got) if phase.read else phase.acks
    marks = [f"{byte:02x}{'' if ack else '!'}" for byte, ack in zip(data, acks, strict=True)]
    return " ".join([f"{phase.address:02x}{'' if phase.acked else '!'}", *marks])
