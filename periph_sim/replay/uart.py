"""Open-loop replay of a UART capture into SCI-A's RX: the words that the firmware reads are compared.

    capture --> edges ----------> RX --> SCI-A --SCIRXBUF--> firmware
       |                                             |
       \\--decode--> frames expected <-- compare --> words read, with SCIFFFE and SCIFFPE

A firmware whose `REPLAY` names `baud`, `bits`, `parity` and `stop` is set to the line's format if one is given; else
the line is decoded in the format that the firmware has set for the SCI.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING

from ..bus.edge_player import EdgePlayer
from ..core.counted import counted
from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..scene.uart_lines import line_of
from ..traces.capture.capture import Capture, Channel, gap_notes
from ..traces.decode import uart as decode
from . import BadReplay
from .ambiguous import Word, settled
from .compare import NOTHING, Divergence, Happened, compare
from .divergence_history import AS_RECEIVER, CaptureOrigin, FlagHistory, with_history
from .line_errors import line_errors
from .picture import Side, divergence_picture, title_of
from .report import Report, verdict_of
from .scene_setup import LEAD, alone, check_length, rate_of, settings_of, unit_with

if TYPE_CHECKING:
    from ..records.recording import Subscribe


TAKEN = Fraction(100, 10**6)  # seconds in which the firmware can read the last word
STEPS = 100  # number of reports of progress
TOLERANCE = Fraction(2, 100)  # largest difference in rate at which two UARTs agree on every bit of a long frame

SCIRXBUF, SCIFFRX = (SCI_MAP[name] for name in ("SCIRXBUF", "SCIFFRX"))
FLAGS = {"SCIRXST.BRKDT": "BRKDT", "SCIRXST.OE": "OE", "SCIFFRX.RXFFOVF": "RXFFOVF"}
PARITIES = {"n": "none", "o": "odd", "e": "even"}


@dataclass(frozen=True)
class LineFormat:
    """The format of a line as given by the user: 115200 baud, 8n1."""

    baud: int
    bits: int = 8
    parity: str = "none"
    stop: int = 1

    def settings(self) -> dict[str, object]:
        return {"baud": self.baud, "bits": self.bits, "parity": self.parity, "stop": self.stop}

    def line(self) -> decode.Line:
        return decode.Line(self.baud, self.bits, self.parity, self.stop)


def line_format(baud: int, text: str = "8n1") -> LineFormat:
    """Parse a format such as "8n1" or "7e2". BadReplay if the SCI does not support it."""
    match = re.fullmatch(r"([1-8])([noe])([12])", text.strip().lower())
    if match is None:
        raise BadReplay(f"{text!r} is no line format; expected data bits 1 to 8, n, o or e, and 1 or 2 stop bits: 8n1")
    if baud < 1:
        raise BadReplay(f"{baud} baud; expected 1 or more")
    return LineFormat(baud, int(match[1]), PARITIES[match[2]], int(match[3]))


def ticks_of(line: Channel, origin: int, per_position: Fraction) -> tuple[list[tuple[int, int]], list[str]]:
    """Return a line's edges as (tick, level), and notes on omitted ones."""
    edges = [
        (origin + int(at * per_position), level)
        for at, level in zip(line.edges.tolist(), line.levels.tolist(), strict=True)
    ]
    if line.initial:
        return edges, []
    # The line is in a frame or break that began before the capture; the decoder, too, waits for the next falling edge.
    return edges[1:], ["the capture begins with the line low; the line is kept idle until it has risen"]


