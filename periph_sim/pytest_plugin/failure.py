"""What a broken budget looks like: a run and its broken verdicts go in; a table and timing diagrams in text come out.

verdicts --> budget, worst, limit, margin, when, why
worst occurrence --> window --> edges up to there (the run's own, or of a second, short run) --> drawing.text
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..decode import i2c
from ..drawing.text import text_diagram
from ..drawing.timing import Box, Lane, Mark
from ..formats.capture import Capture, Channel, Span
from ..timing.budgets import Verdict
from .figures import aligned, figure, limit_text, moment
from .runs import Run

WIDTH = 88  # pytest puts 4 columns before each line
MOST = 3  # diagrams
BITS = 18  # in a window, where the worst occurrence is no longer than that
BYTE = 9  # bits, with its ACK
BIT = 10e-6  # seconds, where no SCL tells
ENDS = ("age",)  # measures whose instant is the end of the worst occurrence; of others it is the begin
BUS = ("SCL", "SDA")


def failure_text(run: Run, broken: Sequence[Verdict], judged: int) -> str:
    """Several lines; the first says which budgets, and of a single one by how much."""
    head = f"{len(broken)} of {judged} budgets broken: {', '.join(verdict.name for verdict in broken)}"
    if len(broken) == 1:
        one = broken[0]
        found = "was never measured" if one.worst is None else figure(one.worst, one.unit)
        head = f"{one.name} {found}, limit {_limit(one)}"
    lines = [f"{run.result.case}: {head}", "", *_table(broken)]
    if run.result.first_wrong and any(verdict.measure == "wrong bytes" for verdict in broken):
        lines += ["", f"first wrong: {run.result.first_wrong}"]
    lines += [f"stuck: {line}" for line in run.result.stuck]
    seen = [_Worst(run, verdict) for verdict in broken if verdict.at_s is not None]
    if seen:
        capture = run.edges_until(max(occurrence.needs for occurrence in seen[:MOST]))
        for occurrence in seen[:MOST]:
            lines += ["", *occurrence.picture(capture)]
    if len(seen) > MOST:
        left = ", ".join(occurrence.verdict.name for occurrence in seen[MOST:])
        lines += ["", f"(no picture of {left}; one that is asserted alone has one)"]
    return "\n".join(lines)


def _table(verdicts: Sequence[Verdict]) -> list[str]:
    rows: list[tuple[str, ...]] = [("budget", "worst", "limit", "margin", "when", "why")]
    for verdict in verdicts:
        worst, margin = (figure(value, verdict.unit) for value in (verdict.worst, verdict.margin))
        why = verdict.why if verdict.worst is not None else "nothing was measured, which is no pass"
        why = getattr(verdict, "found", "") or why
        rows.append((verdict.name, worst, _limit(verdict), margin, moment(verdict.at_s), why))
    return aligned(rows, left=(0, 5))


def _limit(verdict: Verdict) -> str:
    return limit_text(figure(verdict.limit, verdict.unit), getattr(verdict, "which", ""))


class _Worst:
    """The worst occurrence of a verdict: from where to where, in ticks."""

    def __init__(self, run: Run, verdict: Verdict) -> None:
        assert verdict.at_s is not None
        self.verdict = verdict
        self._per_second = run.timebase.per_second
        self._run_from, self._run_to = run.start, run.end
        self._at = run.start + round(verdict.at_s * self._per_second)
        length = max(verdict.worst or 0, 0) if verdict.unit == "us" else 0
        self._long = round(length * self._per_second / 1_000_000)
        self._begin = self._at - self._long if verdict.measure in ENDS else self._at
        self._end = self._begin + self._long
        self._least = round(BITS * BIT * self._per_second)
        self.needs = min(self._end + max(self._least, self._long // 10), run.end)  # up to where edges are drawn

    def picture(self, capture: Capture) -> list[str]:
        """A title and the diagram; the title alone where no wire moves."""
        verdict = self.verdict
        title = f"{verdict.name}, {figure(verdict.worst, verdict.unit)} at {moment(verdict.at_s)}:"
        bit = _bit(capture, self._least // BITS)
        least = min(self._least, BITS * bit)
        before = max((least - self._long) // 2 if self._long else least // 6, self._long // 10)
        begin = max(self._begin - before, self._run_from)
        end = min(max(self._end + before, begin + least), self._run_to)
        span = Span(max(min(begin, end - least), self._run_from), end)
        lanes = self._lanes(capture, span, bit)
        if not any(lane.edges for lane in lanes):
            return [f"{title} no wire moves around it"]
        name = f"{verdict.name}: worst begins" if self._long else verdict.name
        marks = [Mark(self._seconds(self._begin), name)]
        if self._long:
            marks.append(Mark(self._seconds(self._end), f"ends, {figure(verdict.worst, verdict.unit)} later"))
        window = (self._seconds(span.begin), self._seconds(span.end))
        return [title, *text_diagram(lanes, window, marks, f"from {moment(verdict.at_s)} on", WIDTH)]

    def _seconds(self, position: float) -> float:
        """On the axis, 0 at the verdict's instant."""
        return (position - self._at) / self._per_second

    def _lanes(self, capture: Capture, span: Span, bit: int) -> list[Lane]:
        """The bus with its bytes; then each other wire that moves within the span."""
        lanes: list[Lane] = []
        channels = {channel.name: channel for channel in capture.channels}
        if all(name in channels for name in BUS):
            lanes += [self._wave(channels[name], span) for name in BUS]
            boxes = self._boxes(capture, span, bit)
            lanes += [Lane("bytes", "", boxes=boxes)] if boxes else []
        for name, channel in channels.items():
            wave = self._wave(channel, span)
            if name not in BUS and wave.edges:
                lanes.append(wave)
        return lanes

    def _wave(self, channel: Channel, span: Span) -> Lane:
        cut = channel.cut(span)
        edges = zip(cut.edges.tolist(), cut.levels.tolist(), strict=True)
        return Lane(channel.name, "", initial=cut.initial, edges=tuple((self._seconds(at), to) for at, to in edges))

    def _boxes(self, capture: Capture, span: Span, bit: int) -> tuple[Box, ...]:
        """What is on the bus within the span.

        Byte by byte; phase by phase where a bit is less than a column; nothing where a byte is.
        """
        column = (span.end - span.begin) / WIDTH
        if column > BYTE * bit:
            return ()
        found = i2c.transfers(_around(capture, span))
        told = _bytes if column <= bit else _phases
        boxes = [box for transfer in found for box in told(transfer, bit, span.end)]
        return tuple(
            Box(self._seconds(begin), self._seconds(end), text)
            for begin, end, text in boxes
            if end > span.begin and begin < span.end
        )


