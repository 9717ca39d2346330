"""The wiring of a case: the wire of each pin, from its units, named pins and cables, and its transceivers.

    [unit.NAME] modules --> usual pins --.
    [unit.NAME] pins ------> names ------+--joined--> Wiring: GPIO number -> wire, for each unit
    [[cable]] -------------> joints -----'

All I2C-A modules are on one bus, SDA and SCL, unless `pins` names their pins. Each SCI has its own lines, which a cable
can join with other lines. If only one unit has an SCI-A, its lines are RX and TX. If only one unit has an SCI-B, its
lines are SCI-B.RX and SCI-B.TX. If several units have the module, the names begin with the unit, as in left.SCI-B.RX.
But if the case has a host, the RX pins of all SCI-A modules are on the host's line RX.

The wire of a cable has the name of the cable, or of an end that is a named pin or a wire. If there is no such name, the
wire has the full name of the pin at which the cable begins.

An RS-485 transceiver connects an SCI to a pair of wires; a pin of the unit enables its driver:

    TX ---> DI  driver ----.
    GPIO -> DE             +== pair
    RX <--- RO  receiver --'
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from msgspec import Struct, field

from ...core.phrases import did_you_mean
from ...core.table import Table
from ...f28335.parts.f28335 import PART

if TYPE_CHECKING:
    from .model import BadCase, Case


# SIGNALS maps each module to the GPIO numbers of its signals. Wires are built in this order, the I2C bus first, so
# simultaneous edges are also recorded in this order.
SIGNALS: dict[str, dict[str, int]] = {
    module.name: {name: module.pins[signal] for name, signal in module.wires.items()}
    for module in sorted(PART.modules, key=lambda one: not one.bus)
    if module.wires
}
SCIS = tuple(module for module in SIGNALS if "TX" in SIGNALS[module])
LAST_PIN = 87
GPIO = re.compile(r"GPIO(\d+)")

Pin = tuple[str, int]  # unit, GPIO number
Node = Pin | str  # a pin, or the name of a wire


class Cable(Table, frozen=True, kw_only=True):
    """A wire between two pins. An end is a module's pin (`left.SCI-A.TX`), a numbered pin (`left.GPIO34`), or a wire.

    name: wire name; if omitted, the name of an end that is a wire or has a name in `pins`, else the full name of `from`
    from: one end
    to: other end
    """

    name: str | None = None
    from_: str = field(name="from")
    to: str


class SciLines(Struct, frozen=True):
    """An SCI and the wires of its pins."""

    unit: str
    module: str
    rx: str
    tx: str


class Wiring(Struct, frozen=True):
    """The wiring of a case.

    pins: for each unit, a dictionary from a GPIO number to the name of its wire.
    scis: every SCI with its wires, unit by unit.
    """

    pins: Mapping[str, Mapping[int, str]]
    scis: list[SciLines]

    def wires(self) -> tuple[str, ...]:
        """Return the names of all wires that are connected to a pin of a unit."""
        return tuple(dict.fromkeys(wire for pins in self.pins.values() for wire in pins.values()))


def wiring_of(case: Case) -> Wiring:
    """Return the wiring of a case. Raise BadCase for an invalid cable, or an invalid `de` of a transceiver."""
    joints = _Joints()
    for unit, pin, name in _named(case):
        joints.join((unit, pin), name)
    for entry, cable in enumerate(case.cable):
        begin, end = (
            node_of(case, text, "cable", entry, key) for key, text in (("from", cable.from_), ("to", cable.to))
        )
        if begin == end:
            raise case.mistake(f"it joins {cable.to} with itself; a cable has two ends", "cable", entry)
        joints.join(begin, end)
        if cable.name is not None:
            joints.join(begin, cable.name)
        _check(case, entry, joints.group(begin))
    for entry, one in enumerate(case.transceiver):
        joints.group(node_of(case, one.de, "transceiver", entry, "de"))
    pins = {unit: {pin: _wire_of(case, joints, unit, pin) for pin in _pins(case, unit, joints)} for unit in case.unit}
    scis = [
        SciLines(name, module, *(pins[name][SIGNALS[module][signal]] for signal in ("RX", "TX")))
        for name, unit in case.unit.items()
        for module in SCIS
        if module in unit.modules
    ]
    return Wiring(pins, scis)


def sci_named(case: Case, text: str, *place: str | int) -> SciLines:
    """Return the SCI that a text names: "dsp.SCI-A", or "SCI-A" if only one unit has an SCI-A.

    Raise BadCase if the text does not name exactly one SCI.
    """
    lines = {(sci.unit, sci.module): sci for sci in wiring_of(case).scis}
    unit, _, module = text.rpartition(".")
    owners = [owner for owner, its in lines if its == module]
    if not unit and len(owners) == 1:
        unit = owners[0]
    if (unit, module) in lines:
        return lines[unit, module]
    if not unit and owners:
        what = f"{' and '.join(owners)} have {module}; say whose is meant: {owners[0]}.{module}"
    elif unit and unit not in case.unit:
        what = f"there is no unit {unit!r}; {did_you_mean(unit, case.unit)}"
    elif unit and module in SCIS:
        what = f"unit {unit} has no {module}; add it to its modules"
    else:
        known = [".".join(pair) for pair in lines]
        what = f"there is no SCI {text!r}; {did_you_mean(text, known) if known else 'no unit has one'}"
    raise case.mistake(what, *place)


def module_pins(case: Case, unit: str) -> Mapping[int, tuple[str, str]]:
    """Return (module, signal) by GPIO number, for the usual pins of the modules of a unit."""
    return _pins_of(tuple(case.unit[unit].modules))


@lru_cache(maxsize=64)  # units with the same modules share the result, which is read-only
def _pins_of(modules: tuple[str, ...]) -> Mapping[int, tuple[str, str]]:
    having = [module for module in SIGNALS if module in modules]
    return MappingProxyType({pin: (module, signal) for module in having for signal, pin in SIGNALS[module].items()})


def node_of(case: Case, text: str, *place: str | int) -> Node:
    """Return the pin or wire that a text, such as the end of a cable, names. Raise BadCase if it names neither."""
    unit, _, rest = text.partition(".")
    if unit not in case.unit:
        if text in _wire_names(case):
            return text
        owners = [name for name, one in case.unit.items() if unit in one.modules]
        if unit in SIGNALS and len(owners) == 1:
            return node_of(case, f"{owners[0]}.{text}", *place)
        if unit in SIGNALS and owners:
            what = f"{' and '.join(owners)} have {unit}; say whose is meant: {owners[0]}.{text}"
            raise case.mistake(what, *place)
        if not rest or (unit in SIGNALS and not owners):
            raise _no_pin(case, text, *place)
        raise case.unknown("unit", unit, case.unit, *place)
    gpio = GPIO.fullmatch(rest)
    if gpio:
        if int(gpio[1]) > LAST_PIN:
            raise case.mistake(f"{text}: the pins are GPIO0 to GPIO{LAST_PIN}", *place)
        return unit, int(gpio[1])
    module, _, signal = rest.partition(".")
    if module in SIGNALS and module not in case.unit[unit].modules:
        raise case.mistake(f"unit {unit} has no {module}; add it to its modules", *place)
    if module not in SIGNALS or signal not in SIGNALS[module]:
        raise _no_pin(case, text, *place)
    return unit, SIGNALS[module][signal]


def _no_pin(case: Case, text: str, *place: str | int) -> BadCase:
    known = [f"{unit}.{module}.{signal}" for unit in case.unit for module, signal in module_pins(case, unit).values()]
    known += [f"{unit}.GPIO0" for unit in list(case.unit)[:1]]
    return case.unknown("pin", text, [*known, *_wire_names(case)], *place)


def _wire_names(case: Case) -> list[str]:
    """Return the wire names at which a cable may end: those of named pins, of the bus, and of the host's line RX."""
    found = [label for unit in case.unit.values() for label in unit.pins]
    if case.controller is not None or case.chip or any("I2C-A" in unit.modules for unit in case.unit.values()):
        found += SIGNALS["I2C-A"]
    return [*dict.fromkeys(found), *(["RX"] if case.rx_sender else [])]


