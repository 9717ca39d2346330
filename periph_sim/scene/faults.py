"""The faults of a case: agents on the scene's wires, built from `[[fault]]` tables."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from random import Random

from ..bus.faults import FaultContext, FaultKind, Repeated, kinds
from ..core.kernel import Kernel
from ..core.phrases import did_you_mean
from ..core.sampler import watch
from ..core.state import State
from ..core.wire import Wire
from ..f28335.i2c.register_map import I2C_MAP
from ..processor.dsp import Dsp
from . import plugins
from .context import SceneContext
from .firmware_loader import BadSetting, filled

RESET = ".XRS"  # suffix in the name of the wire at a unit's reset pin
MODULE_RESET = ".IRS"  # suffix in the name of the wire that represents a unit's bit I2CMDR.IRS


def wire_of(context: SceneContext, known: dict[str, Wire], units: Mapping[str, Dsp], name: str) -> Wire:
    """Return the wire `name`, which a fault disturbs. Raise ValueError if there is no such wire.

    known: a dictionary from a name to a wire of the scene. A wire for the reset pin XRS or the bit IRS of a unit is
        made when a fault first names it, and added to this dictionary.
    """
    unit_name, _, _ = name.rpartition(".")
    if name not in known and name.endswith((RESET, MODULE_RESET)):
        if unit_name not in units:
            raise ValueError(f"there is no unit {unit_name!r}; {did_you_mean(unit_name, units)}")
        unit = units[unit_name]
        if name.endswith(RESET):
            known[name] = context.wire(name)
            unit.connect_reset(known[name])
        elif unit.has("I2C-A"):
            known[name] = context.wire(name)
            ModuleReset(context.kernel, unit, known[name])
        else:
            raise ValueError(f"unit {unit.plan.name} has no I2C-A that could be reset; add it to its modules")
    if name not in known:
        raise ValueError(f"there is no wire {name!r}; {did_you_mean(name, known)}")
    return known[name]


def build_faults(context: SceneContext, known: Mapping[str, Wire], units: Mapping[str, Dsp]) -> list[Repeated]:
    """Return an agent for each [[fault]] table. Raise BadCase for an invalid table."""
    wires = partial(wire_of, context, dict(known), units)
    faults: list[Repeated] = []
    for entry, table in enumerate(context.case.fault):
        given = dict(table)
        name = str(given.pop("kind", ""))
        kind = _kind(context, entry, name)
        who = f"fault {entry} ({name})"
        place = FaultContext(
            context.kernel, who, wires, context.ticks, context.start, Random(f"{context.case.seed} {who}")
        )
        try:
            faults.append(kind.attach(filled(kind.Settings, given, f"fault {name}"), place))
        except BadSetting as error:
            raise context.case.mistake(str(error), "fault", entry, *filter(None, [error.name])) from None
        except ValueError as error:
            raise context.case.mistake(str(error), "fault", entry) from None
    return faults


def _kind(context: SceneContext, entry: int, name: str) -> FaultKind:
    case = context.case
    found = plugins.known(case.folder, "attach", kinds(), [name] if name else ())
    if not name:
        raise case.mistake(f"it has no kind; the kinds are {', '.join(found)}", "fault", entry)
    if name not in found:
        raise case.unknown("fault", name, found, "fault", entry, "kind")
    return found[name]


I2CMDR = I2C_MAP["I2CMDR"]
IRS = I2CMDR["IRS"].mask


class ModuleReset:
    """Reset of a unit's I2C-A by a wire: a fall of the wire clears I2CMDR.IRS, and a rise restores the bit."""

    STATE = State("_was_on")

    def __init__(self, kernel: Kernel, unit: Dsp, wire: Wire) -> None:
        self._kernel = kernel
        self._clock = unit.clock
        self._socket = unit.sockets["I2C-A"]
        self._was_on: bool  # True if IRS was 1 at the last fall of the wire; not assigned before the first fall
        watch([wire], self._changed)

    def _changed(self, tick: int, level: int) -> None:
        """Schedule the write of I2CMDR.IRS for the first cycle at or after this edge of the wire."""
        cycle = self._clock.cycle_at(tick)
        self._kernel.call_at(self._clock.tick(cycle), partial(self._write, cycle, level))

    def _write(self, cycle: int, level: int) -> None:
        value = self._socket.peek(cycle, I2CMDR.offset)
        if not level:
            self._was_on = bool(value & IRS)
            self._socket.write(cycle, I2CMDR.offset, value & ~IRS)
        elif self._was_on:
            self._socket.write(cycle, I2CMDR.offset, value | IRS)
