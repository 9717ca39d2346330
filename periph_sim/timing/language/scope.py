"""Names that events can refer to: units, modules, registers and wires of a case or a recorded run.

    Case, RecordTable --> Scope --> where a record of a named thing comes from, or BadEvent with similar names

A scope accepts each name that a record of the run can have, even if the run has no such record. `RECORDS` lists the
things of derived records. The modules that make these records, in `timing/derived` and `scene/sci_monitor.py`, describe
their ticks and values.

    "record round missed" --> Kind.ROUND, "missed"; needs rounds in the scene
    "value of record data age" --> the value of the record is a time; there is one record for each read
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from ...core.phrases import did_you_mean
from ...core.records import Kind
from ...core.registers import Field, Register, RegisterMap
from ...f28335.parts.f28335 import PART

if TYPE_CHECKING:
    from ...processor.image_files.model import Image
    from ...processor.image_files.variables import Variable, Variables
    from ...traces.formats.record_table import RecordTable


class Thing(NamedTuple):
    """Properties of the derived records with one thing, such as "age".

    needs: what the scene must contain; one of the values of `Measure.needs`.
    unit: the unit of measurement of the record's value, as in `Measure.unit`.
    by_read: True if there is at most one record for each addressed phase, at its START.
    of: what an event may have after "of": "address" for an I2C address, which is the value of the record; "unit" for
        the F28335 that the record is about; "" for nothing.
    """

    needs: str
    unit: str = "value"
    by_read: bool = False
    of: str = ""


ON_BUS = Thing("I2C-A")
IN_ROUND = Thing("rounds")
AT_SCI = Thing("SCI")
OF_HOST = Thing("host")
BYTES = Thing("rounds", "bytes")
AGE = Thing("host", "time", by_read=True)
ERROR = Thing("host", "LSB", by_read=True)

RECORDS: dict[str, dict[str, Thing]] = {
    "transfer": {
        **dict.fromkeys(("phase", "read", "write end"), Thing("I2C-A", of="address")),
        **dict.fromkeys(("acknowledge", "answer", "refused"), ON_BUS),
        "stretch": Thing("I2C-A", "time", by_read=True),
        "held": Thing("I2C-A", "time"),
        **dict.fromkeys(("held alone", "unfinished"), Thing("I2C-A", "time", of="unit")),
    },
    "round": dict.fromkeys(("due", "missed", "begin", "end", "next", "refused"), IN_ROUND),
    "receiver": {**dict.fromkeys(("character", "received", "lost"), AT_SCI), "words": Thing("SCI", "words")},
    "data": {
        **dict.fromkeys(("bytes asked", "bytes compared", "wrong bytes", "zeros", "unknown bytes"), BYTES),
        **dict.fromkeys(("chip read", "unknown age", "model run", "sample", "unknown error"), OF_HOST),
        **dict.fromkeys(("age", "model age"), AGE),
        **dict.fromkeys(("value error", "value error at frame"), ERROR),
    },
    "bus": {"stuck": ON_BUS},
}


ADDRESS = re.compile(r"0x[0-9a-f]{6}")  # in place of the name of a function
MAPS: dict[str, RegisterMap] = {module.name: module.registers for module in PART.modules}
LINES = tuple(wire for module in PART.modules if module.plain for wire in module.wires)
WIRES = {module.name: tuple(module.wires) for module in PART.modules if module.bus or module.plain}
VECTORS: dict[str, tuple[str, ...]] = {
    module.name: tuple(interrupt.vector for interrupt in module.interrupts)
    for module in PART.modules
    if module.interrupts
}


class BadEvent(ValueError):
    """Error: a text names no event or measure, or an event that cannot happen in this scene.

    The message is one sentence.
    """


class ImageNames:
    """The names in an image. The image is read at the first query. A query for an unknown name raises ValueError."""

    def __init__(self, path: str) -> None:
        self._path = path

    @cached_property
    def _image(self) -> Image:
        from ...processor.image_files.program_file import program_in

        return program_in(Path(self._path))

    @cached_property
    def _variables(self) -> Variables:
        from ...processor.image_files.variables import Variables

        return Variables(self._image)

    @cached_property
    def _functions(self) -> tuple[str, ...]:
        from ...processor.image_files.debug_info import FunctionMap

        return tuple(function.name for function in FunctionMap(self._image).functions)

    def variable(self, name: str) -> Variable:
        return self._variables.find(name)

    def function(self, name: str) -> str:
        """Return `name` unchanged if it names a function, or is an address such as "0x3ff4a2".

        An address names code that belongs to no function, such as code in ROM. Raise ValueError for any other name.
        """
        if name not in self._functions and not ADDRESS.fullmatch(name):
            raise ValueError(f"the image has no function {name!r}; {did_you_mean(name, self._functions)}")
        return name


class Scope(Struct):
    """The parts of a scene that a measure may name.

    units: a dictionary from a unit to its modules.
    wires: the names of the wires.
    controller: True if the scene has a controller agent on its wires.
    host: True if the scene has a host on its wires.
    rounds: True if the requests of the controller's rounds are known, whichever party is the controller.
    lines: the wires that carry UART characters; if none are given, the wires in LINES that the scene has.
    pairs: the RS-485 pairs.
    images: for each unit that runs an image, the names in this image. If the image is not known, as in a recorded run,
        the entry is None, and every name is accepted.
    uncounted: a unit whose program does not report overflows of fixed-point arithmetic, because it is not Python
        firmware; "" if there is no such unit.
    measures: a dictionary from the name of a user's own measure to its text.
    """

    units: dict[str, tuple[str, ...]] = {}
    wires: tuple[str, ...] = ()
    controller: bool = False
    host: bool = False
    rounds: bool = False
    lines: tuple[str, ...] = ()
    pairs: tuple[str, ...] = ()
    images: Mapping[str, ImageNames | None] = {}
    uncounted: str = ""
    measures: Mapping[str, str] = {}

    def __post_init__(self) -> None:
        if not self.lines:
            self.lines = tuple(line for line in LINES if line in self.wires)

    @property
    def bus(self) -> bool:
        """True if there is an I2C bus, with any controller."""
        return self.controller or "SCL" in self.wires

    def wire(self, name: str) -> str:
        if name not in self.wires:
            raise BadEvent(f"there is no wire {name!r}; {did_you_mean(name, self.wires)}")
        return name

    def register(self, unit: str, text: str) -> tuple[str, str, Register]:
        """Return (unit, module, register) of a name such as "I2C-A.I2CDXR"."""
        parts = text.split(".")
        if len(parts) != 2:
            raise BadEvent(f"{text!r} is no register; write its module and its name, for instance I2C-A.I2CDXR")
        module, name = parts
        owner = self.owner(unit, module)
        registers = MAPS[module]
        if name not in registers:
            hint = did_you_mean(name, [r.name for r in registers.registers])
            raise BadEvent(f"{module} has no register {name!r}; {hint}")
        return owner, module, registers[name]

    def field(self, unit: str, text: str) -> tuple[str, str, Register, Field]:
        """Return (unit, module, register, field) of a name such as "I2C-A.I2CSTR.XRDY"."""
        parts = text.split(".")
        if len(parts) != 3:
            raise BadEvent(
                f"{text!r} is no field; write its module, its register and its name, for instance I2C-A.I2CSTR.XRDY"
            )
        owner, module, register = self.register(unit, text.rpartition(".")[0])
        _, name, wanted = parts
        if wanted not in register:
            raise BadEvent(f"{name} has no field {wanted!r}; {did_you_mean(wanted, [f.name for f in register.fields])}")
        return owner, module, register, register[wanted]

    def vector(self, unit: str, name: str) -> str:
        """Return `unit` if its CPU can take the interrupt `name`.

        If `unit` is "", return the only unit whose CPU can take the interrupt. Raise BadEvent if there is no such unit,
        or if `unit` is "" and there are several such units.
        """
        asked = [self.unit(unit)] if unit else list(self.units)
        having = {u: [v for m in self._modules(u) for v in VECTORS.get(m, ())] for u in asked}
        found = [u for u, vectors in having.items() if name in vectors]
        if not found:
            known = sorted({v for vectors in having.values() for v in vectors})
            raise BadEvent(f"nothing in the scene asks for the interrupt {name!r}; {did_you_mean(name, known)}")
        return self._one(found, name)

    def unit(self, name: str) -> str:
        """Return the unit of this name, or the only unit if `name` is empty."""
        if not name:
            return self._one(list(self.units), "it")
        if name not in self.units:
            raise BadEvent(f"there is no unit {name!r}; {did_you_mean(name, self.units)}")
        return name

    def owner(self, unit: str, module: str) -> str:
        """Return `unit` if it has the module. If `unit` is "", return the only unit that has the module.

        Raise BadEvent if there is no such unit, or if `unit` is "" and there are several such units.
        """
        if unit:
            if module not in self._modules(self.unit(unit)):
                raise BadEvent(f"{unit} has no module {module!r}; {did_you_mean(module, self._modules(unit))}")
            return unit
        having = [name for name in self.units if module in self._modules(name)]
        if not having:
            known = list(dict.fromkeys(m for name in self.units for m in self._modules(name)))
            raise BadEvent(f"the scene has no module {module!r}; {did_you_mean(module, known)}")
        return self._one(having, module)

    def image(self, unit: str) -> str:
        """Return `unit` if it runs an image. If `unit` is "", return the only unit that runs an image.

        Raise BadEvent if there is no such unit, or if `unit` is "" and there are several such units.
        """
        if unit and self.unit(unit) not in self.images:
            raise BadEvent(f"{unit} runs Python firmware; this measure needs a unit that runs an image")
        if not unit and not self.images:
            raise BadEvent("no unit runs an image, which this measure needs; give a unit image in place of firmware")
        return unit or self._one(list(self.images), "one")

    def variable(self, unit: str, name: str) -> str:
        """Return `unit`; if it is "", return the only unit that runs an image.

        Raise BadEvent if no such unit runs an image, if `unit` is "" and several units do, or if the image of the unit
        lacks the variable.
        """
        owner = self.image(unit)
        names = self.images[owner]
        try:
            if names is not None:
                names.variable(name)
        except ValueError as error:
            raise BadEvent(str(error)) from None
        return owner

    def span(self, unit: str, name: str) -> tuple[str, bool]:
        """Return the unit of a span, and True if the span is known to exist, because it is a function in an image.

        Raise BadEvent if the unit's image lacks the function. The spans of other firmware are not checked.
        """
        owner = self.unit(unit)
        names = self.images.get(owner)
        if names is None:
            return owner, False
        try:
            names.function(name)
        except ValueError as error:
            raise BadEvent(str(error)) from None
        return owner, True

    def places(self, unit: str) -> frozenset[str]:
        """Return the places of a unit's records: the unit and its modules. If `unit` is "", include all units."""
        named = [self.unit(unit)] if unit else list(self.units)
        return frozenset(place for u in named for place in (u, *(f"{u}.{m}" for m in self._modules(u))))

    def _modules(self, unit: str) -> tuple[str, ...]:
        return (*self.units[unit], *PART.in_every_unit)

    def _one(self, units: list[str], what: str) -> str:
        if not units:
            raise BadEvent("the scene has no unit")
        if len(units) > 1:
            raise BadEvent(f"{' and '.join(units)} have {what}; say whose is meant: {units[0]}: before the name")
        return units[0]


def scope_of_table(table: RecordTable) -> Scope:
    """Return the scope of a recorded run.

    `controller` and `rounds` are True if the run has a record of an event on the bus, and `host` if it has a record of
    a UART frame.
    """
    kinds = set(table.texts("kind", table.rows(Kind.BUS)[:1]) + table.texts("kind", table.rows(Kind.FRAME)[:1]))
    listed = [name for modules in table.modules.values() for name in modules]
    wires = [wire for module in listed for wire in WIRES.get(module, ())]
    wires += [name.removeprefix("pin:") for name in listed if name.startswith("pin:")]
    framed = table.texts("where", table.rows(Kind.FRAME))
    edges = table.columns["where"][table.rows(Kind.EDGE)]
    wires += [name for place, name in enumerate(table.names["where"]) if (edges == place).any()]
    units = {unit: tuple(m for m in modules if m in MAPS) for unit, modules in table.modules.items()}
    on_bus = Kind.BUS.value in kinds
    wires = list(dict.fromkeys(wires))
    lines = tuple(wire for wire in wires if wire in LINES or wire in framed)
    return Scope(units, tuple(wires), on_bus, Kind.FRAME.value in kinds, on_bus, lines, lines, dict.fromkeys(units))
