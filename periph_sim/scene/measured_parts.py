"""The parts of a scene that a measure can request, in addition to the records to which it subscribes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from . import parts

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..devices.watchers import WireWatcher
    from ..f28335.i2c.options import I2cOptions
    from ..processor.dsp import Dsp
    from ..timing.measures.expectations import Expected, Reply, Unsolicited, WatchedWire
    from .bus_side import BusSide
    from .context import SceneContext, SceneWires
    from .serial.side import SerialSide


class MeasuredParts:
    """The parts of a scene that measures use; see `timing.measures.measure.MeasuredScene`."""

    def __init__(
        self,
        context: SceneContext,
        wires: SceneWires,
        units: Mapping[str, Dsp],
        bus: BusSide,
        serial: SerialSide | None,
    ) -> None:
        self._context = context
        self._wires = wires
        self._units = units
        self._bus = bus
        self._serial = serial

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        assert self._serial is not None
        return self._serial.on_reply(reply)

    def on_unsolicited(self, measure: Unsolicited) -> tuple[Callable[[tuple[int, ...]], str], Callable[[], str]]:
        assert self._serial is not None
        return self._serial.on_unsolicited(measure)

    def watcher(self, measure: WatchedWire) -> WireWatcher:
        context = self._context
        return parts.watch.watcher_of(context.case, self._wires, context.timebase, context.start, measure)

    def rounds_at_start(self) -> Callable[[], bool]:
        return self._bus.rounds.at_start

    def began(self) -> int:
        return self._context.start

    def wire(self, name: str) -> Wire:
        return self._wires.wire(name)

    def value_of(self, place: str, name: str) -> int:
        unit, _, module = place.partition(".")
        if module not in self._units[unit].sockets:
            return parts.image_watching.variable_value(self._units[unit], name)
        socket = self._units[unit].sockets[module]
        chip = socket.chip
        register_name, _, field_name = name.partition(".")
        register = chip.MAP[register_name]
        cycle = self._units[unit].clock.cycle_at(self._context.kernel.now)
        touched = frozenset(chip.touched)
        value = socket.peek(cycle, register.offset)
        if register.width == 32:
            value |= socket.peek(cycle, register.offset + 1) << 16
        chip.touched.intersection_update(touched)  # a read by a measure does not count as a use of an option
        return register[field_name].extract(value)

    def ticks_per_second(self) -> int:
        return self._context.timebase.per_second

    def clock_history(self, unit: str) -> list[tuple[int, Fraction]]:
        return self._units[unit or next(iter(self._units))].clock_history

    def i2c_release_delay(self, unit: str) -> Callable[[int], int]:
        dsp = self._units[unit]
        i2c = cast("I2cOptions", dsp.plan.options["i2c"])
        return parts.release_delay.ReleaseDelay(
            self._context.kernel, dsp.clock, dsp.sockets["I2C-A"], i2c, dsp.plan.system
        ).ticks
