"""What every I2C replay begins with: a case and a capture go in; transfers, turns, addresses and settings come out.

capture --decode--> transfers --> turns --> who answers what --> settings of the firmware that answers
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from statistics import median

from ..bus.i2c.scripted_target import Answer
from ..core.counted import counted
from ..scene.case.model import Case
from ..traces.capture.capture import Capture
from ..traces.capture.gaps import gap_notes
from ..traces.capture.sampling import sample_step, stamp_notes
from ..traces.decode import i2c as decode
from ..traces.decode.sampling_rate import impossible_rate
from . import BadReplay
from .as_target import AsTarget, as_target
from .i2c_script import Turn, most_frequent, turns
from .scene_setup import settings_of, undeclared, unit_with
from .time_base import check_length, rate_of

LEAD = Fraction(1, 1000)  # the firmware starts this long before the capture begins
STEP = Fraction(25, 1000)  # simulated seconds from one report of progress to the next
TAIL = Fraction(1, 10_000)  # the wires are watched this long after the last move
PATIENCE = Fraction(200, 1000)  # a replay ends when SCL is held low for longer; an SHT21 stretches for up to 85 ms
BYTE = 9  # bits, with its ACK
LONG = Fraction(3, 2)  # times the usual low phase: a stretch or a pause
HOLD = Fraction(300, 10**9)  # of the other targets: UM10204 Table 11, data hold time of a device


@dataclass
class Played:
    """The part of a capture that a replay plays; it does not change. whole: all its transfers. notes: what of it is not
    played."""

    capture: Capture
    rate: Fraction
    whole: list[decode.Transfer]
    transfers: list[decode.Transfer]
    turns: list[Turn]
    notes: list[str] = field(default_factory=list)

    @property
    def captured_events(self) -> int:
        """Events of the whole capture."""
        return len(events_of(self.whole))

    @cached_property
    def half_sample(self) -> Fraction:
        """Positions. Where two lines change at one position their order is unknown, and one goes so far aside."""
        return Fraction(sample_step(self.capture), 2)

    @cached_property
    def step(self) -> int:
        """Positions from one sample to the next, within which nobody knows when an edge was.

        1 where SCL would be low for less than two samples: then the bus's own raster was taken for an analyser's.
        """
        step = int(2 * self.half_sample)
        return step if self.low >= 2 * step else 1

    @property
    def sample_rate(self) -> Fraction:
        """Samples a second; `rate` is positions a second."""
        return self.rate / self.step

    @cached_property
    def expected(self) -> list[decode.Event]:
        return events_of(self.transfers)

    @cached_property
    def low(self) -> Fraction:
        """How long SCL is low before a bit, as a rule; positions. 0 where no bit shows."""
        lows = [bit.low for bit in self.bits() if bit.low is not None]
        return Fraction(median(lows)) if lows else Fraction(0)

    @cached_property
    def long_low(self) -> Fraction:
        """A low phase before a bit that is longer is a stretch, or a pause of the controller; positions."""
        return max(self.low * LONG, self.low + 2 * self.step)

    @property
    def stretch(self) -> Fraction:
        """How much longer than usual SCL was low before a bit at most, whoever held it; positions."""
        longest = max((bit.low for bit in self.bits() if bit.low is not None), default=0)
        return longest - self.low if longest > self.long_low else Fraction(0)

    @cached_property
    def high(self) -> Fraction:
        """How long SCL is high, as a rule; positions."""
        highs = [bit.high for bit in self.bits() if bit.high is not None]
        return Fraction(median(highs)) if highs else Fraction(0)

    @cached_property
    def bit(self) -> float:
        """Length of a bit, as a rule; seconds."""
        return float((self.low + self.high) / self.rate)

    def bits(self) -> list[decode.Bit]:
        return [
            bit for transfer in self.transfers for phase in transfer.phases for byte in phase.bytes for bit in byte.bits
        ]

    def answers_of_others(self, own: Sequence[int]) -> dict[int, list[Answer]]:
        """What the targets that are not the firmware's answered, by address."""
        answers: dict[int, list[Answer]] = defaultdict(list)
        for turn in self.turns:
            if turn.address not in own:
                answers[turn.address].append(turn.answer)
        return answers


def played(capture: Capture, scl: str | int, sda: str | int, first: int | None = None) -> Played:
    """BadReplay if nothing can be played; LookupError if there is no such channel. first: only so many transfers."""
    rate = rate_of(capture)
    if wrong := impossible_rate(capture, scl):
        raise BadReplay(f"{capture.path}: {wrong}; state the right rate with --rate")
    found = decode.transfers(capture, scl, sda)
    whole = [transfer for transfer in found if transfer.phases]
    wanted = whole[:first]
    if not wanted:
        raise BadReplay(
            f"{capture.path}: no I2C transfer on {scl!r} and {sda!r}; the lines may be mapped the wrong way round"
        )
    last = wanted[-1]
    check_length(capture, capture.length if last.stop is None else last.stop.at)
    notes = _before(found) + _cut(last) + _shared(capture, scl, sda) + stamp_notes(capture)
    notes += gap_notes(capture, capture.channel(scl), capture.channel(sda))
    return Played(capture, rate, whole, wanted, list(turns(wanted)), notes)


