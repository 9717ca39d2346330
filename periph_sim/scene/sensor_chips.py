"""Puts the sensor chips of a case on a scene's bus: a `[chip.NAME]` table goes in, a chip behind its wires comes out.

ChipTable --> values --> Source --> chip <--> RegisterPointer <--> TargetSide <--> SCL, SDA
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any

from ..bus.i2c.target_side import TargetSide
from ..core.chip import Note
from ..core.kernel import Kernel
from ..core.options import options_from
from ..core.records import Kind, Recorder
from ..core.suggest import did_you_mean
from ..core.time import Timebase
from ..core.wire import Wire
from ..devices.chips.adxl345 import Adxl345, Adxl345Options
from ..devices.chips.hmc5883l import Hmc5883l, Hmc5883lOptions
from ..devices.chips.itg3200 import Itg3200, Itg3200Options
from ..devices.chips.register_chip import Source
from ..devices.chips.register_pointer import RegisterPointer
from ..devices.chips.sensed_values import held, numbered, scaled
from ..devices.host_pc import ramp
from .case.model import Case, ChipTable, ValueTable

Chip = Adxl345 | Itg3200 | Hmc5883l
MODELS: dict[str, tuple[type[Chip], type[Any]]] = {
    "adxl345": (Adxl345, Adxl345Options),
    "itg3200": (Itg3200, Itg3200Options),
    "hmc5883l": (Hmc5883l, Hmc5883lOptions),
}
PARTS = {"angles": slice(0, 3), "accelerations": slice(3, 6)}  # of a host frame


class ChipOnBus:
    """notes: each that the chip made, with the tick at which it came first and how often it came."""

    def __init__(self, kernel: Kernel, recorder: Recorder, name: str, chip: Chip) -> None:
        self.name = name
        self.chip = chip
        self.notes: dict[Note, list[int]] = {}
        self.on_note: Callable[[Note], None] | None = None
        self.pointer = RegisterPointer(chip, lambda: kernel.now, self._take_notes)
        self._kernel = kernel
        self._recorder = recorder
        self._take_notes()

    def attach(self, scl: Wire, sda: Wire, output_delay: int) -> TargetSide:
        """Put it on its wires."""
        return TargetSide(self._kernel, scl, sda, self.pointer.answer, output_delay, self.name)

    def _take_notes(self) -> None:
        notes = tuple(self.chip.notes)
        self.chip.notes.clear()
        for note in notes:
            first_and_count = self.notes.setdefault(note, [self._kernel.now, 0])
            first_and_count[1] += 1
            if self._recorder.wants(Kind.NOTE):
                text = f"{note.text} [{note.source}]"
                self._recorder.emit(self._kernel.now, Kind.NOTE, self.name, note.code, first_and_count[1], text)
            if self.on_note is not None:
                self.on_note(note)


def build_chip(
    case: Case,
    name: str,
    kernel: Kernel,
    recorder: Recorder,
    timebase: Timebase,
    source: Source | None,
) -> ChipOnBus:
    """The chip of `[chip.NAME]`, not yet on its wires. source: instead of the case's values. BadCase with its line."""
    table = case.chip[name]
    kind, options = MODELS[table.model]
    place = ("chip", name)
    if name in case.unit or name == "controller":
        raise case.mistake(f"{name!r} is another party on the wires already; give the chip another name", *place)
    address = kind.ADDRESSES[0] if table.address is None else table.address
    if address not in kind.ADDRESSES:
        can = " or ".join(f"{a:#04x}" for a in kind.ADDRESSES)
        raise case.mistake(f"{table.model} has no address {address:#04x}; it can have {can}", *place, "address")
    others = [other for other, chip in case.chip.items() if other != name and _address(chip) == address]
    if others:
        raise case.mistake(f"{others[0]} has the address {address:#04x} too", *place, "address")
    for key, value in table.options.items():
        try:
            options_from(options, {key: value})
        except ValueError as error:
            raise case.mistake(str(error), *place, "options", key) from None
    powered = kernel.now - timebase.ticks(table.powered, "nearest")
    chip = kind(timebase, lambda tick: (0, 0, 0), address, options_from(options, table.options), powered)
    for register, value in table.registers.items():
        if register not in chip.MAP:
            known = [r.name for r in chip.MAP]
            raise case.mistake(
                f"{table.model} has no register {register!r}; {did_you_mean(register, known)}",
                *place,
                "registers",
                register,
            )
        chip.write(powered, chip.MAP[register].offset, value)
    try:
        chip.source = source or _source(table.values, chip.lsb_per_unit, kernel.now, partial(_ticks, timebase))
    except ValueError as error:
        raise case.mistake(str(error), *place, "values") from None
    return ChipOnBus(kernel, recorder, name, chip)


def _ticks(timebase: Timebase, length: Fraction) -> int:
    return timebase.ticks(length, "nearest")


def _address(table: ChipTable) -> int:
    return MODELS[table.model][0].ADDRESSES[0] if table.address is None else table.address


def _source(table: ValueTable, lsb_per_unit: Fraction, start: int, ticks: Callable[[Fraction], int]) -> Source:
    """Times count from the start of the run."""
    if table.ramp is not None:
        part = PARTS[table.ramp]
        frames = numbered(start + ticks(table.first), ticks(table.period), lambda n: ramp(n)[part])
        return scaled(frames, lsb_per_unit)
    if table.fixed is not None:
        source = held([start], [table.fixed])
    else:
        source = held([start + ticks(time) for time, *_ in table.rows], [xyz for _, *xyz in table.rows])
    return scaled(source, lsb_per_unit) if table.unit == "LSB" else source
