"""Timing diagram of a divergence, in SVG. It shows both sides: the capture and the replay.

    capture  SCL, SDA, bytes  --\\
    replay   SCL, SDA, bytes  ----> lanes, aligned at the last agreed event --> svg_diagram
    history  flags, accesses  --/

A lane is a row of the diagram: the waveform of a wire or field, the bytes of a bus, or the accesses to a register.

Time 0 of the axis is the last event in which both sides agree, or the beginning of the capture if no event before the
divergence agrees. In a UART replay, it is the divergence itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ..records.register_maps import reads_take, yields_data
from ..traces.capture.capture import Channel
from ..traces.decode import i2c
from ..traces.decode.i2c_table import I2cRowKind
from ..traces.drawing.capture_lanes import labelled_events
from ..traces.drawing.svg_diagram import BLACK, BLUE, GREY, ORANGE, Box, Lane, Mark, Tick, timing_diagram
from .report import Divergence, Happened, HistoryEntry

BEFORE, AFTER = 22, 13  # numbers of bit times that are shown before (at least) and after the divergence
# Fields whose lanes are shown first, in this order. If they are in the history, they are shown even if they do not
# change within the picture.
ALWAYS = ("AAS", "SDIR", "RRDY", "XRDY", "XSMT", "SCD", "NACK", "BB", "RXFFST", "RXRDY")
MOST_FLAGS = 9  # maximum number of lanes of fields, and also of lanes of accesses
LINES = ("SCL", "SDA")
CONDITIONS = (I2cRowKind.START, I2cRowKind.REPEATED_START, I2cRowKind.STOP)


@dataclass(frozen=True)
class Side:
    """One side of a comparison.

    name: the name of the side in the picture.
    lines: the name and the levels of each line.
    rate: the number of positions per second in `lines`.
    origin: the position in `lines` at which the capture begins.
    transfers: the transfers, from which the boxes with bytes are drawn.
    agreed: the instant of this side, in seconds since the capture began, that is drawn at time 0 of the axis.
    transfers_at: (rate, origin) for positions in `transfers`; None if `rate` and `origin` are valid for these, too.
    """

    name: str
    lines: tuple[tuple[str, Channel], ...]
    rate: Fraction
    origin: int
    transfers: Sequence[i2c.Transfer]
    agreed: float
    transfers_at: tuple[Fraction, int] | None = None

    def of_transfer(self, position: int) -> float:
        """Convert a position in `transfers` to seconds on the axis of the picture."""
        rate, origin = (self.rate, self.origin) if self.transfers_at is None else self.transfers_at
        return float((position - origin) / rate) - self.agreed

    def seconds(self, position: float | Fraction) -> float:
        """Convert a position in `lines` to seconds on the axis of the picture."""
        return float(Fraction(position) - self.origin) / float(self.rate) - self.agreed


def last_agreed(divergence: Divergence, expected: Sequence[Happened], found: Sequence[Happened]) -> tuple[float, float]:
    """Return the times of the event before a divergence in capture and replay, in seconds; (0, 0) if unknown."""
    number = divergence.index - 1
    if number < 0 or number >= min(len(expected), len(found)):
        return 0.0, 0.0
    was, came = expected[number].at, found[number].at
    return (0.0, 0.0) if was is None or came is None else (float(was), float(came))


def divergence_picture(divergence: Divergence, title: str, captured: Side, replayed: Side, bit: float) -> str:
    """Return a picture of a divergence as SVG text, with the lanes of the capture above those of the replay.

    captured, replayed: the lines of the capture and of the replay.
    bit: the length of a bit in seconds.
    """
    began = not captured.agreed and not replayed.agreed  # True if no event before the divergence agreed
    aligned = captured.agreed != divergence.capture_s
    at_captured = None if divergence.capture_s is None else divergence.capture_s - captured.agreed
    at_replayed = None if divergence.replay_s is None else divergence.replay_s - replayed.agreed
    known = [at for at in (at_captured, at_replayed) if at is not None]
    window = (min([0.0, min(known) - BEFORE * bit]), max(known) + AFTER * bit)
    window = (max(window[0], min(known) - 2 * BEFORE * bit), window[1])
    lanes = [
        *_side(captured, BLUE, window, at_captured, bit),
        *_side(replayed, ORANGE, window, at_replayed, bit),
        *_flags(divergence.history, replayed, window),
        *_accesses(divergence.history, replayed, window),
    ]
    marks = [Mark(0.0, "the capture begins" if began else "last agreed")] if aligned else []
    if at_captured is not None and at_replayed is not None and abs(at_captured - at_replayed) > bit / 2:
        marks.append(Mark(at_captured, f"capture: {divergence.expected}", wrong=True))
        marks.append(Mark(at_replayed, f"replay: {divergence.found}", wrong=True))
    else:
        marks.append(Mark(known[0], f"expected {divergence.expected}, found {divergence.found}", wrong=True))
    axis = f"0 is the last event that agrees, {captured.agreed:.6f} s in the capture, {replayed.agreed:.6f} s in replay"
    if began or not aligned:
        axis = f"0 is {captured.agreed:.6f} s of the capture"
    return timing_diagram(lanes, window, marks, title, axis)


def _side(side: Side, colour: str, window: tuple[float, float], wrong: float | None, bit: float) -> list[Lane]:
    lanes = [Lane("bytes", side.name, colour, boxes=_boxes(side, window, wrong, bit))] if side.transfers else []
    for name, channel in side.lines:
        edges = tuple(
            (side.seconds(at), level)
            for at, level in zip(channel.edges.tolist(), channel.levels.tolist(), strict=True)
            if side.seconds(at) <= window[1]
        )
        lanes.append(Lane(name, side.name, colour, channel.initial, edges))
    return lanes


def _boxes(side: Side, window: tuple[float, float], wrong: float | None, bit: float) -> tuple[Box, ...]:
    found: list[Box] = []

    def add(begin: float, end: float, text: str) -> None:
        if end >= window[0] and begin <= window[1]:
            off = wrong is not None and abs(begin - wrong) < bit / 8
            found.append(Box(begin, end, text, off))

    for transfer in side.transfers:
        for event, label, _, _ in labelled_events(transfer):
            if event.kind is not I2cRowKind.CUT:
                wide = 0.55 if event.kind in CONDITIONS else 0.45
                add(side.of_transfer(event.at), side.of_transfer(event.last) + wide * bit, label)
    return tuple(found)


def _flags(history: Sequence[HistoryEntry], side: Side, window: tuple[float, float]) -> list[Lane]:
    """Return the lanes of register fields in the history: first those in ALWAYS, then those that change in the window.

    There are at most MOST_FLAGS lanes.
    """
    fields: dict[str, list[HistoryEntry]] = {}
    for change in history:
        if not _access(change):
            fields.setdefault(change.what, []).append(change)
    rank = {name: place for place, name in enumerate(ALWAYS)}
    names = [
        name
        for name, changes in fields.items()
        if name.rpartition(".")[2] in rank or any(_shown(c.at_s - side.agreed, window) for c in changes)
    ]
    names.sort(key=lambda name: rank.get(name.rpartition(".")[2], len(rank)))
    lanes = []
    for name in names[:MOST_FLAGS]:
        changes = fields[name]
        field = name.rpartition(".")[2]
        if any(change.value > 1 for change in changes):
            ends = [change.at_s for change in changes[1:]] + [window[1] + side.agreed]
            boxes = tuple(
                Box(c.at_s - side.agreed, end - side.agreed, str(c.value)) for c, end in zip(changes, ends, strict=True)
            )
            lanes.append(Lane(field, "flags", BLACK, boxes=boxes))
            continue
        edges = tuple((change.at_s - side.agreed, change.value) for change in changes)
        lanes.append(Lane(field, "flags", BLACK, 1 - changes[0].value, edges))
    return lanes


def _accesses(history: Sequence[HistoryEntry], side: Side, window: tuple[float, float]) -> list[Lane]:
    """Return a lane for each register that the firmware wrote, or read to take data from it; at most MOST_FLAGS lanes.

    Other reads, such as those of status registers, are omitted.
    """
    ticks: dict[str, list[Tick]] = {}
    for change in history:
        at = change.at_s - side.agreed
        if _shown(at, window) and (change.what.startswith("W ") or _takes_word(change)):
            name = f"{change.what[0]} {change.what.rpartition('.')[2]}"
            ticks.setdefault(name, []).append(Tick(at, f"{change.value:X}"))
    return [Lane(name, "firmware", GREY, ticks=tuple(of)) for name, of in list(ticks.items())[:MOST_FLAGS]]


def _takes_word(change: HistoryEntry) -> bool:
    way, _, register = change.what.partition(" ")
    return way == "R" and yields_data(register) and reads_take(register)


def _access(change: HistoryEntry) -> bool:
    return change.what[:2] in ("R ", "W ")


def _shown(at: float, window: tuple[float, float]) -> bool:
    return window[0] <= at <= window[1]
