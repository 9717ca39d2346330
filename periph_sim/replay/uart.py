"""Open-loop replay of a UART capture into SCI-A's RX: the words that the firmware reads are compared.

    capture --> edges ----------> RX --> SCI-A --SCIRXBUF--> firmware
       |                                             |
       \\--decode--> frames expected <-- compare --> words read, with SCIFFFE and SCIFFPE

If a line format is given, the capture is decoded in this format, and firmware that lists `baud`, `bits`, `parity` and
`stop` in `REPLAY` is set to it. Otherwise, the capture is decoded in the format to which the firmware has set the SCI.
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from functools import partial

from ..bus.edge_player import EdgePlayer
from ..core.phrases import counted
from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..scene.uart_lines import line_of
from ..traces.capture.capture import Capture, gap_notes
from ..traces.decode import uart as decode
from ..traces.decode.uart import UartRowKind
from . import BadReplay
from .divergence_history import AS_RECEIVER
from .doubtful_frames import Settled, Word, line_errors
from .picture import Side
from .replay import Progress, Replay
from .report import NOTHING, Divergence, Report, compare, verdict_of
from .setup import LEAD, alone, check_length, rate_of, settings_of, unit_with

# The replay continues for one bit and this time (in seconds) after the capture, so that firmware reads the last word.
TAKEN = Fraction(100, 10**6)
TOLERANCE = Fraction(2, 100)  # up to this relative difference in rate, two UARTs read a long frame correctly

SCIRXBUF, SCIFFRX = (SCI_MAP[name] for name in ("SCIRXBUF", "SCIFFRX"))
FLAGS = {"SCIRXST.BRKDT": "BRKDT", "SCIRXST.OE": "OE", "SCIFFRX.RXFFOVF": "RXFFOVF"}
PARITIES = {"n": "none", "o": "odd", "e": "even"}


def line_format(baud: int, text: str = "8n1") -> decode.Line:
    """Parse a format such as "8n1" or "7e2". Raise BadReplay if the SCI does not support it."""
    match = re.fullmatch(r"([1-8])([noe])([12])", text.strip().lower())
    if match is None:
        raise BadReplay(f"{text!r} is no line format; expected data bits 1 to 8, n, o or e, and 1 or 2 stop bits: 8n1")
    if baud < 1:
        raise BadReplay(f"{baud} baud; expected 1 or more")
    return decode.Line(baud, int(match[1]), PARITIES[match[2]], int(match[3]))


def line_settings(line: decode.Line) -> dict[str, object]:
    """Return the firmware settings that correspond to a line format."""
    return {"baud": line.baud, "bits": line.bits, "parity": line.parity, "stop": line.stop}


def play_line(scene: Scene, capture: Capture, channel: str | int, origin: int) -> list[str]:
    """Play a channel of a capture on RX, from tick `origin` on. Return notes on parts that are not played."""
    line = capture.channel(channel)
    per_position = scene.timebase.per_second / rate_of(capture)
    edges = [
        (origin + int(at * per_position), level)
        for at, level in zip(line.edges.tolist(), line.levels.tolist(), strict=True)
    ]
    notes = []
    if not line.initial:
        # The capture begins within a frame or break. Like the decoder, the replay leaves out this first low phase; it
        # plays the rest of such a frame.
        edges = edges[1:]
        notes.append("the capture begins with the line low; the line is kept idle until it has risen")
    EdgePlayer(scene.kernel, scene.wire("RX"), edges)
    return notes + gap_notes(capture, line)


class UartReplay(Replay):
    """Replay of one channel of a capture into SCI-A.

    channel: the name or number of the channel.
    wanted: the line format with which the channel is decoded; None for the format to which the firmware sets the SCI.
    lead: seconds from the start of the firmware to the beginning of the capture. It determines at which instants within
        the bits the SCI samples the line.

    Raise BadCase, BadReplay or another InputError if the replay cannot be built; LookupError if a channel is missing.
    """

    KIND, LOOP = "uart", "open"
    SIDE = AS_RECEIVER

    def __init__(
        self,
        case: Case,
        capture: Capture,
        channel: str | int,
        wanted: decode.Line | None = None,
        subscribe: Subscribe | None = None,
        lead: Fraction = LEAD,
    ) -> None:
        self._rate = rate_of(capture)
        check_length(capture, capture.length)
        self._repeated = partial(UartReplay, case, capture, channel, wanted, lead=lead)
        self._capture = capture
        self._channel = capture.channel(channel)
        self._wanted = wanted
        self._words: list[tuple[int, int]] = []  # tick and value of each read of SCIRXBUF
        self._times_set = dict.fromkeys(FLAGS.values(), 0)  # for each flag, how often it was set
        self._subscribe = subscribe
        self._unit = unit = unit_with(case, "SCI-A")
        forced: dict[str, object] = {}
        if wanted is not None:
            known = settings_of(case, unit)
            forced = {name: value for name, value in line_settings(wanted).items() if name in known}
        super().__init__(Scene(alone(case, unit, "host", forced, {})[0], self._listen), unit, lead)
        self._notes = play_line(self.scene, capture, channel, self.origin)

    @property
    def dsp(self) -> Dsp:
        return self.scene.units[self._unit]

    def _listen(self, recorder: Recorder, timebase: Timebase) -> None:
        """Subscribe to reads and flags.

        The callbacks do not refer to `self`. Otherwise, the recorder would keep this object and its scene in memory for
        ever.
        """
        words, flags, unit = self._words, self._times_set, self._unit

        def accessed(record: Record) -> None:
            if record.what == "R SCI-A.SCIRXBUF" and record.where == unit:
                words.append((record.tick, record.value))

        def flagged(record: Record) -> None:
            if record.value and record.what in FLAGS and record.where == f"{unit}.SCI-A":
                flags[FLAGS[record.what]] += 1

        recorder.subscribe([Kind.ACCESS], accessed)
        recorder.subscribe([Kind.FLAG], flagged)
        if self._subscribe is not None:
            self._subscribe(recorder, timebase)

    # Running the replay ------------------------------------------------------------------------

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        if until is not None:
            self.kernel.run_until(until + 1)
            return ""
        self.kernel.run_until(self.origin)
        present = line_of(self.dsp)
        self._baud = Fraction(present.baud)
        self._line = line = present if self._wanted is None else self._wanted
        self._events = decode.events(self._capture, self._channel.index, line)
        end = self.origin + int(self._capture.length * self.timebase.per_second / self._rate)
        if not any(event.kind is UartRowKind.CUT for event in self._events[-2:]):
            end += self.timebase.ticks(1 / Fraction(line.baud) + TAKEN, "up")
        self._play(end, progress)
        return ""

    def _report(self, stuck: list[str]) -> Report:
        line, events = self._line, self._events
        frames = [event for event in events if event.kind is UartRowKind.FRAME]
        breaks = [event for event in events if event.kind is UartRowKind.BREAK]
        wrong, doubt = line_errors(self._capture, self._channel.index, line, events)
        words = self.received()
        judged = Settled(events, line, self._rate, words)
        outcome = compare(judged.expected, judged.found)
        divergence = outcome.divergence
        notes = self._notes + self._rate_notes(line) + self._ambiguous_notes(judged.ambiguous, len(frames))
        cut = [event for event in events if event.kind is UartRowKind.CUT]
        if cut:
            notes.append(
                f"frames cut off by the end of the capture, not compared: {len(cut)}, the "
                f"last with {counted(cut[-1].bits, 'data bit')}"
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
            notes.append(f"low for a frame or longer, {longest:.1f} bits at most: {counted(len(breaks), 'time')}")
        unjudged = doubt if frames else "there is no frame on the line, so nothing was required of the firmware"
        if unjudged and divergence is not None:
            notes.insert(0, unjudged)
        return self._summary(
            self._capture.path,
            replace(outcome, divergence=divergence, ranked=ranked),
            self.timebase.ticks(12 / Fraction(line.baud), "up"),
            notes,
            verdict=verdict_of(divergence is not None, not unjudged, len(judged.ambiguous)),
            events=len(frames),
            ambiguous=len(judged.ambiguous),
            captured_errors=wrong,
            unjudged=unjudged,
            bytes=len(words),
            errors={"FE": sum(word.frame_error for word in words), "PE": sum(word.parity_error for word in words)}
            | self._times_set,
        )

    def sides(self, divergence: Divergence) -> tuple[Side, Side, float]:
        agreed = divergence.capture_s or 0.0
        captured = Side("capture", (("RX", self._channel),), self._rate, 0, (), agreed)
        side = Side("SCI-A", (), self._rate, 0, (), agreed)
        return captured, side, 1 / float(self._line.baud)

    def received(self) -> list[Word]:
        """Return the words that the firmware has read from SCIRXBUF so far."""
        rxdt, sciffe, sciffpe = (SCIRXBUF[name] for name in ("RXDT", "SCIFFFE", "SCIFFPE"))
        return [
            Word(
                rxdt.extract(word),
                bool(sciffe.extract(word)),
                bool(sciffpe.extract(word)),
                self.timebase.seconds(tick - self.origin),
            )
            for tick, word in self._words
        ]

    def _ambiguous_notes(self, ambiguous: list[decode.Event], frames: int) -> list[str]:
        if not ambiguous:
            return []
        first = ambiguous[0]
        return [
            f"frames with a glitch, which receivers may read either way, not judged: "
            f"{len(ambiguous)} of {frames}, the first at {float(first.at / self._rate):.6f} s, {first.value:02X} where "
            "each bit is sampled once"
        ]

    def _left(self) -> int:
        """Return the number of unread words in the receive FIFO."""
        cycle = self.dsp.clock.cycle_at(self.kernel.now)
        return SCIFFRX["RXFFST"].extract(self.dsp.sockets["SCI-A"].peek(cycle, SCIFFRX.offset))

    def _rate_notes(self, line: decode.Line) -> list[str]:
        off = self._baud / Fraction(line.baud) - 1
        if abs(off) <= TOLERANCE:
            return []
        return [f"the SCI runs at {float(self._baud):.0f} baud, {float(off * 100):+.1f} % off the line's {line.baud}"]
