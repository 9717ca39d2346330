"""A UART capture into SCI-A's RX: every edge when it came; what the firmware takes from the SCI is compared.

    capture --> edges ----------> RX --> SCI-A --SCIRXBUF--> firmware
       |                                             |
       \\--decode--> frames expected <-- compare --> words read, with SCIFFFE and SCIFFPE

A firmware with settings called `baud`, `bits`, `parity` and `stop` is set to the line's format where one is given;
else the line is decoded in the format that the firmware has set the SCI to.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter

from ..board.dsp import Dsp
from ..board.scene import Scene
from ..case.model import Case
from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase
from ..decode import uart as decode
from ..f28335.sci_map import SCI_MAP
from ..formats.capture import Capture
from ..lines.edge_player import EdgePlayer
from ..recording import Subscribe
from . import BadReplay
from .compare import NOTHING, Happened, compare
from .report import Report
from .scenes import alone, settings_of, unit_with
from .words import byte_words, uart_words

LEAD = Fraction(1, 1000)  # the firmware starts this long before the capture begins
TAKEN = Fraction(100, 10**6)  # for the firmware to take the last word
STEPS = 100  # of progress
TOLERANCE = Fraction(2, 100)  # of the rate; what two UARTs may differ by and still agree on every bit of a long frame

SCICCR, SCIRXBUF, SCIFFRX = (SCI_MAP[name] for name in ("SCICCR", "SCIRXBUF", "SCIFFRX"))
FLAGS = {"SCIRXST.BRKDT": "BRKDT", "SCIRXST.OE": "OE", "SCIFFRX.RXFFOVF": "RXFFOVF"}
PARITIES = {"n": "none", "o": "odd", "e": "even"}


@dataclass(frozen=True)
class LineFormat:
    """What a person says of a line: 115200 baud, 8n1."""

    baud: int
    bits: int = 8
    parity: str = "none"
    stop: int = 1

    def settings(self) -> dict[str, object]:
        return {"baud": self.baud, "bits": self.bits, "parity": self.parity, "stop": self.stop}


def line_format(baud: int, text: str = "8n1") -> LineFormat:
    """The format that "8n1" or "7e2" says. BadReplay if it is none the SCI can do."""
    match = re.fullmatch(r"([1-8])([noe])([12])", text.strip().lower())
    if match is None:
        raise BadReplay(f"{text!r} is no line format; expected data bits 1 to 8, n, o or e, and 1 or 2 stop bits: 8n1")
    if baud < 1:
        raise BadReplay(f"{baud} baud; expected 1 or more")
    return LineFormat(baud, int(match[1]), PARITIES[match[2]], int(match[3]))


class UartReplay:
    """One channel of a capture on one case. wanted: the line's format; None: as the firmware sets the SCI.

    lead: seconds from the firmware's start to the capture's; it sets the phase of the SCI's sampling against the line.
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
        if capture.rate is None:
            raise BadReplay(f"{capture.path}: a replay needs a time base and the file states no rate; state the rate")
        self._capture = capture
        self._rate = capture.rate
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
        per_position = scene.timebase.per_second / capture.rate
        edges = [
            (self._origin + int(at * per_position), level)
            for at, level in zip(line.edges.tolist(), line.levels.tolist(), strict=True)
        ]
        self._notes: list[str] = []
        if not line.initial:  # within a frame or a break that began unseen: the oracle waits for the next falling edge
            edges = edges[1:]
            self._notes.append("the capture begins with the line low; the line is kept idle until it has risen")
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
            self.errors["FE"] += SCIRXBUF["SCIFFFE"].of(record.value)
            self.errors["PE"] += SCIRXBUF["SCIFFPE"].of(record.value)

    def _flagged(self, record: Record) -> None:
        if record.value and record.what in FLAGS and record.where == f"{self._unit}.SCI-A":
            self.errors[FLAGS[record.what]] += 1

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Play it all and compare."""
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
        """How to read the capture: as wanted, else as the SCI is set now."""
        dsp = self.dsp
        socket, cycle = dsp.socket("SCI-A"), dsp.clock.cycle_at(self._scene.kernel.now)
        ccr = socket.peek(cycle, SCICCR.offset)
        brr = socket.peek(cycle, SCI_MAP["SCIHBAUD"].offset) << 8 | socket.peek(cycle, SCI_MAP["SCILBAUD"].offset)
        lspclk = dsp.control.sysclk_hz / dsp.control.lspclk_divider
        self._baud = lspclk / (8 * (brr + 1) if brr else 16)
        parity = "none"
        if SCICCR["PARITYENA"].of(ccr):
            parity = "even" if SCICCR["PARITY"].of(ccr) else "odd"
        bits, stop = SCICCR["SCICHAR"].of(ccr) + 1, SCICCR["STOPBITS"].of(ccr) + 1
        if self._wanted is not None:
            wanted = self._wanted
            return decode.Line(wanted.baud, wanted.bits, wanted.parity, wanted.stop)
        return decode.Line(self._baud, bits, parity, stop)

    def _report(self, line: decode.Line, events: list[decode.Event], wall: float) -> Report:
        scene = self._scene
        frames = [event for event in events if isinstance(event, decode.Frame)]
        breaks = [event for event in events if isinstance(event, decode.Break)]
        result = scene.run(Fraction(0))
        outcome = compare(uart_words(frames, self._rate), self.received())
        divergence = outcome.divergence
        notes = self._notes + self._rate_notes(line)
        left = self._left()
        if divergence is not None and divergence.found == NOTHING and len(frames) - outcome.agreed == left:
            notes.append(f"words still in the FIFO, which the firmware has not asked for yet: {left}")
            divergence = None
        if breaks:
            width = self._rate / Fraction(line.baud)
            longest = max(float((event.end - event.at) / width) for event in breaks)
            notes.append(
                f"low for a frame or longer, {longest:.1f} bits at most: {len(breaks)} times; "
                "the SCI sets BRKDT after ten bits beyond a missing stop bit"
            )
        return Report(
            case=scene.case.name,
            capture=str(self._capture.path),
            kind="uart",
            verdict="fail" if divergence else "pass",
            events=len(frames),
            agreed=outcome.agreed,
            first_divergence=divergence,
            bytes=len(self._words),
            errors=self.errors,
            lag_worst_us=float(outcome.lag * 1_000_000),
            simulated_s=float(scene.timebase.seconds(scene.kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=scene.kernel.events,
            unknowns=result.unknowns,
            notes=notes + result.notes,
        )

    def received(self) -> list[Happened]:
        """What the firmware has read from SCIRXBUF so far."""
        found = []
        for tick, word in self._words:
            frame_error, parity_error = SCIRXBUF["SCIFFFE"].of(word), SCIRXBUF["SCIFFPE"].of(word)
            at = self._scene.timebase.seconds(tick - self._origin)
            found.append(Happened(byte_words(SCIRXBUF["RXDT"].of(word), bool(frame_error), bool(parity_error)), at))
        return found

    def _left(self) -> int:
        """Words in the receive FIFO."""
        cycle = self.dsp.clock.cycle_at(self._scene.kernel.now)
        return SCIFFRX["RXFFST"].of(self.dsp.socket("SCI-A").peek(cycle, SCIFFRX.offset))

    def _rate_notes(self, line: decode.Line) -> list[str]:
        off = self._baud / Fraction(line.baud) - 1
        if abs(off) <= TOLERANCE:
            return []
        return [f"the SCI runs at {float(self._baud):.0f} baud, {float(off * 100):+.1f} % off the line's {line.baud}"]
