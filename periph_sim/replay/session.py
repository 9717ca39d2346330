"""Replay of a session: an I2C capture and a UART capture are played at the same time, and budgets are judged.

    SCL, SDA --closed loop--> I2cPlayer --> bus <--> unit --> budgets: response time, clock stretch, overruns ...
    RX ---------open loop---> EdgePlayer --> SCI-A --^             ^--- transfers on the bus; frames of the capture

The controller keeps the times of the capture. If a stretch delays a transfer, the next pauses are shortened until
transfers begin at their captured times again. The host does not wait for the firmware, so the edges of RX keep their
times.

The case describes the transfers (requests) that a controller repeats in each period. A round is one execution of these
requests. A round is due one period after the previous one. If a capture has no complete round, budgets on rounds are
not judged, and notes in the report name them.

A frame is a fixed number of bytes that the host sends together. A shorter frame, which a pause on RX ends, is ignored.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

from ..bus.i2c.line_observers import WHO
from ..bus.i2c.transfer import Transfer
from ..core.records import Kind
from ..core.tolerance import Tolerance
from ..devices.host_frames import host_frames
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..scene.uart_lines import line_of
from ..timing.budgets import BudgetJudge
from ..timing.verdict import Verdict
from ..traces.capture.capture import Capture
from ..traces.decode import uart
from .doubtful_frames import line_errors
from .i2c_closed_loop import I2cReplay
from .replay import Progress
from .report import FAIL, NOT_JUDGED, PASS, Report
from .setup import LEAD, PATIENCE, TAIL, check_length, rate_of, unit_with
from .uart import play_line

OF_ROUNDS = ("round", "missed rounds", "nacked rounds", "slack")
PAUSE = 2  # maximum pause on RX within a frame, in character times

OnFrame = Callable[[int, tuple[int, ...], int], None]


class SessionScene(Scene):
    """A scene whose agents replay captures. Its transfers and frames are passed to the measures of budgets."""

    def __init__(self, case: Case, subscribe: Subscribe | None) -> None:
        self.frame_callbacks: list[OnFrame] = []
        super().__init__(case, subscribe)
        self.others: list[Transfer] = []
        self.bus.rounds.on_other.append(self.others.append)

    def _check_needs(self, entry: int, limit: BudgetJudge) -> None:
        """Accept every budget. The captures replace the controller and the host that a budget may need."""

    def on_frame(self, callback: OnFrame) -> None:
        self.frame_callbacks.append(callback)

    def report_frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        for callback in self.frame_callbacks:
            callback(number, values, tick)


class SessionReplay(I2cReplay):
    """Replay of an I2C capture and a UART capture at the same time.

    serial, rx: the UART capture, and the name or number of its channel.
    offset: seconds from the beginning of the I2C capture to that of the UART capture; negative if the UART capture
        begins first.
    wanted: the line format with which RX is decoded; None for the format to which the firmware sets the SCI.
    The other arguments are those of `I2cReplay`.
    """

    KIND = "session"

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        serial: Capture,
        rx: str | int,
        offset: Fraction = Fraction(0),
        wanted: uart.Line | None = None,
        addresses: Sequence[int] = (),
        first: int | None = None,
        longest_low: Fraction | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Tolerance | None = None,
        patience: Fraction = PATIENCE,
    ) -> None:
        self._serial_rate = rate_of(serial)
        check_length(serial, serial.length)
        self._wanted = wanted
        self._serial, self._rx = serial, serial.channel(rx).index
        self._serial_doubt = ""
        lead = LEAD + max(Fraction(0), -offset)
        super().__init__(case, capture, scl, sda, addresses, first, longest_low, subscribe, tolerance, lead, patience)
        given = (case, capture, scl, sda, serial, rx, offset, wanted, addresses, first, longest_low)
        self._repeated = partial(SessionReplay, *given, patience=patience)
        scene = self._session_scene
        self._serial_origin = self.origin + scene.timebase.ticks(abs(offset), "nearest") * (1 if offset >= 0 else -1)
        self._part.notes += play_line(scene, serial, self._rx, self._serial_origin)
        scene.bus.before.append(self._expect)
        self._whole = iter([transfer for transfer in self._part.transfers if transfer.stop is not None])
        scene.kernel.call_at(self._serial_origin, self._plan_frames)
        if longest_low is None:
            self._part.notes.append(
                "the controller holds SCL low as long as in the capture, so a shorter stretch by the firmware is not "
                "visible; --longest-low TIME shortens these low phases"
            )

    def _build(self, case: Case, prepared: Case, subscribe: Subscribe | None) -> Scene:
        serial_unit, unit = unit_with(case, "SCI-A"), self._answering.unit
        if serial_unit != unit:
            raise case.mistake(f"SCI-A is in unit {serial_unit}, I2C-A in {unit}; a session drives one", "unit")
        rounds = case.rounds if case.controller is None else case.controller.as_rounds()
        prepared = prepared.model_copy(update={"host": None, "budget": case.budget, "rounds": rounds})
        self._session_scene = SessionScene(prepared, subscribe)
        return self._session_scene

    def _expect(self, transfer: Transfer) -> None:
        """Store the captured bytes as those that the reads of a transfer should return (`Phase.expect`).

        If the case compares reads with host frames, nothing is stored.
        """
        captured = next(self._whole, None)
        if captured is not None and not self._session_scene.case.checks_host:
            for phase, was in zip(transfer.phases, captured.phases, strict=False):
                phase.expect = bytes(was.data) if phase.read else None

    # Frames of the host, decoded from RX ---------------------------------------------------------------

    def _plan_frames(self) -> None:
        """Decode RX to bytes, and group these to host frames (see the head of this module).

        Each complete host frame is reported to the scene at the end of the last stop bit of its last byte.

        RX is decoded in the format `wanted`, or in the format of the SCI if `wanted` is None.
        """
        scene = self._session_scene
        dsp = scene.units[self._answering.unit]
        line = line_of(dsp) if self._wanted is None else self._wanted
        words = uart.events(self._serial, self._rx, line)
        self._serial_doubt = line_errors(self._serial, self._rx, line, words)[1]
        frames = [word for word in words if word.kind is uart.UartRowKind.FRAME]
        per_position = scene.timebase.per_second / self._serial_rate
        character = line.frame * scene.timebase.per_second / Fraction(line.baud)
        kind, pause = host_frames(), (1 + PAUSE) * character / per_position
        for number, burst in enumerate(_bursts(frames, pause, kind.FRAME_BYTES)):
            data = bytes(word.value for word in burst)
            if len(data) != kind.FRAME_BYTES:
                continue
            tick = self._serial_origin + int(burst[-1].at * per_position + character)
            scene.kernel.call_at(tick, partial(scene.report_frame, number, kind.decode(data), tick))

    # Running the replay ------------------------------------------------------------------------

    def _least_gap(self) -> int:
        """Return the shortest gap between two captured transfers, in ticks.

        To make up for a delay, the controller shortens gaps, but not below this one.
        """
        gaps = [transfer.gap for transfer in self._part.transfers if transfer.gap is not None]
        return int(min(gaps, default=0) * self._per_position)

    def _last_tick(self) -> int:
        soon = self.kernel.now + self.scene.timebase.ticks(TAIL, "nearest")
        if self._first is not None:
            return soon
        serial = self._serial_origin + int(self._serial.length * self.scene.timebase.per_second / self._serial_rate)
        return max(soon, serial, self.origin + int(self._part.capture.length * self._per_position))

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        stuck = super()._drive(progress, until)
        if stuck:
            # A simulated controller emits the same record if it waits too long for SCL.
            self.scene.recorder.emit(self.kernel.now, Kind.BUS, WHO, "stuck")
        return stuck

    def _report(self, stuck: list[str]) -> Report:
        report = super()._report(stuck)
        out = () if self._session_scene.bus.rounds.completed else OF_ROUNDS
        judged = [self._since_capture(v) for v in self._result.budgets if v.measure not in out]
        left_out = [verdict for verdict in self._result.budgets if verdict.measure in out]
        report.budgets = judged
        report.notes = [
            *report.notes,
            *self._other_transfers(),
            *(
                f"budget {verdict.name!r} is not judged: {verdict.measure!r} needs rounds of the case's requests, "
                "and the capture has none"
                for verdict in left_out
            ),
        ]
        if not all(verdict.passed for verdict in judged) and not self._other_events:
            report.verdict = FAIL
        if self._serial_doubt:
            if report.verdict == PASS:
                report.verdict, report.unjudged = NOT_JUDGED, f"RX: {self._serial_doubt}"
            else:
                report.notes.insert(0, f"RX: {self._serial_doubt}")
        return report

    def _other_transfers(self) -> list[str]:
        """Return a list with a note on captured transfers that match no request of the case; empty if there are none.

        If the capture has no complete round, rounds are not judged, and the list is empty, too.
        """
        scene = self._session_scene
        if not scene.others or not scene.bus.rounds.completed:
            return []
        first = scene.others[0].phases[0]
        at = float(scene.timebase.seconds(first.start_at - self.origin))
        does = "reads from" if first.read else f"writes {first.data.hex(' ') or 'nothing'} to"
        return [
            "transfers of the capture that are none of the case's requests, so that a round that needs them counts as "
            f"missed: {len(scene.others)}; the first, at {at:.6f} s, {does} 0x{first.address:02X}"
        ]

    def _since_capture(self, verdict: Verdict) -> Verdict:
        """Return the verdict with its time counted from the beginning of the capture."""
        if verdict.at_s is None:
            return verdict
        scene = self._session_scene
        lead = scene.timebase.seconds(self.origin - scene.start)
        return replace(verdict, at_s=float(round(Fraction(verdict.at_s) - lead, 9)))


def _bursts(words: list[uart.Event], pause: Fraction, most: int) -> list[list[uart.Event]]:
    """Group words into host frames of at most `most` words.

    A frame also ends if more than `pause` positions pass from a start bit to the next one.
    """
    found: list[list[uart.Event]] = []
    last: uart.Event | None = None
    for word in words:
        if last is None or word.at - last.at > pause or len(found[-1]) == most:
            found.append([])
        found[-1].append(word)
        last = word
    return found
