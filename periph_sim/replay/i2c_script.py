"""The two halves of a capture's I2C transfers, the controller's and the targets'. Agents or firmware can play each.

    decode.i2c transfers --> Moves of SCL and SDA, one list per transfer   (the controller's half)
                         --> AsMaster: script ("50 W 00 Sr 50 R 6"), pauses; why transfers are left out
                         --> Turn: address, answer, positions              (the targets' half)
                         --> AsTarget: address, replies, asleep, busy

The controller's half contains all edges of SCL. The capture does not show which party held SCL low, so a stretch of the
captured target becomes a delay of the controller. Of the edges of SDA, this half contains START and STOP, and the
changes for the bits and ACKs that the controller sent. If a change for a bit or an ACK is in the same sample as an edge
of SCL, or is not visible in the capture, it is placed in the low phase of SCL, at least half a sample away from both of
its ends.

If the firmware is the master, low phases that are much longer than usual are repeated by the agents as stretches of the
targets. Long low phases before the eight bits of an address byte are ignored, because no target is selected there.

If the firmware is the target, consecutive NACKs of its address become an interval in which it does not answer. The
interval begins at the STOP of the write before the NACKs, or at the start of the capture. It ends midway between the
last NACK and the START of the next acknowledged turn; without such a turn, it ends after the capture. NACKs after a
read, or after a write without a STOP, cannot be reproduced in this way.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from statistics import median

from ..bus.i2c.replayed_sides import Answer, Move
from ..traces.decode.i2c import Bit, Byte, Condition, Party, Phase, Transfer, number_of

HALF = Fraction(1, 2)  # half a sample in positions, in captures in which each position is a sample


@dataclass(frozen=True, slots=True)
class Turn:
    """A phase of a transfer with a complete address. Times are positions of the capture.

    answer: what the target did in the capture.
    begin: the time of the START or repeated START.
    answered: the time at which SCL rises in the ninth bit of the address.
    stop: the time of the STOP; None if the phase ends with a repeated START or with the capture.
    """

    address: int
    read: bool
    answer: Answer
    begin: int
    answered: int
    stop: int | None


@dataclass(frozen=True, slots=True)
class Edge:
    """A change of a line by the controller. at: the position in the capture. clock: True for SCL, False for SDA."""

    at: Fraction
    clock: bool
    level: int


def controllers_half(transfer: Transfer, hold: Fraction, half_sample: Fraction = HALF) -> list[Edge]:
    """Return the controller's edges of a transfer, in order.

    hold: the time from a falling edge of SCL to a change of SDA, for changes that the capture does not show.
    half_sample: the minimum time between a change of SDA and an edge of SCL.

    Both times are in positions.
    """
    half = _ControllersHalf(hold, half_sample)
    for number, phase in enumerate(transfer.phases):
        if not number:
            half.toggle(phase.start, 0)
        for byte in phase.bytes:
            for bit in byte.bits:
                half.bit(bit)
        if number + 1 < len(transfer.phases):
            half.condition(transfer.phases[number + 1].start, 0)
        elif transfer.stop is not None:
            half.condition(transfer.stop, 1)
        else:
            half.cut_off()
    return half.edges


def hurried(edges: list[Edge], longest_low: Fraction, step: int = 0) -> list[Edge]:
    """Return the edges with low phases of SCL shortened to `longest_low`, and later edges moved by the removed time.

    The removed time is a stretch of the captured target, or a pause of the controller. In the replay, the firmware that
    replaces the target stretches SCL by itself.

    step: the number of positions per sample. A low phase that is too long by at most one sample is not shortened,
        because this may be a sampling error. Such errors would add up over the bits of a transfer.
    """
    found: list[Edge] = []
    cut = Fraction(0)
    for number, edge in enumerate(edges):
        at = edge.at - cut
        if edge.clock and edge.level and number:
            fall = next((e.at for e in reversed(found) if e.clock and not e.level), at)
            if at - fall > longest_low + step:
                cut += at - fall - longest_low
                at = fall + longest_low
                if not found[-1].clock and found[-1].at > fall + longest_low / 2:
                    found[-1] = replace(found[-1], at=fall + longest_low / 2)
        found.append(replace(edge, at=at))
    return found


def moves(edges: list[Edge], ticks_per_position: Fraction) -> list[Move]:
    """Convert edges to moves of an `I2cPlayer`.

    The time of each edge, not the distance of two edges, is rounded down to a tick, so that errors do not add up.
    """
    found = []
    last = int(edges[0].at * ticks_per_position)
    for edge in edges:
        tick = int(edge.at * ticks_per_position)
        found.append(Move(tick - last, edge.clock, edge.level))
        last = tick
    return found


def usual_hold(transfers: list[Transfer], half_sample: Fraction = HALF) -> Fraction:
    """Return the median time, in positions, from a falling edge of SCL to the controller's change of SDA.

    half_sample: the result if the capture shows no such change.
    """
    seen = [
        bit.sda - (bit.at - bit.low)
        for transfer in transfers
        for phase in transfer.phases
        for byte in phase.bytes
        for bit in byte.bits
        if bit.driver is Party.CONTROLLER and bit.sda is not None and bit.low is not None
    ]
    return Fraction(median(seen)) if seen else half_sample


def turns(transfers: list[Transfer]) -> Iterator[Turn]:
    """Yield the phases of the transfers as turns, in order. Phases with an incomplete address are left out."""
    for phase, stop in addressed_phases(transfers):
        assert phase.address is not None and phase.read is not None
        ninth = phase.bytes[0].bits[8].at
        yield Turn(phase.address, phase.read, _answer(phase), phase.start.at, ninth, None if stop is None else stop.at)


def addressed_phases(transfers: Iterable[Transfer]) -> Iterator[tuple[Phase, Condition | None]]:
    """Yield each phase that has a complete address byte with its ACK or NACK, whichever target is addressed.

    Each phase is paired with the STOP that ends it; None if the phase ends with a repeated START or with the capture.
    """
    for transfer in transfers:
        for number, phase in enumerate(transfer.phases, 1):
            if is_addressed(phase):
                yield phase, transfer.stop if number == len(transfer.phases) else None


def is_addressed(phase: Phase) -> bool:
    """Return True if a phase has a whole address byte with its ACK or NACK."""
    return phase.address is not None and phase.read is not None and len(phase.bytes[0].bits) >= 9


def most_frequent(of: list[Turn]) -> int | None:
    """Return the address that was acknowledged most often; None if `of` is empty.

    Of addresses that were acknowledged equally often, return the one that was sent most often, or else the first.
    """
    asked = Counter(turn.address for turn in of)
    answered = Counter(turn.address for turn in of if turn.answer.ack)
    return max(asked, key=lambda address: (answered[address], asked[address]), default=None)


def _answer(phase: Phase) -> Answer:
    ack = bool(phase.bytes[0].acked)
    if phase.read:
        return Answer(ack, bytes(_value(byte) for byte in phase.bytes[1:]))
    return Answer(ack, acks=tuple(byte.acked is not False for byte in phase.bytes[1:]))


def _value(byte: Byte) -> int:
    """Return the value of a byte. Bits that are missing in the capture are 1."""
    sent = byte.bits[:8]
    return (number_of(sent) + 1 << 8 - len(sent)) - 1


class _ControllersHalf:
    """Builder of the controller's edges of one transfer.

    _fall: the position of the next falling edge of SCL; None if it was not captured.
    """

    def __init__(self, hold: Fraction, half_sample: Fraction) -> None:
        self.edges: list[Edge] = []
        self._hold = hold
        self._half_sample = half_sample
        self._fall: int | None = None
        self._rise = -1  # the position of the last rising edge of SCL; -1 before the first
        self._sda = 1

    def bit(self, bit: Bit) -> None:
        ours = bit.driver is Party.CONTROLLER
        self._pulse(bit.at, bit.value if ours else 1, bit.sda if ours else None)
        self._fall = None if bit.high is None else bit.at + bit.high

    def condition(self, condition: Condition, level: int) -> None:
        """Add a repeated START or a STOP. If SCL rose once more after the last bit, add the low phase before it, too.

        level: the level of SDA after the condition: 0 after repeated START, 1 after STOP.
        """
        if condition.high is not None and condition.at - condition.high > self._rise:
            self._pulse(condition.at - condition.high, 1 - level, None)
        self.toggle(condition, level)

    def toggle(self, condition: Condition, level: int) -> None:
        self._change_sda(Fraction(condition.at), level)
        self._fall = None if condition.hold is None else condition.at + condition.hold

    def cut_off(self) -> None:
        """End a transfer that is cut off by the end of the capture. Add SCL's last falling edge if it was captured."""
        if self._fall is not None:
            self.edges.append(Edge(Fraction(self._fall), True, 0))

    def _pulse(self, rise: int, sda: int, seen_at: int | None) -> None:
        """Add a low phase of SCL that ends at `rise`, in which SDA takes the level `sda`.

        seen_at: the position of the change of SDA; None if the capture does not show it.

        If the beginning of the low phase was not captured, add only the rising edge of SCL.
        """
        if self._fall is not None:
            self.edges.append(Edge(Fraction(self._fall), True, 0))
            at = self._fall + self._hold if seen_at is None else Fraction(seen_at)
            first, last = self._fall + self._half_sample, rise - self._half_sample
            self._change_sda(max(first, min(at, last)), sda)
        self.edges.append(Edge(Fraction(rise), True, 1))
        self._rise = rise

    def _change_sda(self, at: Fraction, level: int) -> None:
        if level != self._sda:
            self._sda = level
            self.edges.append(Edge(at, False, level))


