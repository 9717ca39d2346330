"""A capture's I2C transfers as two halves, for agents and for firmware that play one of them.

    decode.i2c transfers --> Moves of SCL and SDA, a list for each     (the controller's half)
                         --> AsMaster: "50 W 00 Sr 50 R 6", the pause before it, or why the F28335 cannot send it
                         --> Turn: address, answer, positions            (the targets' half)
                         --> AsTarget: address, replies, asleep, busy

The controller's half keeps every SCL edge of the capture: the lines do not show who held SCL low, so a stretch of
the captured target becomes the controller's own delay. Of SDA it keeps the controller's decisions: START, STOP,
the bits it sent and the ACKs it gave. If an SDA change shares a sample with an SCL edge, or was not visible to the
controller, it is moved inside the low phase, half a sample or more away from both edges.

If the firmware is the master, a low phase that is much longer than usual is attributed to the target if it lies where a
target may stretch, which is from the ACK of the address on.

If the firmware is the target, consecutive NACKs of its address become an interval in which it does not answer. The
interval begins with the STOP of the write before them, or with the start of the capture. It ends midway between the
last NACK and the START of the first turn that is answered.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from statistics import median

from ..bus.i2c.replayed_sides import Answer, Move
from ..traces.decode.i2c import Bit, Byte, Condition, Party, Phase, Transfer

HALF = Fraction(1, 2)  # half a sample in positions, if a position is one sample


@dataclass(frozen=True, slots=True)
class Turn:
    """One addressed part of a transfer. Times are positions of the capture.

    begin: the START.
    answered: the rise of SCL in the ninth bit of the address.
    stop: the STOP, or None if a repeated START or the end of the capture ended the part.
    """

    address: int
    read: bool
    answer: Answer
    begin: int
    answered: int
    stop: int | None


@dataclass(frozen=True, slots=True)
class Edge:
    """A change of a line by the controller. at: a position of the capture."""

    at: Fraction
    clock: bool
    level: int


def controllers_half(transfer: Transfer, hold: Fraction, half_sample: Fraction = HALF) -> list[Edge]:
    """Return the controller's edges, in order. Arguments are in positions.

    hold: the time from a fall of SCL to a change of SDA where the capture does not show the change.
    half_sample: the minimum distance of a change of SDA from the edges of SCL.
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
    """Return the edges with each low phase of SCL shortened to `longest_low`; later edges move by the removed time.

    The removed time is stretching by the captured target, or a pause of the controller. In the replay, the answering
    party must stretch by itself.

    step: the length of a sample in positions. An edge is exact to within one sample, so a low phase that is too long
    by at most a sample is unchanged; otherwise, these errors would add up over the bits of a transfer.
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
    """Convert edges to moves of an `I2cPlayer`. The time of each edge is rounded down, so errors do not add up."""
    found = []
    last = int(edges[0].at * ticks_per_position)
    for edge in edges:
        tick = int(edge.at * ticks_per_position)
        found.append(Move(tick - last, edge.clock, edge.level))
        last = tick
    return found


def usual_hold(transfers: list[Transfer], half_sample: Fraction = HALF) -> Fraction:
    """Return the median time from a fall of SCL to the controller's change of SDA, in positions.

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
    """Yield every addressed part of the transfers, in order. Parts with an incomplete address are left out."""
    for transfer in transfers:
        for number, phase in enumerate(transfer.phases):
            if not is_addressed(phase):
                continue
            assert phase.address is not None and phase.read is not None
            last = number + 1 == len(transfer.phases)
            stop = transfer.stop.at if last and transfer.stop is not None else None
            ninth = phase.bytes[0].bits[8].at
            yield Turn(phase.address, phase.read, _answer(phase), phase.start.at, ninth, stop)


def is_addressed(phase: Phase) -> bool:
    """Return True if a phase has a whole address byte with its ACK."""
    return phase.address is not None and phase.read is not None and len(phase.bytes[0].bits) >= 9


