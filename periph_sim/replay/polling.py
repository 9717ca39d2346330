"""Adaptation of the controller's polls of a busy target to the answers of the firmware.

    captured transfers --> PolledCapture --> transfers to play
    answer of the firmware to its address --^      |--> expected events: the captured ones, with polls added or removed

A poll is an address without data that is not acknowledged. A target may be busy after a write with data that a STOP
ends. Polls are added and removed only from such a write up to the next acknowledged address of the firmware:

- If the firmware acknowledges a poll that the captured target refused, the remaining polls are removed. The controller
  continues with the access for which it polled, or stops if the capture ends before this access.
- If the firmware refuses an access that the captured target acknowledged, a poll is added. The controller does what it
  did after a captured poll of the same address byte, and repeats the access after the captured wait. If there is no
  such poll in the capture, no poll is added.

Any other difference is an error.

Later transfers keep their distances, so they move by the time of the added or removed polls. Positions in adapted
transfers are those of the capture, plus this time.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from ..traces.decode.i2c import Byte, Condition, Phase, Transfer, events_of
from .i2c_script import addressed_phases, is_addressed
from .report import Happened, i2c_words


class _Poll(NamedTuple):
    """A captured poll after which the controller repeated the address.

    stop: the STOP after the poll; None if a repeated START follows.
    repeated: the START of the repetition.
    """

    phase: Phase
    stop: Condition | None
    repeated: Condition


class PolledCapture:
    """The transfers of a capture, with polls added or removed to fit the firmware's answers to its address.

    own: the addresses of the firmware.

    transfers: the transfers that have begun, as they are played.
    left: the captured transfers that have not begun.
    notes: a note, if the firmware has acknowledged a poll, but the captured target does not answer before the capture
        ends; otherwise empty.
    """

    def __init__(self, captured: Sequence[Transfer], own: Sequence[int]) -> None:
        self.transfers: list[Transfer] = []
        self.left = deque(captured)
        self.notes: list[str] = []
        self._shift = 0  # positions by which the transfers in `left` move
        # The captured transfer in progress. After polls were added or removed, it is only the part still to be played.
        self._captured = Transfer((), None, None)
        # Events after position `_from[i]`, up to position `_from[i + 1]`, are `_shifts[i]` later than in the capture.
        self._from: list[int] = [-1]
        self._shifts: list[int] = [0]
        self._polls: dict[tuple[int | None, bool | None], list[_Poll]] = {}
        # Positions, in the capture, of the STARTs of the accesses during which the target may be busy.
        self._may_be_busy: set[int] = set()
        self._find_polls(captured, own)

    def _find_polls(self, captured: Sequence[Transfer], own: Sequence[int]) -> None:
        stored = False
        before: _Poll | None = None
        for transfer in captured:
            for number, phase in enumerate(transfer.phases):
                if before is not None and before.phase.bytes[0].value == _value(phase):
                    poll = before._replace(repeated=phase.start)
                    self._polls.setdefault((phase.address, phase.read), []).append(poll)
                before = None
                if not is_addressed(phase) or phase.address not in own:
                    continue
                if stored:
                    self._may_be_busy.add(phase.start.at)
                last = number + 1 == len(transfer.phases)
                stop = transfer.stop if last else None
                if is_poll(phase):
                    before = _Poll(phase, stop, phase.start)
                else:
                    stored = not phase.read and bool(phase.data) and stop is not None

    def begin(self) -> Transfer:
        """Begin the next transfer and return it."""
        self._captured = self.left.popleft()
        self.transfers.append(_moved(self._captured, self._shift))
        return self.transfers[-1]

    @property
    def next_start(self) -> int:
        return self.left[0].phases[0].start.at + self._shift

    def answered(self, number: int, acked: bool) -> bool:
        """Adapt the transfer in progress to the firmware's answer to an address.

        Return True if the transfer was changed, because a poll was added or polls were removed. If the answer is that
        of the capture, or if it is an error of the firmware, return False and do not change the transfer.

        number: the index of the phase of this transfer that has the address.
        acked: True if the firmware acknowledged the address.
        """
        phase = self.transfers[-1].phases[number]
        if acked == phase.bytes[0].acked or self._rest(number)[0].start.at not in self._may_be_busy:
            return False
        return self._remove_polls(number) if acked else self._add_poll(number)

    def _remove_polls(self, number: int) -> bool:
        current = self.transfers[-1]
        poll, rest = current.phases[number], self._rest(number)
        if not is_poll(poll):
            return False
        sources = [Transfer(rest, self._captured.stop, None), *self.left]
        phases = [(skipped, place) for skipped, one in enumerate(sources) for place in range(len(one.phases))]
        if not is_addressed(sources[phases[-1][0]].phases[phases[-1][1]]):
            phases.pop()  # the last phase is ignored, because the capture ends within its address
        for skipped, place in phases:
            phase = sources[skipped].phases[place]
            if _value(phase) != poll.bytes[0].value or not (phase.bytes[0].acked or is_poll(phase)):
                return False
            if phase.bytes[0].acked:
                for _ in range(skipped):
                    self.left.popleft()
                self._continue_at(number, sources[skipped], place)
                return True
        self.left.clear()
        self._continue_at(number, _acknowledged(sources[phases[-1][0]], phases[-1][1]), phases[-1][1])
        self.notes.append(
            f"the firmware answers a poll of {poll.address:02X}, but the capture ends before the captured target "
            "answers: the remaining polls are not played"
        )
        return True

    def _continue_at(self, number: int, source: Transfer, place: int) -> None:
        """Replace the end of the last transfer, from the ACK bit of phase `number` on, by that of a captured transfer.

        source: the captured transfer, which is used from the ACK bit of its phase `place` on.
        """
        current = self.transfers[-1]
        poll, phase = current.phases[number], source.phases[place]
        ninth = poll.bytes[0].bits[8]
        self._shift = ninth.at - phase.bytes[0].bits[8].at
        self._hold_from(ninth.at, self._shift)
        self._captured = Transfer(source.phases[place:], source.stop, None)
        moved = _moved(self._captured, self._shift)
        address = _with_ninth(poll.bytes[0], moved.phases[0].bytes[0])
        first = replace(moved.phases[0], start=poll.start, bytes=(address, *moved.phases[0].bytes[1:]))
        phases = (*current.phases[:number], first, *moved.phases[1:])
        self.transfers[-1] = replace(current, phases=phases, stop=moved.stop)

    def _add_poll(self, number: int) -> bool:
        current = self.transfers[-1]
        phase, rest = current.phases[number], self._rest(number)
        pattern = self._pattern(rest[0])
        if pattern is None:
            return False
        ninth = phase.bytes[0].bits[8].at
        offset = ninth - pattern.phase.bytes[0].bits[8].at
        self._shift = pattern.repeated.at + offset - rest[0].start.at
        self._hold_from(ninth, offset)
        self._hold_from(pattern.repeated.at + offset - 1, self._shift)
        moved = _moved_phase(pattern.phase, offset)
        address = _with_ninth(phase.bytes[0], moved.bytes[0])
        poll = replace(moved, start=phase.start, bytes=(address, *moved.bytes[1:]))
        start = rest[0].start._replace(low=pattern.repeated.low, high=pattern.repeated.high)
        end = Transfer((replace(rest[0], start=start), *rest[1:]), self._captured.stop, None)
        played = (*current.phases[:number], poll)
        if pattern.stop is None:
            self._captured = end
            after = _moved(end, self._shift)
            self.transfers[-1] = replace(current, phases=played + after.phases, stop=after.stop)
        else:
            self.left.appendleft(end)
            self._captured = Transfer((), None, None)
            self.transfers[-1] = replace(current, phases=played, stop=_moved_condition(pattern.stop, offset))
        return True

    def _pattern(self, access: Phase) -> _Poll | None:
        """Return the captured poll to repeat before a captured access.

        This is the last poll with the same address byte before the access, or else the first one after it. None if the
        capture has no such poll.
        """
        polls = self._polls.get((access.address, access.read), [])
        before = [poll for poll in polls if poll.repeated.at <= access.start.at]
        return next(iter([*before[-1:], *polls[:1]]), None)

    def _rest(self, number: int) -> tuple[Phase, ...]:
        """Return the captured phases of the last transfer from phase `number` on."""
        return self._captured.phases[number - len(self.transfers[-1].phases) :]

    def _hold_from(self, position: int, shift: int) -> None:
        self._from.append(position)
        self._shifts.append(shift)

    def played(self) -> list[Transfer]:
        """Return all transfers, those that were played and then the remaining ones as they would be played."""
        return [*self.transfers, *(_moved(transfer, self._shift) for transfer in self.left)]

    def expected(self, rate: Fraction) -> list[Happened]:
        """Return the events of `played` as text.

        `at` of an event is its captured time. `due` is its time in the replay, with polls added and removed.
        """
        events = [event for transfer in self.played() for event in events_of(transfer)]
        captured = (event.at - self._shifts[bisect_left(self._from, event.at) - 1] for event in events)
        return [
            replace(due, at=at / rate, due=due.at) for due, at in zip(i2c_words(events, rate), captured, strict=True)
        ]


def is_poll(phase: Phase) -> bool:
    """Return True if the address of a phase is not acknowledged and no data follow."""
    refused = is_addressed(phase) and phase.bytes[0].acked is False
    return refused and all(byte.value is None for byte in phase.bytes[1:])


def refusals(transfers: Iterable[Transfer], own: Sequence[int]) -> int:
    """Count how often an address of the firmware is sent and not acknowledged."""
    return sum(phase.bytes[0].acked is False for phase, _ in _accesses(transfers, own))


def busy_bounds(transfers: Iterable[Transfer], own: Sequence[int], us: Fraction) -> list[float]:
    """Return bounds of the time for which a target is busy after a write, in microseconds from the STOP.

    us: microseconds per position.

    Of all writes together, the lower bound is the longest time from the STOP to a NACK of the address, and the upper
    bound is the shortest time from the STOP to an ACK after a NACK. If the lower bound is the larger one, the busy time
    differs between writes. The list is empty if no ACK follows a NACK.
    """
    refused: list[int] = []
    acknowledged: list[int] = []
    stop: int | None = None
    polled = False
    for phase, after in _accesses(transfers, own):
        since = 0 if stop is None else phase.bytes[0].bits[8].at - stop
        if phase.bytes[0].acked:
            acknowledged += [since] * polled
            stop = None if phase.read or after is None else after.at
            polled = False
        elif stop is not None:
            refused.append(since)
            polled = True
    return [float(bound * us) for bound in (max(refused), min(acknowledged))] if acknowledged else []


def _accesses(transfers: Iterable[Transfer], own: Sequence[int]) -> Iterator[tuple[Phase, Condition | None]]:
    """Return the phases with an address of the firmware, each with the STOP that ends it; None if no STOP does."""
    return ((phase, stop) for phase, stop in addressed_phases(transfers) if phase.address in own)


def _value(phase: Phase) -> int | None:
    """Return the address byte of a phase; None if the byte is not complete."""
    return phase.bytes[0].value if is_addressed(phase) else None


def _acknowledged(transfer: Transfer, last: int) -> Transfer:
    """Return a transfer up to and including phase `last`, with the address of this phase acknowledged."""
    phase = transfer.phases[last]
    address = phase.bytes[0]
    address = address._replace(acked=True, bits=(*address.bits[:8], address.bits[8]._replace(value=0)))
    stop = transfer.stop if last + 1 == len(transfer.phases) else None
    return Transfer((*transfer.phases[:last], replace(phase, bytes=(address, *phase.bytes[1:]))), stop, None)


def _with_ninth(byte: Byte, other: Byte) -> Byte:
    """Return `byte` with the ninth bit (ACK or NACK) of `other`, except the low time of SCL before this bit."""
    ninth = other.bits[8]._replace(low=byte.bits[8].low)
    return byte._replace(acked=other.acked, bits=(*byte.bits[:8], ninth))


def _moved(transfer: Transfer, by: int) -> Transfer:
    if not by:
        return transfer
    stop = None if transfer.stop is None else _moved_condition(transfer.stop, by)
    return replace(transfer, phases=tuple(_moved_phase(phase, by) for phase in transfer.phases), stop=stop)


def _moved_phase(phase: Phase, by: int) -> Phase:
    return replace(
        phase, start=_moved_condition(phase.start, by), bytes=tuple(_moved_byte(byte, by) for byte in phase.bytes)
    )


def _moved_condition(condition: Condition, by: int) -> Condition:
    return condition._replace(at=condition.at + by)


def _moved_byte(byte: Byte, by: int) -> Byte:
    bits = (bit._replace(at=bit.at + by, sda=None if bit.sda is None else bit.sda + by) for bit in byte.bits)
    return byte._replace(at=byte.at + by, bits=tuple(bits))
