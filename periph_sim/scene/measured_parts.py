"""The parts of a scene that a measure can request, in addition to the records to which it subscribes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from ..timing.measures.measure import MeasuredScene
from . import parts

if TYPE_CHECKING:
    from ..devices.watchers import WireWatcher
    from ..f28335.i2c.options import I2cOptions
    from ..processor.dsp import Dsp
    from ..timing.measures.expectations import Expected, Reply, Unsolicited, WatchedWire
    from .bus_side import BusSide
    from .context import SceneContext, SceneWires
    from .serial.side import SerialSide


def measured_scene(
    context: SceneContext,
    wires: SceneWires,
    units: Mapping[str, Dsp],
    bus: BusSide,
    serial: SerialSide | None,
) -> MeasuredScene:
    """Return the values and functions of a scene that measures use. Measures call the functions."""

    def on_reply(reply: Reply) -> tuple[Expected, Callable[[], str]]:
        assert serial is not None
        return serial.on_reply(reply)

    def on_unsolicited(measure: Unsolicited) -> tuple[Callable[[tuple[int, ...]], str], Callable[[], str]]:
        assert serial is not None
        return serial.on_unsolicited(measure)

    def watcher(measure: WatchedWire) -> WireWatcher:
        return parts.watch.watcher_of(context.case, wires, context.timebase, context.start, measure)

    def value_of(place: str, name: str) -> int:
        unit, _, module = place.partition(".")
        if module not in units[unit].sockets:
            return parts.image_watching.variable_value(units[unit], name)
        socket = units[unit].sockets[module]
        chip = socket.chip
        register_name, _, field_name = name.partition(".")
        register = chip.MAP[register_name]
        cycle = units[unit].clock.cycle_at(context.kernel.now)
        touched = frozenset(chip.touched)
        value = socket.peek(cycle, register.offset)
        if register.width == 32:
            value |= socket.peek(cycle, register.offset + 1) << 16
        chip.touched.intersection_update(touched)  # a read by a measure does not count as a use of an option
        return register[field_name].extract(value)

    def clock_history(unit: str) -> list[tuple[int, Fraction]]:
        return units[unit or next(iter(units))].clock_history

    def i2c_release_delay(unit: str) -> Callable[[int], int]:
        dsp = units[unit]
        i2c = cast("I2cOptions", dsp.plan.options["i2c"])
        return parts.release_delay.ReleaseDelay(
            context.kernel, dsp.clock, dsp.sockets["I2C-A"], i2c, dsp.plan.system
        ).ticks

    return MeasuredScene(
        began=context.start,
        ticks_per_second=context.timebase.per_second,
        wire=wires.wire,
        value_of=value_of,
        clock_history=clock_history,
        i2c_release_delay=i2c_release_delay,
        rounds_at_start=lambda: bus.rounds.at_start,
        watcher=watcher,
        on_reply=on_reply,
        on_unsolicited=on_unsolicited,
    )
