"""Lanes of a timeline around a worst occurrence, from a Window.

edges     --decoder--> SCL, SDA, bytes; RX, TX; named pins; rows of the protocol table
BUS, FRAME -----------> transfers of the controller, frames of the host
FLAG      -----------> one lane per register field that changed
SPAN, WAIT, IRQ ------> spans of firmware, its waits with the polled field, service routines
ACCESS    -----------> one lane per register: reads and writes with their firmware location

Lanes are chosen, and so drawn at first, if the explanation is about them. These are wires and registers that the chain
names, the wires of the bus that it mentions (SCL and SDA for an address, RX for a frame), fields that are named by the
chain or measured, and service routines, spans and waits within the picture.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from ....core.records import Kind, Record
from ....records.record_text import happened, number
from ....records.register_maps import register_of
from ....traces.capture.capture import Span
from ....traces.decode import i2c
from ..explain.cpu_activity import all_episodes, polled
from ..explain.picture import flags_shown
from ..explain.window import Window
from .protocol import bytes_of, rows
from .timeline import Boxes, Lane, Marks, Texts, Timeline, Wave

BUS_WORDS = re.compile(r"\b(SCL|SDA|START|STOP|N?ACK|acknowledged|transfer|byte \d+)\b")
SERIAL_WORDS = re.compile(r"\b(RX|TX|SCI\w*|frames?|host|FIFO)\b")


BUS = ("SCL", "SDA")
SERIAL = ("RX", "TX")
MOST = 24_000  # maximum number of events of a timeline; events farther from the occurrence are left out
FRAME_BITS = 10  # number of bits of the host's characters: start, 8 data, stop
EPISODES = (("span", "span"), ("wait", "waits for"), ("interrupt", "service routine of"))


def timeline(window: Window, cycles: dict[str, float], frame_bit: int = 0, most: int = MOST) -> Timeline:
    """Build the timeline.

    cycles: the number of ticks per cycle of SYSCLKOUT for each unit.
    frame_bit: the number of ticks per bit of the host; 0 if there is no host.
    most: the maximum number of events.
    """
    return _Lanes(window, cycles, frame_bit, most).timeline()


@dataclass
class _Lanes:
    window: Window
    cycles: dict[str, float]
    frame_bit: int
    most: int
    says: Texts = field(default_factory=Texts)

    def __post_init__(self) -> None:
        self.kept = _within_reach(self.window, self.most)
        about = "\n".join((self.window.verdict.measure, *self.window.chain_texts))
        self.about = about
        self.about_serial = bool(SERIAL_WORDS.search(about))
        self.about_bus = bool(BUS_WORDS.search(about)) or not (self.about_serial or self.window.chain_texts)
        self.chosen_flags = set(flags_shown(self.window))
        self.records = [r for r in self.window.records if any(k.begin <= r.tick < k.end for k in self.kept)]
        early = [r for r in self.window.records if r.tick < self.kept[0].begin]
        self.before = {r[2:5]: r for r in (*self.window.before, *early)}
        self.zero = self.window.begin

    def timeline(self) -> Timeline:
        window = self.window
        groups = [("I2C bus", self._bus()), ("UART", self._serial()), ("pins", self._pins())]
        for unit in self.cycles:
            prefix = f"{unit} " if len(self.cycles) > 1 else ""
            groups.append((f"{prefix}flags", self._flags(unit)))
            groups.append((f"{prefix}firmware", self._firmware(unit)))
            groups.append((f"{prefix}accesses", self._accesses(unit)))
        groups.append(("notes", self._notes()))
        return Timeline(
            origin=self.zero - window.start,
            begin=0,
            end=window.end - self.zero,
            per_second=window.timebase.per_second,
            cycles=self.cycles,
            shown=(window.drawn.begin - self.zero, window.drawn.end - 1 - self.zero),
            kept=tuple((span.begin - self.zero, span.end - 1 - self.zero) for span in self.kept),
            groups=tuple((name, tuple(lanes)) for name, lanes in groups if lanes),
            says=tuple(self.says),
            rows=tuple(rows(window, self._seen, self.zero)),
        )

    # Lines --------------------------------------------------------------------------

    def _wave(self, wire: str) -> Wave | None:
        """Return the wave of a wire; None if it never changed."""
        channel = self.window.edges.channel(wire)
        first = self.before.get((Kind.EDGE, wire, "level"))
        edges = [r for r in self.records if r.kind is Kind.EDGE and r.where == wire]
        if not edges and first is None and not len(channel.edges):
            return None
        initial = first.value if first is not None else edges[0].value ^ 1 if edges else channel.initial
        wave = Wave(wire, "", initial=initial)
        wave.chosen = self._named(wire) or (wire in BUS and self.about_bus) or (wire in SERIAL and self.about_serial)
        level = initial
        for record in edges:
            if record.value != level:
                level = record.value
                wave.at.append(record.tick - self.zero)
                wave.says.append(self.says.place(happened(record)))
        return wave

    def _bus(self) -> list[Lane]:
        wires = [wave for wire in BUS if wire in self._wires() and (wave := self._wave(wire))]
        if len(wires) < len(BUS):
            return [*wires]
        bytes_ = Boxes("bytes", "", chosen=self.about_bus)
        for begin, end, label, says in bytes_of(i2c.transfers(self.window.edges), self.kept[-1].end):
            if self._seen(begin, end):
                bytes_.add(begin - self.zero, end - self.zero, self.says.place(label), self.says.place(says))
        return [*wires, bytes_, *self._transfers()]

    def _transfers(self) -> list[Lane]:
        """Return lanes with the controller's transfers, one for each name of a request."""
        lane = Boxes("transfer", "", chosen=self.about_bus)
        open_: Record | None = None
        for record in [*sorted(self.before.values(), key=lambda r: r.tick), *self.records]:
            if record.kind is not Kind.BUS:
                continue
            if record.what == "START":
                open_ = record
            elif record.what in ("STOP", "arbitration lost") and open_ is not None:
                self._transfer(lane, open_, record.tick, record.what)
                open_ = None
        if open_ is not None:
            self._transfer(lane, open_, self.kept[-1].end, "continues after the recorded range")
        return [lane] if lane.at else []

    def _transfer(self, lane: Boxes, began: Record, end: int, how: str) -> None:
        if self._seen(began.tick, end):
            says = self.says.place(f"{began.where}: {began.text}\nfrom START to {how}")
            lane.add(began.tick - self.zero, end - self.zero, self.says.place(began.text), says)

    def _serial(self) -> list[Lane]:
        lanes: list[Lane] = [wave for wire in SERIAL if wire in self._wires() and (wave := self._wave(wire))]
        frames = Boxes("frames", "", chosen=self.about_serial)
        for record in self.records:
            if record.kind is Kind.FRAME and record.what == "byte":
                byte = f"{record.value:02X}"
                says = self.says.place(f"frame 0x{byte} from {record.where}")
                begin = record.tick - self.zero
                frames.add(begin, begin + FRAME_BITS * self.frame_bit, self.says.place(byte), says)
        return [*lanes, *([frames] if frames.at else [])]

    def _pins(self) -> list[Lane]:
        return [wave for wire in self._wires() if wire not in (*BUS, *SERIAL) and (wave := self._wave(wire))]

    # A unit's inside ------------------------------------------------------------------

    def _flags(self, unit: str) -> list[Lane]:
        changes: dict[tuple[str, str], list[Record]] = {}
        for record in self.records:
            if record.kind is Kind.FLAG and record.where.partition(".")[0] == unit:
                changes.setdefault((record.where.partition(".")[2], record.what), []).append(record)
        return [self._flag(unit, module, what, of) for (module, what), of in changes.items()]

    def _flag(self, unit: str, module: str, what: str, changes: list[Record]) -> Lane:
        register, _, field_name = what.partition(".")  # a variable of an image may have any number of dots
        of = register_of(module, register)
        known = of[field_name] if of is not None and field_name in of else None
        before = self.before.get(changes[0][2:5])
        initial = before.value if before is not None else known.reset if known is not None else 0
        about = f"\n{known.doc} [{of.source}]" if of is not None and known is not None and known.doc else ""
        chosen = changes[0][3:5] in self.chosen_flags
        if known is not None and known.msb == known.lsb:
            wave = Wave(what, unit, initial=initial, chosen=chosen)
            for record in changes:
                if record.value != initial:
                    initial = record.value
                    wave.at.append(record.tick - self.zero)
                    wave.says.append(self.says.place(f"{happened(record)}{self._because(record)}{about}"))
            return wave
        boxes = Boxes(what, unit, chosen=chosen)
        ends = [record.tick for record in changes[1:]] + [self.kept[-1].end]
        boxes.add(
            self.kept[0].begin - self.zero,
            changes[0].tick - self.zero,
            self.says.place(number(initial)),
            self.says.place(f"{happened(changes[0]._replace(value=initial))}{about}"),
        )
        for record, end in zip(changes, ends, strict=True):
            says = self.says.place(f"{happened(record)}{self._because(record)}{about}")
            boxes.add(record.tick - self.zero, end - self.zero, self.says.place(number(record.value)), says)
        return boxes

    def _because(self, record: Record) -> str:
        """Describe the record that caused a change in the same cycle.

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
            found: list[Boxes] = []
            for one in (one for one in of_unit if one.doing == doing):
                end = over if one.end is None else min(one.end, over)
                row = next((row for row in found if row.end[-1] <= one.begin - self.zero), None)
                if row is None:
                    row = Boxes(doing, unit)
                    found.append(row)
                what = label = one.what
                if doing == "wait":
                    what = polled(what)
                    label = " ".join(word.rpartition(".")[2] for word in what.split(" "))
                says = self.says.place(f"{said} {what}" + (f"\nat {one.where}" if one.where else ""))
                row.add(one.begin - self.zero, end - self.zero, self.says.place(label), says)
                row.chosen |= self._drawn(one.begin, end)
            lanes += found
        return lanes

    def _accesses(self, unit: str) -> list[Lane]:
        lanes: dict[str, Marks] = {}
        for record in self.records:
            if record.kind is not Kind.ACCESS or record.where != unit:
                continue
            way, _, name = record.what.partition(" ")
            module, _, register = name.partition(".")
            lane = lanes.setdefault(name, Marks(register, unit, chosen=self._named(register)))
            of = register_of(module, register)
            value = of.decode(record.value) if of is not None else f"{record.value:#06x}"
            verb = "read" if way == "R" else "write of"
            lane.at.append(record.tick - self.zero)
            lane.labels.append(self.says.place(f"{record.value:X}"))
            lane.says.append(self.says.place(f"{verb} {module} {value}\nat {record.text}"))
            lane.strong.append(int(way == "W"))
            lane.places.append(self.says.place(record.text))
        return [*lanes.values()]

    def _notes(self) -> list[Lane]:
        lane = Marks("notes", "")
        for record in self.records:
            if record.kind is Kind.NOTE:
                lane.at.append(record.tick - self.zero)
                lane.labels.append(self.says.place(record.what))
                lane.says.append(self.says.place(f"{record.where}: {record.what}\n{record.text}"))
                lane.chosen |= self._drawn(record.tick, record.tick)
                lane.strong.append(1)
        return [lane] if lane.at else []

    # --------------------------------------------------------------------------------

    def _wires(self) -> list[str]:
        return [channel.name for channel in self.window.edges.channels]

    def _named(self, word: str) -> bool:
        """Return True if the measure or the chain names a pin, or a register without a field."""
        return bool(re.search(rf"\b{re.escape(word)}\b(?!\.)", self.about))

    def _drawn(self, begin: int, end: int) -> bool:
        """Return True if a range of ticks overlaps the picture."""
        return begin < self.window.drawn.end and end >= self.window.drawn.begin

    def _seen(self, begin: int, end: int) -> bool:
        return any(begin < span.end and end >= span.begin for span in self.kept)


def _within_reach(window: Window, most: int) -> tuple[Span, ...]:
    """Return the recorded ranges, cut to at most `most` events around the occurrence, or after its begin."""
    if len(window.records) <= most:
        return window.kept
    inside = [r.tick for r in window.records if window.begin <= r.tick <= window.end]
    if len(inside) >= most:
        return (Span(min(window.drawn.begin, window.begin), inside[most - 1] + 1),)
    apart: Callable[[Record], int] = lambda r: max(window.begin - r.tick, r.tick - window.end, 0)  # noqa: E731
    reach = sorted(map(apart, window.records))[most - 1]
    first, last = window.begin - reach, window.end + reach
    cut = [Span(max(span.begin, first), min(span.end, last + 1)) for span in window.kept]
    return tuple(span for span in cut if span.begin < span.end)