Stretch = tuple[float, float, str]  # begin, end, text


def _bytes(transfer: i2c.Transfer, bit: int, end: int) -> Iterator[Stretch]:
    """START, bytes, ACK and STOP."""
    for number, phase in enumerate(transfer.phases):
        yield phase.start.at, phase.start.at + bit / 2, "Sr" if number else "S"
        for place, byte in enumerate(phase.bytes):
            if byte.value is None:
                continue
            text = f"{byte.value:02X}" if place else f"{byte.value >> 1:02X} {'read' if byte.value & 1 else 'write'}"
            yield byte.bits[0].at, byte.bits[7].at + bit / 2, text
            if byte.acked is not None:
                yield byte.bits[8].at, byte.bits[8].at + bit / 2, "A" if byte.acked else "N"
    if transfer.stop is not None and transfer.phases:
        yield transfer.stop.at, transfer.stop.at + bit / 2, "P"


def _phases(transfer: i2c.Transfer, bit: int, end: int) -> Iterator[Stretch]:
    """Each phase up to the next one or the STOP, by its address and how many bytes follow."""
    stops = [phase.start.at for phase in transfer.phases[1:]]
    stops.append(end if transfer.stop is None else transfer.stop.at)
    for phase, stop in zip(transfer.phases, stops, strict=True):
        if phase.address is not None:
            acked = phase.bytes[0].acked is not False
            text = f"{phase.address:02X} {'read' if phase.read else 'write'} {len(phase.data)}"
            yield phase.start.at, stop, text if acked else f"{phase.address:02X}N"


def _bit(capture: Capture, otherwise: int) -> int:
    """How long a bit of the I2C bus takes, in positions: the middle of the distances of SCL's rising edges."""
    for channel in capture.channels:
        rises = channel.edges[channel.levels == 1]
        if channel.name == BUS[0] and len(rises) > 9:
            return int(np.median(np.diff(rises)))
    return otherwise


def _around(capture: Capture, span: Span) -> Capture:
    """From the last STOP before the span to its end and half as far again: all that is decoded, however long the run.

    So a byte that the span cuts in two is still whole here, where the run went on as long.
    """
    scl, sda = (capture.channel(name) for name in BUS)
    high = (scl.at(sda.edges) == 1) & (scl.before(sda.edges) == 1)
    before = sda.edges[high & (sda.levels == 1) & (sda.edges < span.begin)]
    end = min(capture.length, span.end + (span.end - span.begin) // 2)
    cut = Span(int(before[-1]) if len(before) else 0, end)
    return Capture(capture.path, capture.rate, end, (scl.cut(cut), sda.cut(cut)), sampled=False)