def most_frequent(of: list[Turn]) -> int | None:
    """Return the address that answered most often, or None if `of` is empty.

    Of addresses that answered equally often, return the one that was most often addressed, then the first.
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
    """Return a byte's value, in which bits that are missing in the capture are ones."""
    value = 0xFF
    for place, bit in enumerate(byte.bits[:8]):
        if not bit.value:
            value &= ~(0x80 >> place)
    return value


class _ControllersHalf:
    """Builder of the edges of one transfer. _fall: the next fall of SCL, or None if the capture does not have it."""

    def __init__(self, hold: Fraction, half_sample: Fraction) -> None:
        self.edges: list[Edge] = []
        self._hold = hold
        self._half_sample = half_sample
        self._fall: int | None = None
        self._rise = -1  # the last rise of SCL
        self._sda = 1

    def bit(self, bit: Bit) -> None:
        ours = bit.driver is Party.CONTROLLER
        self._pulse(bit.at, bit.value if ours else 1, bit.sda if ours else None)
        self._fall = None if bit.high is None else bit.at + bit.high

    def condition(self, condition: Condition, level: int) -> None:
        """Add a START or repeated START (level 0) or a STOP (level 1), with its pulse of SCL, if any.

        level: the level of SDA after the condition.
        """
        if condition.high is not None and condition.at - condition.high > self._rise:
            self._pulse(condition.at - condition.high, 1 - level, None)
        self.toggle(condition, level)

    def toggle(self, condition: Condition, level: int) -> None:
        self._change_sda(Fraction(condition.at), level)
        self._fall = None if condition.hold is None else condition.at + condition.hold

    def cut_off(self) -> None:
        """End a transfer that the end of the capture cuts off: add the last fall of SCL if it was captured."""
        if self._fall is not None:
            self.edges.append(Edge(Fraction(self._fall), True, 0))

    def _pulse(self, rise: int, sda: int, seen_at: int | None) -> None:
        """Add a low phase of SCL that ends at `rise`, in which SDA changes to `sda`.

        seen_at: the position of that change; None if the capture does not show it.
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
    """The settings of firmware that plays a captured target. Times are in positions of the capture."""

    address: int
    replies: list[bytes] = field(default_factory=list)  # the data of each read
    asleep: Fraction | None = None  # the firmware does not answer from the start up to this time
    # For each write that ended in a STOP, how long the firmware does not answer after it.
    busy: list[Fraction] = field(default_factory=list)
    refused: int = 0  # number of NACKs that neither `asleep` nor `busy` can reproduce


def as_target(address: int, turns: Iterable[Turn], end: int) -> AsTarget:
    """Return the settings of firmware that answers one address.

    end: the position up to which the firmware does not answer if the capture ends with NACKs.
    """
    found = AsTarget(address)
    refused: list[Turn] = []
    last: Turn | None = None  # the last answered turn
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
    """The settings of firmware that plays the controller, and the targets' answers.

    script, pauses: one entry for each transfer in `done`; pauses are in positions.
    done: the transfers in the script.
    answers: the answers of the targets, indexed by their addresses.
    left_out: the number of omitted transfers for each reason.
    """

    script: list[str] = field(default_factory=list)
    pauses: list[Fraction] = field(default_factory=list)
    done: list[Transfer] = field(default_factory=list)
    answers: dict[int, list[Answer]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)


def as_master(transfers: list[Transfer], long_low: Fraction, ticks_per_position: Fraction) -> AsMaster:
    """Return the script of the captured controller and the targets' answers. long_low: as for `stretched_answers`."""
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
    phases = [phase for transfer in transfers for phase in transfer.phases if is_addressed(phase)]
    for phase, turn in zip(phases, turns(transfers), strict=True):
        stretches = _stretches(phase, long_low, ticks_per_position)
        answers[turn.address].append(replace(turn.answer, stretches=stretches))
    return answers


def obstacle(transfer: Transfer) -> str:
    """Return why the F28335 as master cannot do a transfer; empty if it can."""
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
