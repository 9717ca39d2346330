"""The waveform of the last round, from recorded edges of wires.

    edges --the last 1 << 14 are kept--> edges in the last round --> for each wire: its first level and its edges

A round is one execution of a controller's periodic list of requests. If the case has no rounds, the waveform shows the
last transfer. If the case has no bus, or if no round or transfer has ended yet, the waveform shows the 2 ms before the
last edge.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import TypedDict

from ....bus.i2c.transfer import Transfer
from ....core.records import UNWANTED, Kind, Listener, Recorder
from ....core.time import Timebase
from ....devices.sensor_rounds import Round
from ....scene.scene import Scene

KEPT = 1 << 14  # number of edges that are kept, of all wires together; a round of 27 bytes has 800
MARGIN = 20  # microseconds that are shown before and after the round
SERIAL = 2000  # length of a waveform without a round or transfer, in microseconds

Span = tuple[int, int, str]  # start and end, in ticks, of the round or transfer that is shown, and its title


class WaveLine(TypedDict):
    """One line of a waveform.

    first: the level at the start of the waveform.
    edges: the times of the edges, in microseconds since the start of the waveform.
    """

    name: str
    first: int
    edges: list[float]


class Wave(TypedDict):
    """A waveform. at_s: its start, in seconds since the start of the run. length: in microseconds."""

    title: str
    at_s: float
    length: float
    lines: list[WaveLine]


class LastRound(Listener):
    """Recorder of the last edges of some wires. Call `subscribe` while the scene is built.

    wires: the names of the wires, in the order in which the waveform shows them.
    """

    _per_us: int  # ticks in a microsecond

    def __init__(self, wires: Iterable[str]) -> None:
        self._wires = tuple(wires)
        self._edges: deque[tuple[int, int, int]] = deque(maxlen=KEPT)  # tick, number of the wire, level
        self._span: Span | None = None

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        self._per_us = timebase.per_second // 1_000_000
        recorder.subscribe([Kind.EDGE], self, {Kind.EDGE: self._wires})

    def listen(self, scene: Scene) -> None:
        """Subscribe to the controller's rounds of requests or, if there are none, to the I2C transfers."""
        if scene.bus.asked is not None:
            scene.on_round(self._round)
        elif "SCL" in scene.wires:
            scene.on_transfer(self._transfer)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return self._wires.index(where) if where in self._wires else UNWANTED

    def on_record(self, tag: int, tick: int, value: int) -> None:
        self._edges.append((tick, tag, value))

    def _round(self, one: Round) -> None:
        self._span = one.start, one.end, f"round {one.number}"

    def _transfer(self, one: Transfer) -> None:
        self._span = one.phases[0].start_at, one.stop_at, one.name or "the last transfer"

    def wave(self, start: int) -> Wave | None:
        """Return the waveform; None before the first edge, round or transfer. start: the tick when the run began."""
        span = self._span or self._serial()
        if span is None:
            return None
        begin, end = span[0] - MARGIN * self._per_us, span[1] + MARGIN * self._per_us
        lines: list[WaveLine] = [{"name": name, "first": 1, "edges": []} for name in self._wires]
        known: set[int] = set()
        for tick, wire, level in self._edges:
            if tick > end:
                break
            if tick < begin:
                lines[wire]["first"] = level
            else:
                if wire not in known and not lines[wire]["edges"]:
                    lines[wire]["first"] = 1 - level
                lines[wire]["edges"].append(round((tick - begin) / self._per_us, 3))
            known.add(wire)
        return {
            "title": span[2],
            "at_s": (begin - start) / (self._per_us * 1_000_000),
            "length": (end - begin) / self._per_us,
            "lines": [line for number, line in enumerate(lines) if number in known],
        }

    def _serial(self) -> Span | None:
        if not self._edges:
            return None
        last = self._edges[-1][0]
        return last - SERIAL * self._per_us, last, "the serial lines"
