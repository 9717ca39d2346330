"""RS-485 transceivers of a case: which SCI is on which pair, and which pin enables its driver.

TX ---> DI  driver ----.
GPIO -> DE             +== pair
RX <--- RO  receiver --'
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from ...core.table import Table
from .wiring import Pin, SciLines, node_of, sci_named, wiring_of

if TYPE_CHECKING:
    from .model import Case


class TransceiverTable(Table, frozen=True, kw_only=True):
    """An RS-485 transceiver between an SCI and a pair of wires. de: the pin that switches its driver on.

    pull: the direction in which a resistor pulls the pin DE while the unit does not drive it.
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
    """Return every SCI with a transceiver. Raise BadCase, with its line, for an impossible transceiver."""
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
            what = f"{table.de} is a pin of {unit}, but {table.on} is of {sci.unit}, whose firmware turns it round"
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
    """Return the pin that enables the driver of a transceiver. Raise BadCase if it is not a pin of exactly one unit."""
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
    """Return the GPIO numbers of a unit that a resistor pulls low while they are not driven."""
    return frozenset(one.de for one in on_pairs(case) if one.sci.unit == unit and one.table.pull == "down")