def events_of(transfers: Sequence[decode.Transfer]) -> list[decode.Event]:
    """The events of several transfers, in order."""
    return [event for transfer in transfers for event in decode.events_of(transfer)]


@dataclass
class Answering:
    """The unit that stands in for a captured target. own: its addresses. forced, offered: as `alone` takes them.

    asked: how often the capture has one of its addresses acknowledged, and so asks something of the firmware.
    """

    unit: str
    own: list[int]
    asked: int = 0
    forced: dict[str, object] = field(default_factory=dict)
    offered: dict[str, object] = field(default_factory=dict)

    @property
    def unjudged(self) -> str:
        """Why a replay in which nothing differs proves nothing; empty where it does."""
        if self.asked:
            return ""
        addresses = ", ".join(f"{address:02X}" for address in self.own)
        return f"nothing was asked of the firmware, nobody acknowledges {addresses or 'an address'} in the capture"


def answering(case: Case, part: Played, given: Sequence[int], lead: Fraction = LEAD) -> Answering:
    """Whose addresses are the firmware's, and what it must be set to; adds to the notes what it cannot be set to.

    By default the firmware answers the address that the case sets, else the one the capture asks most often; a
    firmware whose `REPLAY` does not name `address` answers all. Where the captured target refused its address the
    firmware is put out of reach, but not if its addresses are given: then it must refuse, or differ from the capture.
    """
    unit = unit_with(case, "I2C-A")
    found = Answering(unit, _addresses(case, unit, part, given))
    own = [turn for turn in part.turns if turn.address in found.own]
    found.asked = sum(turn.answer.ack for turn in own)
    if not own:
        part.notes.append(f"the capture does not ask {', '.join(f'{address:02X}' for address in found.own)}")
    part.notes += undeclared(case, unit, ("address", "replies", "asleep", "busy"))
    if len(found.own) == 1 and "address" in settings_of(case, unit):
        found.offered = _settings(part, found.own[0], lead, in_reach=bool(given))
        found.forced = {"address": found.own[0]}
    return found


def _addresses(case: Case, unit: str, part: Played, given: Sequence[int]) -> list[int]:
    if len(given) > 1 and "address" in settings_of(case, unit):
        raise BadReplay(f"firmware {case.unit[unit].firmware} answers one address; {len(given)} are given")
    if given:
        return list(given)
    if "address" not in settings_of(case, unit):
        return sorted({turn.address for turn in part.turns})
    if "address" in case.unit[unit].settings:
        own = case.unit[unit].settings["address"]
        return [own] if isinstance(own, int) else []
    address = most_frequent(part.turns)
    if address is None:
        raise BadReplay(f"{part.capture.path}: no whole address byte; the lines may be mapped the wrong way round")
    return [address]


def _settings(part: Played, address: int, lead: Fraction, in_reach: bool) -> dict[str, object]:
    last = part.transfers[-1]
    end = max(last.phases[-1].start.at, 0 if last.stop is None else last.stop.at)
    target = as_target(address, part.turns, end + int(part.rate))
    if in_reach:
        return {"replies": target.replies}
    part.notes += _refusals(target)
    answered = [turn.answer.ack for turn in part.turns if turn.address == address]
    if answered and not any(answered):
        part.notes.append(f"nobody acknowledges {address:02X} in the capture: the firmware stays out of reach")
    asleep = Fraction(0) if target.asleep is None else target.asleep / part.rate + lead
    return {
        "replies": target.replies,
        "asleep": asleep,
        "busy": [pause / part.rate for pause in target.busy] if any(target.busy) else [],
    }


def _before(found: list[decode.Transfer]) -> list[str]:
    pulses = sum(len(transfer.lead) for transfer in found if not transfer.phases)
    if not pulses:
        return []
    return [f"clock pulses before the capture's first START, of a transfer unknown and not played: {pulses}"]


def _cut(last: decode.Transfer) -> list[str]:
    """A note on a transfer that the capture does not show to its STOP."""
    if last.stop is not None:
        return []
    phase = last.phases[-1]
    bits = len(phase.bytes[-1].bits) if phase.bytes else 0
    inside = f"in the middle of a byte, after {counted(bits, 'bit')}" if 0 < bits < BYTE else "before a STOP"
    return [f"the capture ends {inside}: what follows in its last transfer is not compared"]


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
