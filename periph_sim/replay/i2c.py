"""An I2C capture against a firmware: the controller's half is played, the firmware's slave reacts for itself.

    capture --decode--> transfers --> controller's half ------> I2cPlayer --> SCL, SDA <--> unit with the firmware
                            |    \\--> other targets' answers --> I2cTarget --^    |
                            v                                                    v
                     events expected  <-------- compare -------->  events decoded from the wires

The comparison shares no code with the agents or the chip: it decodes the wires as it decoded the capture.
A firmware with settings called `address`, `replies`, `asleep` and `busy` is set to answer as the captured target did.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from fractions import Fraction
from time import perf_counter

from ..board.scene import Scene
from ..case.model import Case
from ..core.time import NO_TIME
from ..decode import i2c as decode
from ..formats.capture import Capture
from ..lines.i2c_player import I2cPlayer
from ..lines.i2c_target import Answer, I2cTarget
from ..recording import Subscribe
from . import BadReplay
from .as_target import AsTarget, as_target
from .compare import compare
from .i2c_script import controllers_half, hurried, most_frequent, moves, turns, usual_hold
from .report import Report
from .scenes import alone, settings_of, unit_with
from .wire_log import WireLog
from .words import i2c_words

LEAD = Fraction(1, 1000)  # the firmware starts this long before the capture begins
TAIL = Fraction(1, 10_000)  # the wires are watched this long after the last move
PATIENCE = Fraction(25, 1000)  # SCL held low longer than this ends the replay: SMBus's limit
HOLD = Fraction(300, 10**9)  # of the other targets: UM10204 Table 11, data hold time of a device


class I2cReplay:
    """One capture on one case. first: only so many transfers. addresses: those that are the firmware's.

    longest_low: seconds that the controller holds SCL low at most; None: as long as SCL was low in the capture.

    By default the firmware answers the address that the case sets, else the one the capture asks most often; a
    firmware without a setting `address` answers all. BadCase or BadReplay if it cannot be built; LookupError if
    there is no such channel.
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
    ) -> None:
        if capture.rate is None:
            raise BadReplay(f"{capture.path}: a replay needs a time base and the file states no rate; state the rate")
        found = decode.transfers(capture, scl, sda)
        self._rate = capture.rate
        self._transfers = [transfer for transfer in found if transfer.phases][:first]
        if not self._transfers:
            raise BadReplay(
                f"{capture.path}: no I2C transfer on {scl!r} and {sda!r}; the lines may be mapped the wrong way round"
            )
        self._capture = capture
        self._turns = list(turns(self._transfers))
        self._notes = _before(found) + _shared(capture, scl, sda)
        unit = unit_with(case, "I2C-A")
        self._own = self._addresses(case, unit, addresses)
        offered: dict[str, object] = {}
        forced: dict[str, object] = {}
        if len(self._own) == 1 and "address" in settings_of(case, unit):
            offered = self._as_target(self._own[0])
            forced = {"address": self._own[0]}
        self._scene = scene = Scene(alone(case, unit, "controller", forced, offered), subscribe)
        self.kernel = scene.kernel
        self._origin = scene.start + scene.timebase.ticks(LEAD, "nearest")
        self._per_position = scene.timebase.per_second / capture.rate
        self._log = WireLog(scene.wire("SCL"), scene.wire("SDA"))
        self._player = I2cPlayer(scene.kernel, scene.wire("SCL"), scene.wire("SDA"))
        self._hold = usual_hold(self._transfers)
        self._longest_low = None if longest_low is None else longest_low * capture.rate
        self._next = 0
        self._over = False
        self._others()

    # Who answers what -------------------------------------------------------------

    def _addresses(self, case: Case, unit: str, given: Sequence[int]) -> list[int]:
        if len(given) > 1 and "address" in settings_of(case, unit):
            raise BadReplay(f"firmware {case.unit[unit].firmware} answers one address; {len(given)} are given")
        if given:
            return list(given)
        if "address" not in settings_of(case, unit):
            return sorted({turn.address for turn in self._turns})
        if "address" in case.unit[unit].settings:
            own = case.unit[unit].settings["address"]
            return [own] if isinstance(own, int) else []
        address = most_frequent(self._turns)
        if address is None:
            raise BadReplay(f"{self._capture.path}: no whole address byte; the lines may be mapped the wrong way round")
        return [address]

    def _as_target(self, address: int) -> dict[str, object]:
        last = self._transfers[-1]
        end = max(last.phases[-1].start.at, 0 if last.stop is None else last.stop.at)
        target = as_target(address, self._turns, end + int(self._rate))
        self._notes += _refusals(target)
        answered = [turn.answer.ack for turn in self._turns if turn.address == address]
        if not answered:
            self._notes.append(f"the capture does not ask {address:02X}")
        elif not any(answered):
            self._notes.append(f"nobody acknowledges {address:02X} in the capture: the firmware stays out of reach")
        asleep = Fraction(0) if target.asleep is None else target.asleep / self._rate + LEAD
        return {
            "address": address,
            "replies": target.replies,
            "asleep": asleep,
            "busy": [pause / self._rate for pause in target.busy],
        }

    def _others(self) -> None:
        answers: dict[int, list[Answer]] = defaultdict(list)
        for turn in self._turns:
            if turn.address not in self._own:
                answers[turn.address].append(turn.answer)
        if answers:
            scene = self._scene
            hold = scene.timebase.ticks(HOLD, "nearest")
            I2cTarget(scene.kernel, scene.wire("SCL"), scene.wire("SDA"), answers, hold)
            names = ", ".join(f"{address:02X}" for address in sorted(answers))
            self._notes.append(f"an agent answers for {names}, as captured")

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Play it all and compare."""
        kernel, timebase = self.kernel, self._scene.timebase
        patience = timebase.ticks(PATIENCE, "nearest")
        wall = perf_counter()
        self._plan()
        stuck = ""
        while not self._over and not stuck:
            since = self._player.waiting_since
            kernel.run_until((kernel.now if since == NO_TIME else since) + patience)
            if since != NO_TIME and since == self._player.waiting_since:
                who = " and ".join(self._scene.wire("SCL").held_by())
                stuck = f"SCL is held low by {who} since {timebase.show(since - self._origin)}: the replay ends there"
            if progress is not None:
                progress(self._next / len(self._transfers))
        wall = perf_counter() - wall
        return self._report(wall, [stuck] if stuck else [])

    def _plan(self) -> None:
        """The next transfer when the capture has it, and later by what stretching has cost so far."""
        kernel = self.kernel
        if self._next == len(self._transfers):
            kernel.at(kernel.now + self._scene.timebase.ticks(TAIL, "nearest"), self._end)
            return
        begin = self._transfers[self._next].phases[0].start.at
        due = self._origin + int(begin * self._per_position) + self._player.delay
        kernel.at(max(due, kernel.now), self._play)

    def _play(self) -> None:
        edges = controllers_half(self._transfers[self._next], self._hold)
        if self._longest_low is not None:
            edges = hurried(edges, self._longest_low)
        self._next += 1
        self._player.play(moves(edges, self._per_position), self._plan)

    def _end(self) -> None:
        self._over = True
        self.kernel.stop()

    def _report(self, wall: float, stuck: list[str]) -> Report:
        scene, kernel = self._scene, self.kernel
        result = scene.run(Fraction(0))
        replayed = self._log.capture(scene.timebase, kernel.now)
        events = decode.events(replayed, "SCL", "SDA")
        expected = [event for transfer in self._transfers for event in decode.events_of(transfer)]
        outcome = compare(
            i2c_words(expected, self._rate), i2c_words(events, Fraction(scene.timebase.per_second), self._origin)
        )
        us = Fraction(1_000_000, scene.timebase.per_second)
        return Report(
            case=scene.case.name,
            capture=str(self._capture.path),
            kind="i2c",
            verdict="fail" if outcome.divergence or stuck else "pass",
            events=len(expected),
            agreed=outcome.agreed,
            first_divergence=outcome.divergence,
            bytes=sum(isinstance(event, decode.Address | decode.Data) for event in events),
            addresses=[f"{address:02X}" for address in self._own],
            nacks=sum(isinstance(event, decode.Nack) for event in events),
            stretch_worst_us=float(self._player.longest * us),
            stretch_total_us=float(self._player.delay * us),
            lag_worst_us=float(outcome.lag * 1_000_000),
            simulated_s=float(scene.timebase.seconds(kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=kernel.events,
            unknowns=result.unknowns,
            notes=stuck + self._notes + result.notes,
        )


def _before(found: list[decode.Transfer]) -> list[str]:
    pulses = sum(len(transfer.lead) for transfer in found if not transfer.phases)
    if not pulses:
        return []
    return [f"clock pulses before the capture's first START, of a transfer unknown and not played: {pulses}"]


def _shared(capture: Capture, scl: str | int, sda: str | int) -> list[str]:
    count = decode.shared_edges(capture, scl, sda)
    if not count:
        return []
    return [f"samples with an edge of both lines, where SDA is put half a sample off SCL's edge: {count}"]


def _refusals(target: AsTarget) -> list[str]:
    if not target.refused:
        return []
    return [
        f"refusals of {target.address:02X} that follow neither a write that a STOP ended nor the start, "
        f"so that the firmware is not told of them: {target.refused}"
    ]
