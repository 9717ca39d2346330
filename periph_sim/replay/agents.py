"""The agents of a closed loop: they play the captured controller, and the targets that the firmware does not replace.

    transfers --> CapturedController --> SCL, SDA <-- ScriptedTarget <-- captured answers

The agents can deviate from the capture even if the firmware behaves as captured, for instance because `longest_low`
shortens a pause of the controller. `without_firmware` runs the agents with the captured answers in place of the
firmware. A difference that also occurs in this run is caused by the agents.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

from ..bus.i2c.replayed_sides import I2cPlayer, ScriptedTarget
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.time import Timebase
from ..core.wire import Wire
from ..traces.decode import i2c as decode
from .compare import CONDITIONS, TIMING, Comparison, Divergence, Happened, compare, i2c_words
from .i2c_script import controllers_half, hurried, moves, stretched_answers, usual_hold
from .i2c_setup import HOLD, Played
from .wire_log import WireLog

AGENTS = "the replay's own controller and targets"


@dataclass(frozen=True)
class Plan:
    """The settings with which the agents play a capture.

    own: the addresses of the firmware.
    origin: the tick of the capture's begin.
    longest_low: the maximum time, in positions, for which the controller holds SCL low; None: as captured.
    least_gap: the minimum time, in ticks, between two transfers. After a delay, the controller shortens pauses down to
        it until the transfers begin as captured. None: pauses are as captured, so that all later transfers are delayed.
    """

    part: Played
    own: Sequence[int]
    timebase: Timebase
    origin: int
    longest_low: Fraction | None = None
    least_gap: int | None = None

    @property
    def per_position(self) -> Fraction:
        """The number of ticks from one position of the capture to the next."""
        return self.timebase.per_second / self.part.rate


class CapturedController:
    """Player of the controller's half of each transfer, and of the answers of targets other than the firmware.

    player: makes the edges. begun: number of transfers that have begun. on_end: called after the last transfer.
    """

    def __init__(self, plan: Plan, kernel: Kernel, scl: Wire, sda: Wire, on_end: Callable[[], None]) -> None:
        self.begun = 0
        self.player = I2cPlayer(kernel, scl, sda)
        self._plan = plan
        self._kernel = kernel
        self._on_end = on_end
        self._hold = usual_hold(plan.part.transfers, plan.part.half_sample)
        self._late = 0  # ticks by which the last transfer ended later than captured
        self._cut = 0  # ticks by which `longest_low` has shortened the last transfer
        self._delay = 0  # `delay` of the player at the begin of the last transfer
        answers = plan.part.answers_of_others(plan.own)
        if answers:
            ScriptedTarget(kernel, scl, sda, answers, plan.timebase.ticks(HOLD, "nearest"))

    def go_on(self) -> None:
        """Play the remaining transfers, each when it is due."""
        self._late = max(0, self._late + self.player.delay - self._delay - self._cut)
        self._delay = self.player.delay
        if self.begun == len(self._plan.part.transfers):
            self._on_end()
        else:
            self._kernel.call_at(max(self._due(), self._kernel.now), self._play)

    def _due(self) -> int:
        plan = self._plan
        captured = plan.origin + int(plan.part.transfers[self.begun].phases[0].start.at * plan.per_position)
        if plan.least_gap is None:
            return captured + self._late
        return max(captured, self._kernel.now + plan.least_gap)

    def _play(self) -> None:
        plan = self._plan
        captured = edges = controllers_half(plan.part.transfers[self.begun], self._hold, plan.part.half_sample)
        if plan.longest_low is not None:
            edges = hurried(captured, plan.longest_low, plan.part.step)
        self._cut = int((captured[-1].at - edges[-1].at) * plan.per_position) if edges else 0
        self.begun += 1
        self.player.play(moves(edges, plan.per_position), self.go_on)


def without_firmware(plan: Plan, start: int, end: int, tolerance: Fraction) -> Comparison:
    """Return the comparison for a run of the agents alone, with captured answers in the firmware's place.

    start, end: ticks of the run. tolerance: seconds.
    """
    part, kernel, recorder = plan.part, Kernel(start), Recorder()
    scl, sda = (Wire(kernel, name, recorder) for name in ("SCL", "SDA"))
    log = WireLog(scl, sda)
    answers = stretched_answers(part.transfers, part.long_low, plan.per_position)
    own = {address: answers[address] for address in plan.own if address in answers}
    ScriptedTarget(kernel, scl, sda, own, 1, "firmware")
    CapturedController(plan, kernel, scl, sda, _no_more).go_on()
    kernel.run_until(end)
    events = decode.events(log.capture(plan.timebase, kernel.now), "SCL", "SDA")
    found = i2c_words(events, Fraction(plan.timebase.per_second), plan.origin)
    return compare(i2c_words(part.expected, part.rate), found, tolerance)


def agents_own(outcome: Comparison, alone: Comparison, tolerance: Fraction) -> Comparison:
    """Return the outcome with a cause for each difference that `alone`, the run without the firmware, has, too."""
    return replace(outcome, ranked=tuple(_marked(one, alone.ranked, tolerance) for one in outcome.ranked))


def _marked(one: Divergence, alone: tuple[Divergence, ...], tolerance: Fraction) -> Divergence:
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


def first_judged(outcome: Comparison, times: bool) -> Divergence | None:
    """Return the earliest difference that fails a replay. times: True if differences in time fail it, too."""
    judged = [one for one in outcome.ranked if times or one.kind != TIMING]
    return min(judged, key=lambda one: one.index, default=None)


def asked_once_more(expected: Sequence[Happened], first: Divergence, own: Sequence[int]) -> str:
    """Return why a NACK of the firmware's address is not an error; "" if it may be one.

    expected: events of the capture. Firmware that has answered before, and sends NACK after captured NACKs, is busy for
    longer than the captured target. A controller that polls would repeat, but only the captured polls are played.
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
        f"the firmware does not acknowledge {address} once more where the captured target answers after NACKs: a "
        "controller that polls would repeat, and the replayed one polls as often as in the capture"
    )


def _no_more() -> None:
    """Do nothing after the last transfer."""
