"""Names of the registers that the transfers of a capture access, from the models of the devices on the bus.

    --chip 0x68=itg3200, --case CASE --> devices of a scene <-- bytes of each transfer, as captured
                                            |--> pointer, registers, fields, quantities

The bytes and ACKs are those of the capture. The devices receive them only to follow the pointer and the settings that
the controller writes. The scene never runs: its time advances only if a device is busy where the captured device
acknowledged.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import click
import numpy as np

from ...core.phrases import did_you_mean
from ...core.registers import NamedByte
from ...devices.chips import chip_models
from ...devices.targets import families
from ...scene import plugins
from ...scene.case.load import load
from ...scene.case.model import BadCase, Case
from ...scene.scene import Scene
from ...traces.capture.capture import Capture, gaps
from ...traces.decode.event_rows import ACK, ADDRESS, AGAIN, CUT, DATA, NACK, READ, START, STOP, WRITE, Rows
from .bulk_text import Numbers
from .command_frame import i2c_address_given
from .decode_buses import Bus

BUSY = 10**12  # in ticks; a time that is longer than any device is busy after a write
POINTER, QUANTITY = "pointer", " = "
AT_POWER_ON = "before its data; quantities are at the scale after power-on"
BEFORE_GAP = "since a gap; quantities are at the scale before the gap"


class NamedDevice:
    """A device that names the bytes of its transfers.

    device: the model of the device, an object with `addresses`, `answer` and `on_end`.
    label: the model, or the name of its table in the case.
    assumed: the end of a note. The note says which scale of quantities was assumed, because the capture shows no write
        to the registers before the quantities are read. "" if nothing was assumed.
    """

    def __init__(self, scene: Scene, device: Any, label: str) -> None:
        self.device = device
        self.label = label
        self.assumed = ""
        self._scale = AT_POWER_ON
        self._scene = scene
        self._pointed = False  # True if the register pointer is known, because the capture shows a write of it
        self._written = False

    def forget(self) -> None:
        """Regard the pointer and the settings as unknown, because they may have changed in a gap of the capture."""
        if self._written:
            self._scale = BEFORE_GAP
        self._pointed = self._written = False

    def phase(self, events: list[int], values: list[int], read: bool) -> list[tuple[int, NamedByte]]:
        """Return the names of the bytes of a message, each with the index of its event.

        events, values: the columns `event` and `value` of the rows of the message. The first row is the START, and the
            second row is the address.
        read: True if the controller reads.
        """
        byte = values[1] << 1 | read
        reply = self.device.answer(byte)
        if reply is None:
            self._scene.kernel.now += BUSY
            reply = self.device.answer(byte)
        named = [(1, NamedByte(self.label))]
        if hasattr(reply, "named"):
            data = [place for place, event in enumerate(events) if event == DATA]
            named += self._read(reply, data, values) if read else self._write(reply, data, values, events)
            self.device.on_end(events[-1] == STOP, CUT not in events)
        return named

    def _read(self, reply: Any, data: list[int], values: list[int]) -> list[tuple[int, NamedByte]]:
        named: list[tuple[int, NamedByte]] = []
        before: int | None = None
        for number, place in enumerate(data if self._pointed else ()):
            named.append((place, reply.named(values[place], before)))
            reply.send_byte(number)
            before = values[place]
        if not self._written and any(QUANTITY in one.meaning for _, one in named):
            self.assumed = self._scale
        return named

    def _write(self, reply: Any, data: list[int], values: list[int], events: list[int]) -> list[tuple[int, NamedByte]]:
        """Return the names of the bytes before the first one that the captured device or its model does not accept.

        That byte and later ones have no names, because a byte without ACK may have moved the register pointer or not.
        """
        named: list[tuple[int, NamedByte]] = []
        before: int | None = None
        for number, place in enumerate(data):
            is_pointer = number < reply.pointer_bytes
            one = None if is_pointer else reply.named(values[place], before)
            if events[place + 1 : place + 2] == [NACK] or not reply.receive_byte(number, values[place]):
                self._pointed = False
                break
            if one is None:
                self._pointed = number + 1 == reply.pointer_bytes
                one = NamedByte(POINTER, reply.named(0, None).register if self._pointed else "")
            else:
                before, self._written = values[place], True
            named.append((place, one))
        return named


class RegisterNames:
    """Names of the bytes on all I2C buses of a capture.

    texts: the names. The code of a name is its index in this list; code 0 means that there is no name.
    notes: sentences on assumptions.
    """

    def __init__(self, capture: Capture, buses: Sequence[Bus], chips: Sequence[str], case_file: Path | None) -> None:
        """Name the bytes on the I2C buses in `buses`.

        chips: the values of --chip.
        case_file: the value of --case; None if the option is not given.

        Raise ClickException for an invalid value, and BadCase for an invalid case.
        """
        self.texts = [NamedByte("")]
        self.notes: list[str] = []
        self._codes = {self.texts[0]: 0}
        self._known: dict[int, tuple[Numbers, Numbers]] = {}
        for number, bus in enumerate(buses):
            if bus.protocol == "i2c":
                resumed = [span.end for span in gaps(capture, *bus.lines)]
                self._known[number] = bus.rows.at, self._named(bus.rows, _devices(chips, case_file), resumed)

    def column(self, rows: Rows) -> Numbers:
        """Return, for each row, the code of the name of its byte; 0 if it has none."""
        codes = np.zeros(len(rows.at), np.int64)
        for bus, (at, named) in self._known.items():
            own = np.flatnonzero((rows.bus == bus) & (rows.value >= 0))
            codes[own] = named[np.searchsorted(at, rows.at[own])]
        return codes

    def _named(self, rows: Rows, devices: list[NamedDevice], resumed: list[int]) -> Numbers:
        """Return, for each row of a bus, the code of the name of its byte; 0 if it has none.

        If several devices have the same address, the first one in `devices` names the bytes.

        resumed: the positions at which gaps of the capture end.
        """
        codes = np.zeros(len(rows.at), np.int64)
        events, values, details = (column.tolist() for column in (rows.event, rows.value, rows.detail))
        by_address = {address: one for one in reversed(devices) for address in one.device.addresses}
        starts = np.flatnonzero((rows.event == START) | (rows.event == AGAIN)).tolist()
        for begin, end in pairwise([*starts, len(events)]):
            while resumed and rows.at[begin] >= resumed[0]:
                resumed.pop(0)
                for each in devices:
                    each.forget()
            device = by_address.get(values[begin + 1]) if events[begin + 1 : begin + 3] == [ADDRESS, ACK] else None
            if device is not None and details[begin + 1] in (WRITE, READ):
                own = events[begin:end], values[begin:end], details[begin + 1] == READ
                for place, one in device.phase(*own):
                    codes[begin + place] = self._code(one)
        self.notes += [
            f"{device.label}: no write to its registers {device.assumed}" for device in devices if device.assumed
        ]
        return codes

    def _code(self, named: NamedByte) -> int:
        code = self._codes.setdefault(named, len(self.texts))
        if code == len(self.texts):
            self.texts.append(named)
        return code


def _devices(chips: Sequence[str], case_file: Path | None) -> list[NamedDevice]:
    """Return the devices that --chip and --case name."""
    found = _of_chips(chips) if chips else []
    if case_file is not None:
        scene = Scene(load(case_file, ["strict=false"]))
        found += [NamedDevice(scene, device, name) for name, device in _on_bus(scene).items()]
    return found


def _of_chips(chips: Sequence[str]) -> list[NamedDevice]:
    """Return the devices that --chip names, in a scene that contains nothing else."""
    tables: dict[str, dict[str, object]] = {"chip": {}, "device": {}}
    models = {text: text.rpartition("=")[2] for text in chips}
    sensors = plugins.known(Path(), "CHIP", chip_models(), models.values())
    others = plugins.known(Path(), "MODELS", families(), models.values())
    for text, model in models.items():
        if model == "registers" or model.endswith(".py"):
            raise click.ClickException(f"--chip {text}: a case describes this device; name the case with --case")
        if model not in sensors and model not in others:
            hint = did_you_mean(model, [*sensors, *others])
            raise click.ClickException(f"--chip {text}: there is no chip {model!r}; {hint}")
        table: dict[str, object] = {"model": model}
        if "=" in text:
            table["address"] = i2c_address_given("--chip", text.rpartition("=")[0])
        if model in sensors:
            table["values"] = {"fixed": [0, 0, 0]}
        tables["chip" if model in sensors else "device"][text] = table
    try:
        scene = Scene(Case.model_validate({"name": "decode", "duration": "1 s", **tables}))
    except BadCase as error:
        raise click.ClickException(f"--chip: {str(error).rpartition(': ')[2]}") from None
    return [NamedDevice(scene, device, models[text]) for text, device in _on_bus(scene).items()]


def _on_bus(scene: Scene) -> dict[str, Any]:
    return {**scene.chips, **{name: device.target for name, device in scene.devices.items()}}