def _named(case: Case) -> Iterator[tuple[str, int, str]]:
    """Yield (unit, GPIO number, name of the wire) for each pin on the I2C bus and each pin in a unit's key `pins`."""
    for unit, table in case.unit.items():
        if "I2C-A" in table.modules:
            yield from (
                (unit, pin, signal) for signal, pin in SIGNALS["I2C-A"].items() if pin not in table.pins.values()
            )
        yield from ((unit, pin, label) for label, pin in table.pins.items())


class _Joints:
    """Groups of pins and wire names. The members of a group are on one wire."""

    def __init__(self) -> None:
        self._groups: dict[Node, list[Node]] = {}

    def group(self, node: Node) -> list[Node]:
        return self._groups.setdefault(node, [node])

    def join(self, one: Node, other: Node) -> None:
        first, second = self.group(one), self.group(other)
        if first is not second:
            first += second
            self._groups.update((node, first) for node in second)

    def nodes(self) -> list[Node]:
        return list(self._groups)


def _check(case: Case, entry: int, group: list[Node]) -> None:
    """Raise BadCase if a cable makes a wire with two names, or a wire that two transmitters drive.

    entry: the index of the cable. group: the pins and names on the wire of the cable.
    """
    names = [node for node in group if isinstance(node, str)]
    if len(names) > 1:
        what = f"it joins {' and '.join(names)}, two names of one wire; give it one"
        raise case.mistake(what, "cable", entry)
    pins = [node for node in group if isinstance(node, tuple)]
    drivers = sorted(
        f"{unit}.{module}.TX"
        for unit, pin in pins
        for module, signal in [module_pins(case, unit).get(pin, ("", ""))]
        if signal == "TX"
    )
    if case.rx_sender and "RX" in names:
        drivers.append(case.rx_sender)
    if len(drivers) > 1:
        what = f"{' and '.join(drivers)} would drive one wire; give each of them a wire, or a transceiver to share one"
        raise case.mistake(what, "cable", entry)