@dataclass
class AsTarget:
    """The settings of firmware that replaces a captured target. Times are in positions of the capture."""

    address: int
    replies: list[bytes] = field(default_factory=list)  # the data of each acknowledged read
    asleep: Fraction | None = None  # the firmware does not answer from the start up to this time; None: it answers
    # For each acknowledged write that ends in a STOP: the time after the STOP for which the firmware does not answer.
    busy: list[Fraction] = field(default_factory=list)
    refused: int = 0  # number of NACKs that neither `asleep` nor `busy` can reproduce


def as_target(address: int, turns: Iterable[Turn], end: int) -> AsTarget:
    """Return the settings with which firmware answers like the captured target at this address.

    end: a position after all turns. If the last turns were not acknowledged, the last interval without answers ends
        there.
    """
    found = AsTarget(address)
    refused: list[Turn] = []
    last: Turn | None = None  # the last turn that was acknowledged
    for turn in turns:
        if turn.address != address:
            continue
        if not turn.answer.ack:
            refused.append(turn)
            continue
        if refused:
            _out_of_reach(found, last, refused, Fraction(refused[-1].answered + turn.begin, 2))
            refused = []
        last = turn
        if turn.read:
            found.replies.append(turn.answer.data)
        elif turn.stop is not None:
            found.busy.append(Fraction(0))
    if refused:
        _out_of_reach(found, last, refused, Fraction(end))
    return found


