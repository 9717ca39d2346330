"""Closed loop: the controller's half of an I2C capture is played, and the firmware's slave reacts to it.

    capture --decode--> transfers --> agents: controller, other targets --> SCL, SDA <--> unit with the firmware
                            |                                                  |
                            v                                                  v
                     events expected  <-------- compare -------->  events decoded from the wires

The comparison shares no code with the agents or the chip: it decodes the wires like the capture. A difference that the
agents also cause without the firmware is not judged, nor is anything after it. Firmware whose `REPLAY` names `address`,
`replies`, `asleep` and `busy` is set to answer like the captured target.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..scene.case.model import Case
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from ..traces.decode import i2c as decode
from .agents import CapturedController, Plan, agents_own, asked_once_more, first_judged, without_firmware
from .compare import TIMING, Comparison, compare, i2c_words
from .i2c_setup import PATIENCE, STEP, TAIL, Answering, answering, played
from .replay import BusReplay, Progress
from .report import FAIL, NOT_JUDGED, Report, verdict_of
from .scene_setup import LEAD, alone, taken, tolerance_of

if TYPE_CHECKING:
    from ..records.recording import Subscribe


class I2cReplay(BusReplay):
    """Replay of a capture on a case.

    addresses: the addresses of the firmware; if empty, `answering` determines them.
    first: the maximum number of transfers; None for all.
    longest_low: the maximum time, in seconds, for which the controller holds SCL low; None: as captured.
    tolerance: the allowed difference in time, in seconds. None: a sample period plus a cycle; larger differences are
        reported, but not judged.
    lead: the time from the start of the firmware to the begin of the capture, in seconds.
    patience: the maximum time, in seconds, for which SCL may be held low; then the replay ends.

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
        self._repeated = partial(I2cReplay, case, capture, scl, sda, addresses, first, longest_low, patience=patience)
        self._first = first
        self._patience = patience
        part = played(capture, scl, sda, first)
        self._answering = found = answering(case, part, addresses, lead)
        self._filled = taken(case, found.unit, found.offered)
        scene = self._build(case, found, subscribe)
        wires = scene.wire("SCL"), scene.wire("SDA")
        super().__init__(scene, found.unit, lead, part, wires)
        self._tolerance = tolerance
        low = None if longest_low is None else longest_low * part.rate
        self._agents = Plan(part, found.own, scene.timebase, self.origin, low, self._least_gap())
        self._controller = CapturedController(self._agents, scene.kernel, *wires, self._plan_end)
        self._player = self._controller.player
        self._over = False
        others = ", ".join(f"{address:02X}" for address in sorted(part.answers_of_others(found.own)))
        if others:
            part.notes.append(f"an agent answers for {others}, as captured")

    def _build(self, case: Case, found: Answering, subscribe: Subscribe | None) -> Scene:
        return Scene(alone(case, found.unit, "controller", found.forced, found.offered), subscribe)

    def _least_gap(self) -> int | None:
        """Return the minimum gap between transfers, see `Plan`."""
        return None

    # Running ------------------------------------------------------------------------

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        kernel, timebase = self.kernel, self.timebase
        patience = timebase.ticks(self._patience, "nearest")
        step = timebase.ticks(STEP, "nearest")
        self._controller.go_on()
        stuck = ""
        while not self._over and not stuck and (until is None or kernel.now <= until):
            kernel.run_until(kernel.now + min(step, patience - self._player.held(kernel.now)))
            if self._player.held(kernel.now) >= patience:
                who = " and ".join(self._scene.wire("SCL").held_by())
                since = timebase.show(self._player.waiting_since - self.origin)
                stuck = (
                    f"SCL is held low by {who} since {since}: the replay ends there, after "
                    f"{timebase.show(patience)}; --patience sets this limit"
                )
            if progress is not None:
                progress(self._controller.begun / len(self._part.transfers))
        return stuck

    def _plan_end(self) -> None:
        self.kernel.call_at(self._last_tick(), self._end)

    def _last_tick(self) -> int:
        return self.kernel.now + self.timebase.ticks(TAIL, "nearest")

    def _end(self) -> None:
        self._over = True
        self.kernel.stop()

    # Summing up ---------------------------------------------------------------------

    def _report(self, stuck: list[str]) -> Report:
        part, own, now = self._part, self._answering, self.kernel.now
        self._replayed = self.log.capture(self.timebase, now)
        events = decode.events(self._replayed, "SCL", "SDA")
        tolerance = tolerance_of(self._tolerance, part.sample_rate, self._scene)
        found = i2c_words(events, Fraction(self.timebase.per_second), self.origin)
        self._compared = i2c_words(part.expected, part.rate), found
        outcome = self._with_agents(compare(*self._compared, tolerance), tolerance)
        failed = outcome.divergence is not None or (self._tolerance is not None and bool(outcome.ranked))
        verdict = verdict_of(bool(stuck) or failed, bool(own.asked))
        unjudged = own.unjudged
        if verdict == FAIL and not stuck and self._agents_parted:
            verdict, unjudged = NOT_JUDGED, self._agents_parted
        us = Fraction(1_000_000, self.timebase.per_second)
        held = self._player.held(now)
        return self._bus_summary(
            outcome,
            events,
            own.own,
            tolerance,
            stuck + part.notes,
            verdict=verdict,
            unjudged=unjudged,
            transfers=len(part.transfers),
            stretch_worst_us=float(max(self._player.longest, held) * us),
            stretch_total_us=float((self._player.delay + held) * us),
        )

    def _with_agents(self, outcome: Comparison, tolerance: Fraction) -> Comparison:
        """Return the outcome with causes for the differences that the agents also make without the firmware.

        Set `_agents_parted` to the reason why the first judged difference is no error of the firmware; "" if it may be.
        """
        self._agents_parted = ""
        self._other_events = False  # True if that difference is in an event, not in a time, and has such a cause
        if not outcome.ranked:
            return outcome
        alone = without_firmware(self._agents, self._scene.start, self.kernel.now, tolerance)
        outcome = agents_own(outcome, alone, tolerance)
        first = first_judged(outcome, times=self._tolerance is not None)
        if first is not None:
            self._other_events = first.kind != TIMING and bool(first.cause)
            self._agents_parted = first.cause or asked_once_more(self._compared[0], first, self._answering.own)
        return outcome
