"""The sensor chips of a case on a scene's bus, connected to SCL and SDA, one for each `[chip.NAME]` table.

ChipTable --> values --> Source --> chip <--> RegisterPointer <--> TargetSide <--> SCL, SDA
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from ..core.phrases import did_you_mean
from ..core.state import State
from ..devices.chips import chip_models
from ..devices.chips.register_chip import RegisterChip, Source
from ..devices.chips.sensed_values import held, numbered, scaled
from ..devices.host_frames import host_frames
from ..devices.register_pointer import RegisterPointer
from ..processor.user_code import UserCode
from . import plugins
from .case.error_text import checked_options
from .case.party_tables import ValueTable
from .context import SceneContext
from .devices import NoteLog, check_name, take_addresses


class ChipOnBus:
    """A sensor chip on the bus. chip: the simulated chip with its registers. log: the notes of the chip."""

    STATE = State("pointer log")

    def __init__(self, context: SceneContext, name: str, make: Callable[[int], RegisterChip], powered: int) -> None:
        """Make the chip.

        make: a function that takes the tick at which the chip's supply is switched on, and returns a new chip.
        powered: the tick at which the supply is switched on for the first time; it can be before the run.
        """
        self.log = NoteLog(context, name)
        self._kernel = context.kernel
        self._make = make
        self.pointer = RegisterPointer(make(powered), lambda: context.kernel.now, self.take_notes)

    @property
    def chip(self) -> RegisterChip:
        return self.pointer.chip

    @property
    def addresses(self) -> tuple[int, ...]:
        return (self.chip.address,)

    def answer(self, address_byte: int) -> RegisterPointer | None:
        return self.pointer.answer(address_byte)

    def on_end(self, stop: bool, whole: bool) -> None:
        """Do nothing, because a chip with registers does not react to the end of a transfer."""

    def power_on(self) -> None:
        """Replace the chip by a new chip whose supply is switched on now, so that its registers have reset values."""
        self.pointer.chip = self._make(self._kernel.now)

    def take_notes(self) -> None:
        """Log the notes that the chip has made since the last call."""
        notes = tuple(self.chip.notes)
        self.chip.notes.clear()
        for note in notes:
            self.log.take(note)


def build_chip(context: SceneContext, name: str, source: Source | None, taken: dict[int, str]) -> ChipOnBus:
    """Return the chip of `[chip.NAME]`, which is not connected to wires yet.

    source: the input of the chip; None if the key `values` in the case is the input. taken: see `take_addresses`.

    Raise BadCase for an invalid chip, or for one whose name or address another party has.
    """
    case, timebase = context.case, context.timebase
    table = case.chip[name]
    place = ("chip", name)
    models = plugins.known(case.folder, "CHIP", chip_models(), [table.model])
    if table.model not in models:
        raise case.unknown("chip", table.model, models, *place, "model")
    kind: type[Any] = models[table.model]
    check_name(case, "chip", name)
    address = kind.ADDRESSES[0] if table.address is None else table.address
    if address not in kind.ADDRESSES:
        can = " or ".join(f"{a:#04x}" for a in kind.ADDRESSES)
        raise case.mistake(f"{table.model} has no address {address:#04x}; it can have {can}", *place, "address")
    take_addresses(case, "chip", name, [address], taken)
    answers = checked_options(case, kind.OPTIONS, table.options, *place, "options")
    guard = UserCode(f"chip {name}", float(case.stall_limit))
    sensed: Source  # assigned below, because the source depends on the scale that `registers` sets

    def make(powered: int) -> RegisterChip:
        chip: RegisterChip = guard(kind, timebase, lambda tick: sensed(tick), address, answers, powered)
        return chip

    powered = context.kernel.now - context.ticks(table.powered)
    on_bus = ChipOnBus(context, name, make, powered)
    chip = on_bus.chip
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
        sensed = source or _source(table.values, chip.lsb_per_unit, context.kernel.now, context.ticks)
    except ValueError as error:
        raise case.mistake(str(error), *place, "values") from None
    on_bus.take_notes()
    return on_bus


def _source(table: ValueTable, lsb_per_unit: Fraction, start: int, ticks: Callable[[Fraction], int]) -> Source:
    """Return a chip's input as a function from a tick to x, y and z in the chip's physical unit.

    table: the input in the case; its times count from the tick `start`.
    lsb_per_unit: the number of LSB in one physical unit, for input that is in LSB.
    """
    if table.ramp is not None:
        sent = host_frames()
        part = sent.PARTS[table.ramp]
        frames = numbered(start + ticks(table.first), ticks(table.period), lambda n: sent.ramp(n)[part])
        return scaled(frames, lsb_per_unit)
    if table.fixed is not None:
        source = held([start], [table.fixed])
    else:
        source = held([start + ticks(time) for time, *_ in table.rows], [xyz for _, *xyz in table.rows])
    return scaled(source, lsb_per_unit) if table.unit == "LSB" else source
