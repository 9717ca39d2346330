"""Closed loop: the controller's half of an I2C capture is played, the firmware's slave reacts for itself.

    capture --decode--> transfers --> controller's half ------> I2cPlayer --> SCL, SDA <--> unit with the firmware
                            |    \\--> other targets' answers --> ScriptedTarget --^    |
                            v                                                    v
                     events expected  <-------- compare -------->  events decoded from the wires

The comparison shares no code with the agents or the chip: it decodes the wires as it decoded the capture.
A firmware whose `REPLAY` names `address`, `replies`, `asleep` and `busy` is set to answer as the captured target did.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING

from ..bus.i2c.player import I2cPlayer
from ..bus.i2c.scripted_target import ScriptedTarget
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from ..traces.decode import i2c as decode
from .compare import Comparison, compare
from .divergence_history import CaptureOrigin, with_history
from .event_names import i2c_words
from .history import FlagHistory
from .i2c_script import controllers_half, hurried, moves, usual_hold
from .i2c_setup import HOLD, LEAD, PATIENCE, STEP, TAIL, Answering, answering, played
from .picture import closed_loop_picture
from .report import Report
from .scene_setup import alone, taken
from .tolerance import tolerance_of
from .verdict import verdict_of
from .wire_log import WireLog

if TYPE_CHECKING:
    from ..records.recording import Subscribe


class I2cReplay:
    """One capture on one case. first: only so many transfers. addresses: those that are the firmware's.

    longest_low: seconds that the controller holds SCL low at most; None: as long as SCL was low in the capture.
    tolerance: seconds that an event may be off; None: a sample period and a cycle, which is told but not judged.
    patience: seconds for which SCL may be held low; the replay ends behind them.

    BadCase or BadReplay if it cannot be built; LookupError if there is no such channel.
    """

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        addresses: Sequence[int] = (),
        first: int | None = None,
        longest_low: Fraction | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Fraction | None = None,
        lead: Fraction = LEAD,
        patience: Fraction = PATIENCE,
    ) -> None:
        self._given = (case, capture, scl, sda, addresses, first, longest_low)
        self._first = first
        self._patience = patience
        self._part = part = played(capture, scl, sda, first)
        self._answering = found = answering(case, part, addresses, lead)
        self._scene = scene = self._build(case, found, subscribe)
        self.kernel = scene.kernel
        self.timebase = scene.timebase
        self.origin = scene.start + scene.timebase.ticks(lead, "nearest")
        self._tolerance = tolerance
        self._per_position = scene.timebase.per_second / part.rate
        self.log = WireLog(scene.wire("SCL"), scene.wire("SDA"))
        self._player = I2cPlayer(scene.kernel, scene.wire("SCL"), scene.wire("SDA"))
        self._hold = usual_hold(part.transfers, part.half_sample)
        self._longest_low = None if longest_low is None else longest_low * part.rate
        self._next = 0
        self._over = False
        self._others()

    def _build(self, case: Case, found: Answering, subscribe: Subscribe | None) -> Scene:
        return Scene(alone(case, found.unit, "controller", found.forced, found.offered), subscribe)

    def _others(self) -> None:
        answers = self._part.answers_of_others(self._answering.own)
        if answers:
            scene = self._scene
            hold = scene.timebase.ticks(HOLD, "nearest")
            ScriptedTarget(scene.kernel, scene.wire("SCL"), scene.wire("SDA"), answers, hold)
            names = ", ".join(f"{address:02X}" for address in sorted(answers))
            self._part.notes.append(f"an agent answers for {names}, as captured")

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Play it all and compare."""
        wall = perf_counter()
        stuck = self._drive(progress)
        wall = perf_counter() - wall
        return self._report(wall, [stuck] if stuck else [])

    def _drive(self, progress: Callable[[float], None] | None = None, until: int | None = None) -> str:
        """Play, to the end or up to a tick; returns why it cannot go on, if so."""
        kernel, timebase = self.kernel, self._scene.timebase
        patience = timebase.ticks(self._patience, "nearest")
        step = timebase.ticks(STEP, "nearest")
        self._plan()
        stuck = ""
        while not self._over and not stuck and (until is None or kernel.now <= until):
            kernel.run_until(kernel.now + min(step, patience - self._player.held(kernel.now)))
            if self._player.held(kernel.now) >= patience:
                who = " and ".join(self._scene.wire("SCL").held_by())
                since = timebase.show(self._player.waiting_since - self.origin)
                stuck = (
                    f"SCL is held low by {who} since {since}: the replay ends there, after "
                    f"{timebase.show(patience)}; --patience sets how long it waits"
                )
            if progress is not None:
                progress(self._next / len(self._part.transfers))
        return stuck

    def _plan(self) -> None:
        """The next transfer, or the end."""
        kernel = self.kernel
        if self._next == len(self._part.transfers):
            kernel.at(self._last_tick(), self._end)
        else:
            kernel.at(max(self._due(), kernel.now), self._play)

    def _due(self) -> int:
        """When the capture has the next transfer, and later by what stretching has cost so far."""
        begin = self._part.transfers[self._next].phases[0].start.at
        return self.origin + int(begin * self._per_position) + self._player.delay

    def _last_tick(self) -> int:
        return self.kernel.now + self._scene.timebase.ticks(TAIL, "nearest")

    def _play(self) -> None:
        edges = controllers_half(self._part.transfers[self._next], self._hold, self._part.half_sample)
        if self._longest_low is not None:
            edges = hurried(edges, self._longest_low, self._part.step)
        self._next += 1
        self._player.play(moves(edges, self._per_position), self._plan)

    def _end(self) -> None:
        self._over = True
        self.kernel.stop()

    def _again(self, history: FlagHistory, until: int) -> None:
        I2cReplay(*self._given, subscribe=history.subscribe, patience=self._patience)._drive(until=until)

    # Summing up ---------------------------------------------------------------------

    def _report(self, wall: float, stuck: list[str]) -> Report:
        scene, kernel, part, own = self._scene, self.kernel, self._part, self._answering
        self._result = result = scene.run(Fraction(0))
        replayed = self.log.capture(scene.timebase, kernel.now)
        events = decode.events(replayed, "SCL", "SDA")
        tolerance = tolerance_of(self._tolerance, part.sample_rate, scene)
        self._replayed = replayed
        expected = i2c_words(part.expected, part.rate)
        found = i2c_words(events, Fraction(scene.timebase.per_second), self.origin)
        self._compared = expected, found
        outcome = compare(expected, found, tolerance)
        byte = int(9 * (part.low + part.high) * self._per_position)
        place = CaptureOrigin(scene, self.origin, byte)
        us = Fraction(1_000_000, scene.timebase.per_second)
        held = self._player.held(kernel.now)
        return Report(
            case=scene.case.name,
            capture=str(part.capture.path),
            kind="i2c",
            verdict=verdict_of(bool(stuck) or self._fails(outcome), bool(own.asked)),
            events=len(part.expected),
            agreed=outcome.agreed,
            captured_events=part.captured_events,
            transfers=len(part.transfers),
            captured_transfers=len(part.whole),
            filled=taken(self._given[0], own.unit, own.offered),
            unjudged=own.unjudged,
            first_divergence=outcome.divergence,
            divergences=with_history(outcome.ranked, place, self._answering.unit, "I2C-A", self._again),
            tolerance_us=float(tolerance * 1_000_000),
            bytes=sum(isinstance(event, decode.Address | decode.Data) for event in events),
            addresses=[f"{address:02X}" for address in own.own],
            nacks=sum(isinstance(event, decode.Nack) for event in events),
            captured_stretch_us=float(part.stretch / part.rate * 1_000_000),
            stretch_worst_us=float(max(self._player.longest, held) * us),
            stretch_total_us=float((self._player.delay + held) * us),
            lag_worst_us=float(outcome.lag * 1_000_000),
            lag_samples=float(outcome.lag * part.sample_rate),
            simulated_s=float(scene.timebase.seconds(kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=kernel.events,
            unknowns=result.unknowns,
            notes=stuck + part.notes + result.notes,
        )

    def picture(self, report: Report) -> str | None:
        """The first divergence of a run as SVG text; None without any."""
        return closed_loop_picture(
            report, self._part.capture, self._given[2:4], self._part, self._replayed, self.origin, self._compared
        )

    def _fails(self, outcome: Comparison) -> bool:
        return outcome.divergence is not None or (self._tolerance is not None and bool(outcome.ranked))
