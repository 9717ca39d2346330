"""The timeline around a worst occurrence: lanes with events in ticks, from a Window, as compact JSON for the page.

edges     --decoder--> SCL, SDA, bytes; RX, TX; other wires; rows of the protocol table
BUS -------------------> transfers of the controller
FRAME -----------------> characters on serial lines, and their bits
FLAG      -----------> one lane per register field that changed
SPAN, WAIT, IRQ ------> spans of firmware, its waits with the polled field, service routines
ACCESS    -----------> one lane per register: reads and writes with their firmware location

At first, the page draws only the chosen lanes. These are the lanes of wires and registers that the explanation names;
the wires of a bus that the explanation mentions (SCL and SDA for a transfer, RX and TX for a frame); fields that the
explanation or the measure names; and service routines, spans, waits and notes in the part that is visible at first.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

from ....core.records import Kind, Record
from ....records.record_text import happened, number
from ....records.register_maps import register_of
from ....traces.decode import i2c
from ..explain.characters import characters
from ..explain.cpu_activity import all_episodes, polled
from ..explain.picture import flags_shown, within_reach
from ..explain.window import Window
from .protocol import Row, bytes_of, rows

BUS_WORDS = re.compile(r"\b(SCL|SDA|START|STOP|N?ACK|acknowledged|transfer|byte \d+)\b")
SERIAL_WORDS = re.compile(r"\b(RX|TX|SCI\w*|frames?|host|FIFO)\b")
BUS = ("SCL", "SDA")
SERIAL = ("RX", "TX")
MOST = 24_000  # maximum number of events of a timeline; events farther from the occurrence are left out
MOST_BITS = 60  # the bits of characters are drawn at first only if the picture is shorter than this number of bits
BITS = {"S": "start bit", "A": "address bit", "P": "parity bit", "T": "stop bit"}
EPISODES = (("span", "span"), ("wait", "waits for"), ("interrupt", "service routine of"))
OPTIONAL = ("chosen", "long", "labels", "strong", "places")  # keys of a lane that are left out if they are empty


class Texts(dict[str, int]):
    """A dictionary from texts to indices. In JSON, each text is stored once."""

    def place(self, text: str) -> int:
        return self.setdefault(text, len(self))


@dataclass
class Lane:
    """A lane of events.

    kind: "wave" for edges, "boxes" for events with a duration in the order in which they begin, "marks" for instants.
    unit: the unit to which the lane belongs; "" if it belongs to none.
    initial: the level of a wave before the first edge.
    chosen: True if the explanation is about the lane. At first, only chosen lanes are drawn.
    at, end: the ticks of the events. Only boxes have an end.
    says, labels: the text and the label of each event. The first line of a text is its title. Edges have no label.
    strong: 1 for each event that is drawn as more important, such as a write among reads or a wrong byte; 0 for the
        others; empty if the lane has no such events.
    places: the location of each mark in the firmware; empty if the locations are unknown.
    """

    kind: str
    name: str
    unit: str = ""
    initial: int = 0
    chosen: bool = False
    at: list[int] = field(default_factory=list)
    end: list[int] = field(default_factory=list)
    says: list[str] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    strong: list[int] = field(default_factory=list)
    places: list[str] = field(default_factory=list)

    def json(self, texts: Texts) -> dict[str, Any]:
        """Convert to JSON. A tick is given as the distance from the previous tick, so most numbers are short.

        texts: the texts of all lanes. A text is given as its index.
        """
        keys: dict[str, Any] = {"name": self.name, "unit": self.unit, "chosen": int(self.chosen), "kind": self.kind}
        keys |= {"initial": self.initial} if self.kind == "wave" else {}
        keys |= {
            "at": [tick - before for before, tick in pairwise([0, *self.at])],
            "long": [end - at for at, end in zip(self.at, self.end, strict=False)],
            "labels": [*map(texts.place, self.labels)],
            "says": [*map(texts.place, self.says)],
            "strong": self.strong if any(self.strong) else [],
            "places": [*map(texts.place, self.places)],
        }
        return {key: value for key, value in keys.items() if value or key not in OPTIONAL}


@dataclass(frozen=True)
class Timeline:
    """The timeline around one worst occurrence.

    origin: the tick of time 0, counted from the start of the run. All other ticks are relative to the origin.
    begin, end: the start and the end of the occurrence.
    per_second: the number of ticks per second.
    cycles: a dictionary from units to ticks per SYSCLKOUT cycle. Lanes without a unit use the value of the first unit.
    shown: the range of ticks that is visible at first.
    kept: the one or two ranges of ticks whose records were kept.
    groups: name and lanes of each group.
    rows: the rows of the protocol table, in time order.
    """

    origin: int
    begin: int
    end: int
    per_second: int
    cycles: dict[str, float]
    shown: tuple[int, int]
    kept: tuple[tuple[int, int], ...]
    groups: tuple[tuple[str, tuple[Lane, ...]], ...]
    rows: tuple[Row, ...] = ()

    def json(self) -> dict[str, Any]:
        texts = Texts()
        groups = [{"name": name, "lanes": [lane.json(texts) for lane in lanes]} for name, lanes in self.groups]
        return {
            "origin": str(self.origin),  # as text, since the number may be too large for JavaScript
            "begin": self.begin,
            "end": self.end,
            "perSecond": self.per_second,
            "cycles": self.cycles,
            "shown": self.shown,
            "kept": self.kept,
            "groups": groups,
            "says": list(texts),
            "rows": self.rows,
        }


def only_chosen(timeline: Timeline) -> Timeline:
    """Return the timeline with only the lanes whose `chosen` is True, and without groups that become empty."""
    groups = ((name, tuple(lane for lane in lanes if lane.chosen)) for name, lanes in timeline.groups)
    return replace(timeline, groups=tuple(one for one in groups if one[1]))


@dataclass
class Lanes:
    """Builder of the timeline of a window.

    cycles: a dictionary from units to ticks per cycle of SYSCLKOUT.
    most: the maximum number of records that the timeline shows.
    """

    window: Window
    cycles: dict[str, float]
    most: int

    def __post_init__(self) -> None:
        self.kept = within_reach(self.window, self.most)
        self.about = "\n".join((self.window.verdict.measure, *self.window.chain_texts))
        self.about_serial = bool(SERIAL_WORDS.search(self.about))
        self.about_bus = bool(BUS_WORDS.search(self.about)) or not (self.about_serial or self.window.chain_texts)
        self.chosen_flags = set(flags_shown(self.window))
        self.records = [r for r in self.window.records if any(k.begin <= r.tick < k.end for k in self.kept)]
        early = [r for r in self.window.records if r.tick < self.kept[0].begin]
        self.before = {r[2:5]: r for r in (*self.window.before, *early)}
        self.zero = self.window.at
        self.serial = list(dict.fromkeys((*SERIAL, *self.window.formats)))

    def timeline(self) -> Timeline:
        window = self.window
        names = [channel.name for channel in window.edges.channels]
        pins = self._waves(name for name in names if name not in (*BUS, *self.serial))
        groups = [("I2C bus", self._bus()), ("UART", self._serial()), ("pins", pins)]
        for unit in self.cycles:
            prefix = f"{unit} " if len(self.cycles) > 1 else ""
            groups.append((f"{prefix}flags", self._flags(unit)))
            groups.append((f"{prefix}firmware", self._firmware(unit)))
            groups.append((f"{prefix}accesses", self._accesses(unit)))
        groups.append(("notes", self._notes()))
        return Timeline(
            origin=self.zero - window.start,
            begin=window.begin - self.zero,
            end=window.end - self.zero,
            per_second=window.timebase.per_second,
            cycles=self.cycles,
            shown=(window.drawn.begin - self.zero, window.drawn.end - 1 - self.zero),
            kept=tuple((span.begin - self.zero, span.end - 1 - self.zero) for span in self.kept),
            groups=tuple((name, tuple(lanes)) for name, lanes in groups if lanes),
            rows=tuple(rows(window, self._seen, self.zero)),
        )

    def add(
        self, lane: Lane, begin: int, says: str, label: str = "", end: int | None = None, strong: int | None = None
    ) -> None:
        """Add an event to a lane.

        begin, end: the ticks of the event in the run; `end` is None for an instant.
        says, label: the text and the label of the event.
        strong: 1 to draw the event as more important than the others, else 0; None in a lane without such events.
        """
        lane.at.append(begin - self.zero)
        lane.says.append(says)
        if lane.kind != "wave":
            lane.labels.append(label)
        if end is not None:
            lane.end.append(max(end, begin) - self.zero)
        if strong is not None:
            lane.strong.append(strong)

    def _add_edges(self, lane: Lane, records: Iterable[Record], about: Callable[[Record], str]) -> Lane:
        """Add an edge for each record at which the level of a wave changes.

        about: a function that returns a text, which is appended to the text of a record.
        """
        level = lane.initial
        for record in records:
            if record.value != level:
                level = record.value
                self.add(lane, record.tick, f"{happened(record)}{about(record)}")
        return lane

    # Lines --------------------------------------------------------------------------

    def _waves(self, wires: Iterable[str]) -> list[Lane]:
        """Return a wave for each of these wires that exists and has a known level."""
        lanes = []
        for channel in (channel for wire in wires for channel in self.window.edges.channels if channel.name == wire):
            wire = channel.name
            first = self.before.get((Kind.EDGE, wire, "level"))
            edges = [r for r in self.records if r.kind is Kind.EDGE and r.where == wire]
            if edges or first is not None or len(channel.edges):
                initial = first.value if first is not None else edges[0].value ^ 1 if edges else channel.initial
                drawn = (wire in BUS and self.about_bus) or (wire in self.serial and self.about_serial)
                wave = Lane("wave", wire, initial=initial, chosen=drawn or self._named(wire))
                lanes.append(self._add_edges(wave, edges, lambda record: ""))
        return lanes

    def _bus(self) -> list[Lane]:
        wires = self._waves(BUS)
        if len(wires) < len(BUS):
            return wires
        lane = Lane("boxes", "bytes", chosen=self.about_bus)
        transfers = i2c.transfers(self.window.edges)
        for begin, end, label, says, wrong in bytes_of(transfers, self.kept[-1].end, self.window.expected_on_bus):
            if self._seen(begin, end):
                self.add(lane, begin, says, label, end, int(wrong))
        return [*wires, lane, *self._transfers()]

    def _transfers(self) -> list[Lane]:
        """Return a lane with the controller's transfers, if there are any."""
        lane = Lane("boxes", "transfer", chosen=self.about_bus)
        began: Record | None = None
        records = [r for r in sorted(self.before.values(), key=lambda r: r.tick) if r.kind is Kind.BUS]
        records += [r for r in self.records if r.kind is Kind.BUS]
        ends = [(r, r.tick, r.what) for r in records if r.what in ("START", "STOP", "arbitration lost")]
        for record, end, how in [*ends, (None, self.kept[-1].end, "continues after the recorded range")]:
            if how == "START":
                began = record
            elif began is not None:
                if self._seen(began.tick, end):
                    self.add(lane, began.tick, f"{began.where}: {began.text}\nfrom START to {how}", began.text, end)
                began = None
        return [lane] if lane.at else []

    def _serial(self) -> list[Lane]:
        """Return for each serial line its wave, its characters and their bits."""
        lanes = []
        for wave in self._waves(self.serial):
            whole = Lane("boxes", f"{wave.name} bytes", chosen=wave.chosen)
            bits = Lane("boxes", f"{wave.name} bits", chosen=wave.chosen)
            for one in (one for one in characters(self.window) if one.wire == wave.name):
                if self._seen(one.begin, one.end):
                    wrong = "\nwith a wrong parity or stop bit" if one.error else ""
                    says = f"character {one.text}{wrong}"
                    for begin, end, text in one.parts():
                        strong = int(text == one.text and (one.error or one.expected is not None))
                        self.add(whole, begin, says, text, end, strong)
                    for begin, end, text in one.bits:
                        self.add(bits, begin, BITS.get(text, f"data bit {text}"), text, end)
            reach = self.window.drawn.end - self.window.drawn.begin
            bits.chosen &= bool(bits.at) and reach < MOST_BITS * (bits.end[0] - bits.at[0])
            lanes += [wave, *(lane for lane in (whole, bits) if lane.at)]
        return lanes

    # Modules and firmware of a unit ---------------------------------------------------

    def _flags(self, unit: str) -> list[Lane]:
        changes: dict[tuple[str, str], list[Record]] = {}
        for record in self.records:
            if record.kind is Kind.FLAG and record.where.partition(".")[0] == unit:
                changes.setdefault((record.where.partition(".")[2], record.what), []).append(record)
        return [self._flag(unit, module, what, of) for (module, what), of in changes.items()]

    def _flag(self, unit: str, module: str, what: str, changes: list[Record]) -> Lane:
        register, _, field_name = what.partition(".")  # the name of a variable may have several dots or none
        of = register_of(module, register)
        known = of[field_name] if of is not None and field_name in of else None
        before = self.before.get(changes[0][2:5])
        initial = before.value if before is not None else known.reset if known is not None else 0
        about = f"\n{known.doc} [{of.source}]" if of is not None and known is not None and known.doc else ""
        kind = "wave" if known is not None and known.msb == known.lsb else "boxes"
        lane = Lane(kind, what, unit, initial, chosen=changes[0][3:5] in self.chosen_flags)
        if kind == "wave":
            return self._add_edges(lane, changes, lambda record: f"{self._because(record)}{about}")
        first = changes[0]._replace(tick=self.kept[0].begin, value=initial, cause=0)
        ends = [record.tick for record in changes] + [self.kept[-1].end]
        for record, end in zip([first, *changes], ends, strict=True):
            says = f"{happened(record)}{self._because(record)}{about}"
            self.add(lane, record.tick, says, number(record.value), end)
        return lane

    def _because(self, record: Record) -> str:
        """Describe the access or edge that caused a change in the same cycle; "" if there is none.

        Earlier causes are uncertain, so they are omitted.
        """
        cause = self.window.by_number.get(record.cause)
        unit = record.where.partition(".")[0]
        if cause is None or record.tick - cause.tick > self.cycles.get(unit, 0):
            return ""
        if cause.kind is Kind.ACCESS:
            way = "read" if cause.what.startswith("R ") else "write"
            return f"\nby the {way} of {cause.what[2:]} at {cause.text}"
        return f"\nas {happened(cause).partition(',')[0]}" if cause.kind is Kind.EDGE else ""

    def _firmware(self, unit: str) -> list[Lane]:
        lanes: list[Lane] = []
        over = self.kept[-1].end
        of_unit = all_episodes(self.window, unit, self.kept[0].begin, over)
        for doing, said in EPISODES:
            found: list[Lane] = []
            for one in (one for one in of_unit if one.doing == doing):
                end = min(one.end, over)
                row = next((row for row in found if row.end[-1] <= one.begin - self.zero), None)
                if row is None:
                    row = Lane("boxes", doing, unit)
                    found.append(row)
                what = label = one.what
                if doing == "wait":
                    what = polled(what)
                    label = " ".join(word.rpartition(".")[2] for word in what.split(" "))
                self.add(row, one.begin, f"{said} {what}" + (f"\nat {one.where}" if one.where else ""), label, end)
                row.chosen |= self._drawn(one.begin, end)
            lanes += found
        return lanes

    def _accesses(self, unit: str) -> list[Lane]:
        lanes: dict[str, Lane] = {}
        for record in self.records:
            if record.kind is not Kind.ACCESS or record.where != unit:
                continue
            way, _, name = record.what.partition(" ")
            module, _, register = name.partition(".")
            lane = lanes.setdefault(name, Lane("marks", register, unit, chosen=self._named(register)))
            of = register_of(module, register)
            value = of.decode(record.value) if of is not None else f"{record.value:#06x}"
            says = f"{'read' if way == 'R' else 'write of'} {module} {value}\nat {record.text}"
            self.add(lane, record.tick, says, f"{record.value:X}", strong=int(way == "W"))
            lane.places.append(record.text)
        return [*lanes.values()]

    def _notes(self) -> list[Lane]:
        lane = Lane("marks", "notes")
        for record in self.records:
            if record.kind is Kind.NOTE:
                self.add(lane, record.tick, f"{record.where}: {record.what}\n{record.text}", record.what, strong=1)
                lane.chosen |= self._drawn(record.tick, record.tick)
        return [lane] if lane.at else []

    # --------------------------------------------------------------------------------

    def _named(self, word: str) -> bool:
        """Return True if the measure or the explanation has this name of a wire or register.

        `REGISTER.FIELD` does not count as the name of the register.
        """
        return bool(re.search(rf"\b{re.escape(word)}\b(?!\.)", self.about))

    def _drawn(self, begin: int, end: int) -> bool:
        """Return True if a range of ticks overlaps the picture."""
        return begin < self.window.drawn.end and end >= self.window.drawn.begin

    def _seen(self, begin: int, end: int) -> bool:
        return any(begin < span.end and end >= span.begin for span in self.kept)
