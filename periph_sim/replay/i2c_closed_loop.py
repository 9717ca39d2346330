"""Closed loop: agents play the controller's half of an I2C capture, and the firmware reacts to it as a slave.

    capture --decode--> transfers --> agents: controller, other targets --> SCL, SDA <--> unit with the firmware
                            |                                                  |
                            v                                                  v
                     events expected  <-------- compare -------->  events decoded from the wires

The wires and the capture are decoded by the same code, which the agents and the chip do not use. Firmware that lists
`address`, `replies`, `asleep` and `busy` in `REPLAY` is set to answer like the captured target.

The expected events are those of the capture, without the polls that `CapturedController` removed, and with those that
it added.

The agents can deviate from the capture even if the firmware behaves as captured, for instance because `longest_low`
shortens a pause of the controller. `without_firmware` runs the agents with the captured answers in place of the
firmware. A difference that also occurs in this run is caused by the agents. If the first judged difference is caused by
the agents, and the replay did not end early, the verdict is "not judged", because later differences can be consequences
of the first one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import pairwise
from weakref import WeakMethod

from ..bus.i2c.replayed_sides import ScriptedTarget
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.tolerance import Tolerance
from ..core.wire import Wire
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..traces.capture.capture import Capture
from ..traces.decode import i2c as decode
from .captured_controller import CapturedController, PlaybackPlan
from .i2c_script import stretched_answers, turns
from .picture import LINES
from .polling import busy_bounds, refusals
from .replay import Progress, SlaveReplay
from .report import (
    CONDITIONS,
    FAIL,
    NOT_JUDGED,
    TIMING,
    Comparison,
    Divergence,
    Happened,
    Report,
    compare,
    i2c_words,
    verdict_of,
)
from .setup import LEAD, PATIENCE, STEP, TAIL
from .wire_log import WireLog

AGENTS = "the replay's own controller and targets"


def without_firmware(plan: PlaybackPlan, start: int, end: int, tolerance: Fraction) -> Comparison:
    """Run the agents with the captured answers in place of the firmware, and return the comparison with the capture.

    start, end: the ticks at which the run begins and ends.
    tolerance: the allowed difference in time, in seconds.
    """
    part, kernel, recorder = plan.part, Kernel(start), Recorder()
    scl, sda = (Wire(kernel, name, recorder) for name in ("SCL", "SDA"))
    log = WireLog(scl, sda)
    answers = stretched_answers(part.transfers, part.long_low, plan.per_position)
    own = {address: answers[address] for address in plan.own if address in answers}
    ScriptedTarget(kernel, scl, sda, own, 1, "firmware")
    CapturedController(plan, kernel, scl, sda, lambda: None).go_on()
    kernel.run_until(end)
    events = decode.events(log.capture(plan.timebase, kernel.now), "SCL", "SDA")
    found = i2c_words(events, Fraction(plan.timebase.per_second), plan.origin)
    return compare(i2c_words(part.expected, part.rate), found, tolerance)


def _marked(one: Divergence, alone: tuple[Divergence, ...], tolerance: Fraction) -> Divergence:
    """Return `one`. If it also occurs without the firmware, add a cause that says so.

    one: a divergence of the run with the firmware.
    alone: the divergences of the run without the firmware.
    tolerance: the time in seconds within which divergences of kind TIMING count as the same.
    """
    for other in alone:
        if (one.kind, one.index) != (other.kind, other.index):
            continue
        same, what = one.found == other.found, "this event"
        if one.kind == TIMING:
            both = one.replay_s is not None and other.replay_s is not None
            same, what = both and abs((one.replay_s or 0) - (other.replay_s or 0)) <= float(tolerance), "their time"
        if same:
            return replace(one, cause=f"{AGENTS} also differ in {what} without the firmware")
    return one


def asked_once_more(expected: Sequence[Happened], first: Divergence, own: Sequence[int]) -> str:
    """Return the reason why the first divergence is not an error of the firmware, but one more NACK while it is busy.

    In the capture, a target that has answered before refuses its address at least once, and then acknowledges it. If
    the firmware refuses its address there once more, it is only busy for longer. A real controller would continue to
    poll, but here only the captured polls are played. Return "" for any other divergence.

    expected: the events of the capture.
    first: the first divergence.
    own: the addresses of the firmware.
    """
    if (first.expected, first.found) != ("ACK", "NACK"):
        return ""
    *before, asked = [event.words for event in expected[: first.index] if event.words not in CONDITIONS]
    address = asked.split()[1] if asked.startswith("address ") else ""
    answers = [answer for words, answer in pairwise(before) if words.startswith(f"address {address} ")]
    if not address or int(address, 16) not in own or "ACK" not in answers:
        return ""
    if before[-1] != "NACK" or not before[-2].startswith(f"address {address} "):
        return ""
    return (
        f"the firmware refuses {address} once more than the captured target did: a controller that polls would try "
        "again, but here it polls only as often as in the capture"
    )


class I2cReplay(SlaveReplay):
    """Closed-loop replay of an I2C capture: agents play the controller, and the firmware is a target.

    scl, sda: the names or numbers of the channels.
    addresses: the addresses of the firmware; if empty, `answering` determines them.
    first: the maximum number of transfers; None for all.
    longest_low: the maximum time, in seconds, for which the controller holds SCL low. None: as long as captured.
    tolerance: the allowed difference in time. None: a sample period plus a SYSCLKOUT cycle; larger differences are then
        reported, but they do not make the replay fail.
    lead: the time from the start of the firmware to the beginning of the capture, in seconds.
    patience: the maximum time, in seconds, for which SCL may be held low, and for which the firmware may refuse its
        address where the captured target acknowledged. After a longer time, the replay ends.

    Raise BadCase, BadReplay or another InputError if the replay cannot be built; LookupError if a channel is missing.
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
        tolerance: Tolerance | None = None,
        lead: Fraction = LEAD,
        patience: Fraction = PATIENCE,
    ) -> None:
        self._repeated = partial(I2cReplay, case, capture, scl, sda, addresses, first, longest_low, patience=patience)
        self._patience = patience
        super().__init__(case, capture, scl, sda, addresses, first, subscribe, tolerance, lead)
        part, found, scene = self._part, self._answering, self.scene
        low = None if longest_low is None else longest_low * part.rate
        self._agents = PlaybackPlan(part, found.own, scene.timebase, self.origin, low, self._least_gap())
        wait = None if self._agents.least_gap is not None else scene.timebase.ticks(patience, "nearest")
        # A weak reference: with a strong one, the wires would keep this object and its scene in memory for ever.
        plan_end = WeakMethod(self._plan_end)

        def on_end() -> None:
            if (plan := plan_end()) is not None:
                plan()

        self._controller = CapturedController(self._agents, scene.kernel, *self._wires, on_end, wait)
        self._player = self._controller.player
        self._over = False
        others = ", ".join(f"{address:02X}" for address in sorted(part.answers_of_others(found.own)))
        if others:
            part.notes.append(f"an agent answers for {others}, as captured")

    def _least_gap(self) -> int | None:
        """Return `PlaybackPlan.least_gap`: here None, because pauses keep their captured lengths."""
        return None

    # Running the replay ------------------------------------------------------------------------

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        kernel, timebase = self.kernel, self.timebase
        patience = timebase.ticks(self._patience, "nearest")
        step = timebase.ticks(STEP, "nearest")
        self._controller.go_on()
        stuck = ""
        while not self._over and not stuck and (until is None or kernel.now <= until):
            kernel.run_until(kernel.now + min(step, patience - self._player.held(kernel.now)))
            if self._player.held(kernel.now) >= patience:
                who = " and ".join(self.scene.wire("SCL").held_by())
                since = timebase.show(self._player.waiting_since - self.origin)
                stuck = (
                    f"SCL is held low by {who} since {since}: the replay ends there, after "
                    f"{timebase.show(patience)}; --patience sets this limit"
                )
            if progress is not None:
                progress(1 - len(self._controller.polled.left) / len(self._part.transfers))
        if self._controller.gave_up is not None:
            refused, begun = self._controller.gave_up
            stuck = (
                f"the firmware refuses {refused:02X} where it is acknowledged in the capture, since "
                f"{timebase.show(begun - self.origin)}: the replay ends there, after {timebase.show(patience)}; "
                "--patience sets this limit"
            )
        return stuck

    def _plan_end(self) -> None:
        self.kernel.call_at(self._last_tick(), self._end)

    def _last_tick(self) -> int:
        return self.kernel.now + self.timebase.ticks(TAIL, "nearest")

    def _end(self) -> None:
        self._over = True
        self.kernel.stop()

    # The report ---------------------------------------------------------------------

    def _report(self, stuck: list[str]) -> Report:
        part, own = self._part, self._answering
        events, found = self._decoded()
        polled = self._controller.polled
        self._compared = polled.expected(part.rate), found
        outcome = self._with_agents(compare(*self._compared, self._allowed))
        failed = outcome.divergence is not None or (self._tolerance is not None and bool(outcome.ranked))
        verdict = verdict_of(bool(stuck) or failed, bool(own.asked))
        unjudged = own.unjudged
        if verdict == FAIL and not stuck and self._agents_parted:
            verdict, unjudged = NOT_JUDGED, self._agents_parted
        us = Fraction(1_000_000, self.timebase.per_second)
        held = self._player.held(self.kernel.now)
        replayed = decode.transfers(self._replayed, *LINES)
        return self._bus_summary(
            outcome,
            events,
            own.own,
            self._allowed,
            stuck + part.notes + polled.notes,
            verdict=verdict,
            unjudged=unjudged,
            transfers=len(part.transfers),
            stretch_worst_us=float(max(self._player.longest, held) * us),
            stretch_total_us=float((self._player.delay + held) * us),
            refusals=refusals(replayed, own.own),
            captured_refusals=refusals(part.transfers, own.own),
            busy_us=busy_bounds(replayed, own.own, us),
            captured_busy_us=busy_bounds(part.transfers, own.own, 1_000_000 / part.rate),
        )

    def _with_agents(self, outcome: Comparison) -> Comparison:
        """Run the agents once more without the firmware, and return the outcome with causes of its divergences.

        A divergence that also occurs in this run (see `without_firmware`) gets a cause that says so. If there is no
        divergence, the agents are not run.

        Set `_agents_parted` to the reason why the first judged divergence is certainly not an error of the firmware, or
        to "" if there is no such reason. Divergences of kind TIMING are judged only if a tolerance is given.
        """
        self._agents_parted = ""
        self._other_events = False  # True if the first judged divergence is due to the agents and not TIMING
        if not outcome.ranked:
            return outcome
        played = self._controller.polled.played()
        part = replace(self._part, transfers=played, turns=list(turns(played)))
        agents = replace(self._agents, part=part)
        alone = without_firmware(agents, self.scene.start, self.kernel.now, self._allowed)
        outcome = replace(outcome, ranked=tuple(_marked(one, alone.ranked, self._allowed) for one in outcome.ranked))
        judged = [one for one in outcome.ranked if self._tolerance is not None or one.kind != TIMING]
        first = min(judged, key=lambda one: one.index, default=None)
        if first is not None:
            self._other_events = first.kind != TIMING and bool(first.cause)
            self._agents_parted = first.cause or asked_once_more(self._compared[0], first, self._answering.own)
        return outcome