def _out_of_reach(found: AsTarget, after: Turn | None, refused: list[Turn], until: Fraction) -> None:
    if after is None:
        found.asleep = until
    elif not after.read and after.stop is not None:
        found.busy[-1] = until - after.stop
    else:
        found.refused += len(refused)


CUT = "the capture, or its known part, ends before their STOP"
BROKEN = "the controller broke off a byte with a repeated START or STOP"
EMPTY = "START without an address byte"
NO_DATA = "a read of no byte, whose address was acknowledged"
AGAINST = "the controller continued after a NACK"


@dataclass
class AsMaster:
    """The settings of firmware that replaces the captured controller, and the targets' answers.

    script: the text of each transfer in `done`, such as "50 W 00 Sr 50 R 6".
    pauses: the pause before each transfer in `done`, in positions: from the STOP of the previous transfer in `done`, or
        from the beginning of the capture, to the START.
    done: the transfers that the firmware can repeat.
    answers: the answers of the targets, by address.
    left_out: the number of omitted transfers for each reason that `obstacle` returned.
    """

    script: list[str] = field(default_factory=list)
    pauses: list[Fraction] = field(default_factory=list)
    done: list[Transfer] = field(default_factory=list)
    answers: dict[int, list[Answer]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)


def as_master(transfers: list[Transfer], long_low: Fraction, ticks_per_position: Fraction) -> AsMaster:
    """Return the script of the captured controller and the targets' answers.

    long_low: the limit, in positions, above which a low phase of SCL is a stretch.
    """
    found = AsMaster()
    over: int | None = None
    for transfer in transfers:
        why = obstacle(transfer)
        if why:
            found.left_out[why] = found.left_out.get(why, 0) + 1
            continue
        begin = transfer.phases[0].start.at
        found.pauses.append(Fraction(begin if over is None else begin - over))
        over = None if transfer.stop is None else transfer.stop.at
        found.script.append(" Sr ".join(_text(phase) for phase in transfer.phases))
        found.done.append(transfer)
    found.answers = stretched_answers(found.done, long_low, ticks_per_position)
    return found


def stretched_answers(
    transfers: list[Transfer], long_low: Fraction, ticks_per_position: Fraction
) -> dict[int, list[Answer]]:
    """Return the targets' answers with their stretches, indexed by address.

    long_low: the limit, in positions, above which a low phase of SCL is a stretch.
    """
    answers: dict[int, list[Answer]] = defaultdict(list)
    for (phase, _), turn in zip(addressed_phases(transfers), turns(transfers), strict=True):
        stretches = _stretches(phase, long_low, ticks_per_position)
        answers[turn.address].append(replace(turn.answer, stretches=stretches))
    return answers


def obstacle(transfer: Transfer) -> str:
    """Return the reason why the F28335 as master cannot do a transfer; "" if it can."""
    if transfer.stop is None:
        return CUT
    for phase in transfer.phases:
        if not phase.bytes:
            return EMPTY
        if any(byte.acked is False for byte in phase.bytes[:-1]):
            return AGAINST
        if any(byte.acked is None for byte in phase.bytes):
            return BROKEN
        if phase.read and len(phase.bytes) == 1 and phase.bytes[0].acked:
            return NO_DATA
    return ""


def _text(phase: Phase) -> str:
    assert phase.address is not None
    data = phase.data
    if phase.read:
        return f"{phase.address:02X} R {len(data)}" + (" ACK" if data and phase.bytes[-1].acked else "")
    return " ".join([f"{phase.address:02X} W", *(f"{byte:02X}" for byte in data)])


def _stretches(phase: Phase, long_low: Fraction, ticks_per_position: Fraction) -> tuple[tuple[int, int, int], ...]:
    found = []
    for number, byte in enumerate(phase.bytes, -1):
        for place, bit in enumerate(byte.bits):
            if bit.low is not None and (number >= 0 or place == 8) and bit.low > long_low:
                found.append((number, place, int(bit.low * ticks_per_position)))
    return tuple(found)