def _pins(case: Case, unit: str, joints: _Joints) -> list[int]:
    """Return the pins of a unit that have a wire.

    These are the usual pins of its modules, named pins, and pins with a cable or the `de` of a transceiver.
    """
    cabled = [node[1] for node in joints.nodes() if isinstance(node, tuple) and node[0] == unit]
    return list(dict.fromkeys([*module_pins(case, unit), *case.unit[unit].pins.values(), *cabled]))


def _wire_of(case: Case, joints: _Joints, unit: str, pin: int) -> str:
    """Return the name of the wire at a pin."""
    group = joints.group((unit, pin))
    named = [other for other in group if isinstance(other, str)]
    if named:
        return named[0]
    for entry, cable in enumerate(case.cable):
        begin = node_of(case, cable.from_, "cable", entry, "from")
        if begin in group and isinstance(begin, tuple):
            return _full_name(case, *begin)
    module, signal = module_pins(case, unit).get(pin, ("", ""))
    if not module:
        return _full_name(case, unit, pin)
    alone = sum(module in one.modules for one in case.unit.values()) == 1
    if PART.by_name[module].plain and (alone or (signal == "RX" and case.rx_sender)):
        return signal
    return f"{module}.{signal}" if alone else f"{unit}.{module}.{signal}"


def _full_name(case: Case, unit: str, pin: int) -> str:
    """Return the full name of a pin, such as "dsp.SCI-A.TX" or "dsp.GPIO34"."""
    module, signal = module_pins(case, unit).get(pin, ("", ""))
    return f"{unit}.{module}.{signal}" if module else f"{unit}.GPIO{pin}"


class TransceiverTable(Table, frozen=True, kw_only=True):
    """A half-duplex RS-485 transceiver at an SCI.

    on: the SCI, `"dsp.SCI-A"`
    de: driver-enable pin, `"dsp.GPIO34"` or a name in `pins`; needs module GPIO
    pair: name of the pair
    hears_itself: `true`: the receiver stays on while driving
    pull: resistor at `de`: `"down"` or `"up"`
    """

    on: str
    de: str
    pair: str = "RS485"
    hears_itself: bool = False
    pull: Literal["down", "up"] = "down"


class OnPair(Struct, frozen=True):
    """An SCI with a transceiver. de: the GPIO number of the driver enable pin. de_wire: the name of its wire."""

    table: TransceiverTable
    sci: SciLines
    de: int
    de_wire: str


def on_pairs(case: Case) -> list[OnPair]:
    """Return every SCI with a transceiver. Raise BadCase for an invalid transceiver."""
    if not case.transceiver:
        return []
    wiring = wiring_of(case)
    found: list[OnPair] = []
    for entry, table in enumerate(case.transceiver):
        sci = sci_named(case, table.on, "transceiver", entry, "on")
        if any(one.sci == sci for one in found):
            raise case.mistake(f"{table.on} has a transceiver already; an SCI has one", "transceiver", entry, "on")
        unit, pin = de_pin(case, entry)
        if unit != sci.unit:
            what = f"{table.de} is a pin of {unit}, but {table.on} is of {sci.unit}, whose firmware switches it"
            raise case.mistake(what, "transceiver", entry, "de")
        if "GPIO" not in case.unit[unit].modules:
            what = f"unit {unit} has no GPIO, which would drive {table.de}; add it to its modules"
            raise case.mistake(what, "transceiver", entry, "de")
        others = [f"{one.unit}.{one.module}.TX" for one in wiring.scis if one.tx == sci.rx]
        others += [case.rx_sender] if case.rx_sender and sci.rx == "RX" else []
        if others:
            what = f"{others[0]} drives the RX of {table.on} already, which the transceiver would drive, too"
            raise case.mistake(what, "transceiver", entry, "on")
        if table.pair in wiring.wires():
            what = f"{table.pair} is a wire already; give the pair another name"
            raise case.mistake(what, "transceiver", entry, "pair")
        found.append(OnPair(table, sci, pin, wiring.pins[unit][pin]))
    return found


def de_pin(case: Case, entry: int) -> Pin:
    """Return the pin that enables the driver of a transceiver.

    entry: the index of the transceiver. Raise BadCase if its key `de` does not name a pin of exactly one unit.
    """
    text = case.transceiver[entry].de
    node = node_of(case, text, "transceiver", entry, "de")
    if isinstance(node, tuple):
        return node
    owners = [(unit, table.pins[node]) for unit, table in case.unit.items() if node in table.pins]
    if len(owners) != 1:
        what = f"{text} is no pin of one unit; give a GPIO of the unit, for instance dsp.GPIO34"
        raise case.mistake(what, "transceiver", entry, "de")
    return owners[0]


def pulled_down(case: Case, unit: str) -> frozenset[int]:
    """Return the GPIO numbers of the driver-enable pins of a unit that have a pull-down resistor."""
    return frozenset(one.de for one in on_pairs(case) if one.sci.unit == unit and one.table.pull == "down")