class UartReplay:
    """Replay of a capture's channel on a case. wanted: the line's format; None: as the firmware sets the SCI.

    lead: seconds from the start of the firmware to the begin of the capture. It determines at which phases of the line
    the SCI samples.
    BadCase or BadReplay if it cannot be built; LookupError if there is no such channel.
    """

    def __init__(
        self,
        case: Case,
        capture: Capture,
        channel: str | int,
        wanted: LineFormat | None = None,
        subscribe: Subscribe | None = None,
        lead: Fraction = LEAD,
    ) -> None:
        rate = rate_of(capture)
        check_length(capture, capture.length)
        self._given = (case, capture, channel, wanted)
        self._lead = lead
        self._capture = capture
        self._rate = rate
        self._channel = channel
        self._wanted = wanted
        self._words: list[tuple[int, int]] = []  # tick, SCIRXBUF
        self.errors = {"FE": 0, "PE": 0, **dict.fromkeys(FLAGS.values(), 0)}
        self._subscribe = subscribe
        line = capture.channel(channel)
        self._unit = unit = unit_with(case, "SCI-A")
        forced: dict[str, object] = {}
        if wanted is not None:
            known = settings_of(case, unit)
            forced = {name: value for name, value in wanted.settings().items() if name in known}
        self._scene = scene = Scene(alone(case, unit, "host", forced, {}), self._listen)
        self.kernel = scene.kernel
        self._origin = scene.start + scene.timebase.ticks(lead, "nearest")
        per_position = scene.timebase.per_second / rate
        edges, self._notes = ticks_of(line, self._origin, per_position)
        self._notes += gap_notes(capture, line)
        self._end = self._origin + int(capture.length * per_position)
        EdgePlayer(scene.kernel, scene.wire("RX"), edges)

    @property
    def dsp(self) -> Dsp:
        return self._scene.units[self._unit]

    def _listen(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.ACCESS], self._accessed)
        recorder.subscribe([Kind.FLAG], self._flagged)
        if self._subscribe is not None:
            self._subscribe(recorder, timebase)

    def _accessed(self, record: Record) -> None:
        if record.what == "R SCI-A.SCIRXBUF" and record.where == self._unit:
            self._words.append((record.tick, record.value))
            self.errors["FE"] += SCIRXBUF["SCIFFFE"].extract(record.value)
            self.errors["PE"] += SCIRXBUF["SCIFFPE"].extract(record.value)

    def _flagged(self, record: Record) -> None:
        if record.value and record.what in FLAGS and record.where == f"{self._unit}.SCI-A":
            self.errors[FLAGS[record.what]] += 1

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Play the capture and compare."""
        scene = self._scene
        kernel, timebase = scene.kernel, scene.timebase
        wall = perf_counter()
        kernel.run_until(self._origin)
        line = self._line()
        try:
            events = decode.events(self._capture, self._channel, line)
        except ValueError as error:
            raise BadReplay(str(error)) from None
        end = self._end
        if not any(isinstance(event, decode.CutFrame) for event in events[-2:]):
            end += timebase.ticks(1 / Fraction(line.baud) + TAKEN, "up")
        began = kernel.now
        for step in range(1, STEPS + 1):
            kernel.run_until(began + (end - began) * step // STEPS)
            if progress is not None:
                progress(step / STEPS)
        return self._report(line, events, perf_counter() - wall)

    def _line(self) -> decode.Line:
        """Return the format in which to read the capture: the wanted format, or else the SCI's present format."""
        line = line_of(self.dsp)
        self._baud = Fraction(line.baud)
        if self._wanted is not None:
            return self._wanted.line()
        return line

    def _report(self, line: decode.Line, events: list[decode.Event], wall: float) -> Report:
        scene = self._scene
        frames = [event for event in events if isinstance(event, decode.Frame)]
        breaks = [event for event in events if isinstance(event, decode.Break)]
        result = scene.run(Fraction(0))
        self._bit = 1 / float(line.baud)
        errors = line_errors(self._capture, self._channel, line, events)
        judged = settled(events, line, self._rate, self._received())
        outcome = compare(judged.expected, judged.found)
        divergence = outcome.divergence
        notes = self._notes + self._rate_notes(line) + self._ambiguous_notes(judged.ambiguous, len(frames))
        cut = [event for event in events if isinstance(event, decode.CutFrame)]
        if cut:
            notes.append(
                f"frames cut off by the end of the capture, not compared: {len(cut)}, the "
                f"last with {counted(len(cut[-1].bits), 'data bit')}"
            )
        left = self._left()
        behind = None if divergence is None else len(judged.expected) - divergence.index
        if divergence is not None and divergence.found == NOTHING and behind == left:
            notes.append(f"words still unread in the FIFO: {left}")
            divergence = None
        ranked = outcome.ranked if divergence is not None else ()
        if breaks:
            width = self._rate / Fraction(line.baud)
            longest = max(float((event.end - event.at) / width) for event in breaks)
            notes.append(
                f"low for a frame or longer, {longest:.1f} bits at most: {counted(len(breaks), 'time')}; "
                "the SCI sets BRKDT after ten bits beyond a missing stop bit"
            )
        unjudged = errors.doubt if frames else "there is no frame on the line, so nothing was required of the firmware"
        if unjudged and divergence is not None:
            notes.insert(0, unjudged)
        return Report(
            case=scene.case.name,
            capture=str(self._capture.path),
            kind="uart",
            loop="open",
            verdict=verdict_of(divergence is not None, not unjudged, len(judged.ambiguous)),
            events=len(frames),
            agreed=outcome.agreed,
            ambiguous=len(judged.ambiguous),
            captured_errors=errors.wrong,
            unjudged=unjudged,
            first_divergence=divergence,
            divergences=self._with_history(ranked, line),
            bytes=len(self._words),
            errors=self.errors,
            lag_worst_us=float(outcome.lag * 1_000_000),
            simulated_s=float(scene.timebase.seconds(scene.kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=scene.kernel.events,
            unknowns=result.unknowns,
            notes=notes + result.notes,
        )

    def picture(self, report: Report) -> str | None:
        """Return the first divergence of a run as SVG text; None without any. Both sides share one time base."""
        if not report.divergences:
            return None
        divergence = report.divergences[0]
        agreed = divergence.capture_s or 0.0
        line = ("RX", self._capture.channel(self._channel))
        captured = Side("capture", (line,), self._rate, 0, (), agreed)
        side = Side("SCI-A", (), self._rate, 0, (), agreed)
        return divergence_picture(divergence, title_of(report, divergence), captured, side, self._bit)

    def _with_history(self, ranked: tuple[Divergence, ...], line: decode.Line) -> list[Divergence]:
        scene = self._scene
        frame = scene.timebase.ticks(12 / Fraction(line.baud), "up")
        return with_history(ranked, CaptureOrigin(scene, self._origin, frame), self._unit, AS_RECEIVER, self._again)

    def _again(self, history: FlagHistory, until: int) -> None:
        again = UartReplay(*self._given, subscribe=history.subscribe, lead=self._lead)
        history.watch(again._scene)
        again.kernel.run_until(until + 1)

    def received(self) -> list[Happened]:
        """Return the words read from SCIRXBUF so far as events."""
        return [word.happened for word in self._received()]

    def _received(self) -> list[Word]:
        """Return the words read from SCIRXBUF so far."""
        rxdt, sciffe, sciffpe = (SCIRXBUF[name] for name in ("RXDT", "SCIFFFE", "SCIFFPE"))
        return [
            Word(
                rxdt.extract(word),
                bool(sciffe.extract(word)),
                bool(sciffpe.extract(word)),
                self._scene.timebase.seconds(tick - self._origin),
            )
            for tick, word in self._words
        ]

    def _ambiguous_notes(self, ambiguous: list[decode.Frame], frames: int) -> list[str]:
        if not ambiguous:
            return []
        first = ambiguous[0]
        return [
            f"frames with a glitch, which receivers may read either way, not judged: "
            f"{len(ambiguous)} of {frames}, the first at {float(first.at / self._rate):.6f} s, {first.value:02X} where "
            "each bit is sampled once"
        ]

    def _left(self) -> int:
        """Return the number of words in the receive FIFO."""
        cycle = self.dsp.clock.cycle_at(self._scene.kernel.now)
        return SCIFFRX["RXFFST"].extract(self.dsp.socket("SCI-A").peek(cycle, SCIFFRX.offset))

    def _rate_notes(self, line: decode.Line) -> list[str]:
        off = self._baud / Fraction(line.baud) - 1
        if abs(off) <= TOLERANCE:
            return []
        return [f"the SCI runs at {float(self._baud):.0f} baud, {float(off * 100):+.1f} % off the line's {line.baud}"]
