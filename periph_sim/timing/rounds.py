"""Rounds on a bus, and the request that each transfer fulfils.

    transfers -------.                          .--> transfers with the request's name, bytes asked, bytes expected
                     +--> recognized in order --+--> rounds: due, begin, end, refused requests
    MasterSchedule --'                          '--> rounds due, rounds missed

A transfer fulfils a request if the first phases of both have the same address and R/W bit, and write the same bytes, up
to the end of the shorter of the two writes. A transfer that matches no request belongs to no round. A round begins with
its first START, and ends with the STOP of its last request. If the START comes later than `MasterSchedule.late` allows,
the duration of the round counts from the latest time that is allowed. If a transfer fulfils the first request, but none
of the requests that have not been made yet, the round is broken off and the next round begins.

A round is missed if it does not begin, or if one of its requests is skipped because a later request is made instead. A
round that is broken off is missed, too, because its last request is skipped.

If the master is a simulated controller, its rounds are due by a fixed schedule. If the master is firmware, or a party
in a capture, its clock is not known: a round is due one period after the start of the round before, and is missed if it
has not begun half a period after its due time.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from msgspec import Struct

from ..bus.i2c.transfer import Phase, Transfer
from ..core.chip import NEVER
from ..core.time import NO_TIME
from ..devices.sensor_rounds import Round
from ..form.c_types import BigInt


class MasterSchedule(Struct, frozen=True):
    """The requests of a master, and the times at which its rounds are due. Times are ticks.

    requests: the transfers of each round.
    period: the time between the due times of two rounds.
    startup: the transfers before the first round, which set up the chips.
    first: the due time of the first round; None if it is not known.
    late: the allowed delay of a round after its due time. If a round starts later, its duration counts from this limit.
    rounds: the number of rounds that are due; None if rounds are due until the run ends.
    starts: the due times of all rounds; None if they follow from `first` and `period`.
    ack_polling: True if a write of only the address polls whether a device is ready, so that it is not a request.
    """

    requests: tuple[Transfer, ...]
    period: Fraction | int
    startup: tuple[Transfer, ...] = ()
    first: int | None = None
    late: int = 0
    rounds: int | None = None
    ack_polling: bool = False
    starts: Sequence[int] | None = None


class Schedule:
    """Due times of rounds.

    If the due time of the first round is known, as for a simulated controller, round n is due n periods after this
    time, with n counted from 0, or at the time that `MasterSchedule.starts` lists. A round is missed if it has not
    begun when the next round is due.

    If the due time is not known, as for firmware or a capture, a round is due one period after the start of the round
    before. It is missed if it has not begun half a period after its due time.

    After the requested number of rounds, no further round is due.
    """

    def __init__(self, asked: MasterSchedule) -> None:
        self._asked: MasterSchedule = asked
        self._starts: Sequence[int] | None = asked.starts
        self._is_fixed: bool = asked.first is not None
        self._since: int = NO_TIME if asked.first is None else asked.first  # the tick from which periods count
        period = Fraction(asked.period if self._is_fixed else asked.period // 1)
        assert period > 0, "a period of 0 ticks has rounds without end"
        self._ticks: BigInt = period.numerator  # `_periods` periods last this whole number of ticks
        self._periods: BigInt = period.denominator
        self._next: BigInt = 0  # number of periods from `_since` to the next due time
        self._passed = 0  # number of rounds that began or were missed

    def begins(self, start: int) -> tuple[list[int], int]:
        """Return the due times of the rounds missed since the last round, and the due time of the round that begins.

        If `MasterSchedule.starts` has no further entry, the round counts as due when it begins.

        start: the tick at which the round begins.
        """
        missed = self._missed(start)
        if not self._is_fixed:
            self._since, self._next = start, 0
        due = self._pass()
        return missed, start if due == NEVER else due

    def missed_by(self, now: int, over: int | None) -> list[int]:
        """Return the due times of the rounds missed since the last round, when the run ends at tick `now`.

        over: the tick at which the last round ended; None if a round or the set-up is in progress.
        """
        missed = self._missed(now)
        if self._is_fixed and self._is_due_again() and self._due() <= now:
            due = self._pass()
            if over is None or due + self._asked.late < over:
                missed.append(due)
        return missed

    def _missed(self, now: int) -> list[int]:
        missed = []
        while now >= self._deadline():
            missed.append(self._pass())
        return missed

    def _deadline(self) -> int:
        """Return the tick at which the next round is missed if it has not begun; NEVER if no round is due."""
        if not self._is_due_again():
            return NEVER
        return self._due(1) if self._is_fixed else self._due() + self._ticks // 2

    def _is_due_again(self) -> bool:
        """Return True if a further round will be due."""
        rounds = self._asked.rounds if self._starts is None else len(self._starts)
        return self._since != NO_TIME and (rounds is None or self._passed < rounds)

    def _pass(self) -> int:
        """Count the next round as begun or missed, and return its due time."""
        due = self._due()
        self._next += 1
        self._passed += 1
        return due

    def _due(self, ahead: int = 0) -> int:
        if self._starts is not None:
            number: int = self._next + ahead
            return self._starts[number] if number < len(self._starts) else NEVER
        return self._since + (self._next + ahead) * self._ticks // self._periods


class BusRounds:
    """Groups the transfers of a bus into rounds.

    on_transfer: called with each transfer at its end.
    on_round: called with each complete round at its end.
    on_other: called with each transfer that matches no request and is no ACK poll.
    on_due: called with the due time of a round when the round is complete, broken off or missed.
    on_missed: called with the due time of a round that did not begin. If a request of a round was not made, called with
        the tick of the START of the transfer that was made in its place.
    begun_at: a function that returns the tick of the START of the transfer in progress, or NO_TIME if there is none. It
        is called at the end of the run.
    completed: number of complete rounds so far.
    missed: number of missed rounds so far.
    """

    def __init__(self, asked: MasterSchedule | None, begun_at: Callable[[], int]) -> None:
        self.on_transfer: list[Callable[[Transfer], None]] = []
        self.on_round: list[Callable[[Round], None]] = []
        self.on_due: list[Callable[[int], object]] = []
        self.on_missed: list[Callable[[int], object]] = []
        self.on_other: list[Callable[[Transfer], None]] = []
        self._begun_at = begun_at
        self._startup: list[Transfer] = [] if asked is None else list(asked.startup)
        self._requests: tuple[Transfer, ...] = () if asked is None else tuple(asked.requests)
        self._schedule: Schedule | None = None if asked is None else Schedule(asked)
        self._late: int = 0 if asked is None else asked.late
        self._ack_polling: bool = asked is not None and asked.ack_polling
        self._made = 0  # number of requests of the present round that were made or skipped
        self._round: Round | None = None
        self._number = 0
        self.completed = self.missed = 0
        self._over = NO_TIME  # the tick at which the last round ended

    def transfer(self, transfer: Transfer) -> None:
        """Assign a complete transfer to the set-up of the chips, to a round, or to neither."""
        first: Phase = transfer.phases[0]
        if self._ack_polling and not first.read and not first.data:
            self._report(transfer)
            return
        if self._startup and may_be(first, self._startup[0]):
            self._report(asked_for(transfer, self._startup.pop(0)))
            return
        place: int = self._made
        while place < len(self._requests) and not may_be(first, self._requests[place]):
            place += 1
        if place < len(self._requests):
            self._request(transfer, place)
        elif self._round is not None and may_be(first, self._requests[0]):
            self._broken_off(first.start_at)
            self._request(transfer, 0)
        else:
            self._report(transfer)
            for callback in self.on_other:
                callback(transfer)

    def at_start(self) -> bool:
        """Return True if neither a round nor the set-up is in progress, so that the next START may begin a round."""
        return self._round is None and not self._startup

    def finish(self, now: int) -> None:
        """Report the rounds that were due but did not begin before the run ended at tick `now`.

        A transfer that is in progress at this time counts as the first of a round if neither a round nor the set-up is
        in progress.
        """
        begun_at = self._begun_at()
        if self._schedule is not None:
            if self._round is None and begun_at != NO_TIME and not self._startup:
                self._begin(begun_at)
            over = None if self._round is not None or self._startup else self._over
            self._report_missed(self._schedule.missed_by(now, over))

    def _report(self, transfer: Transfer) -> None:
        for callback in self.on_transfer:
            callback(transfer)

    def _request(self, transfer: Transfer, place: int) -> None:
        """Assign a transfer to request number `place` of the round. Earlier requests that were not made are skipped."""
        phase: Phase = transfer.phases[0]
        start: int = phase.start_at
        current = self._round or self._begin(start)
        made = asked_for(transfer, self._requests[place])
        if place > self._made and current.transfers == self._made:  # the first request of this round that is missing
            self._report_incomplete(start)
        self._made = place + 1
        current.transfers += 1
        current.nacked += not made.acked
        self._report(made)
        if self._made == len(self._requests):
            current.end = self._over = transfer.stop_at
            self._made, self._round = 0, None
            self.completed += 1
            for on_due in self.on_due:
                on_due(current.due)
            for on_round in self.on_round:
                on_round(current)

    def _begin(self, start: int) -> Round:
        assert self._schedule is not None
        missed, due = self._schedule.begins(start)
        self._report_missed(missed)
        self._number += 1
        self._round = Round(self._number, due, min(start, due + self._late))
        return self._round

    def _broken_off(self, start: int) -> None:
        assert self._round is not None
        for callback in self.on_due:
            callback(self._round.due)
        if self._round.transfers == self._made:
            self._report_incomplete(start)
        self._made, self._round = 0, None

    def _report_incomplete(self, start: int) -> None:
        """Report that a request of the round was not made. start: the tick at which another transfer began instead."""
        self.missed += 1
        for callback in self.on_missed:
            callback(start)

    def _report_missed(self, missed: list[int]) -> None:
        self.missed += len(missed)
        for due in missed:
            for callback in (*self.on_due, *self.on_missed):
                callback(due)


def asked_for(transfer: Transfer, request: Transfer) -> Transfer:
    """Return a transfer with the name, the byte counts and the expected bytes of the request that the transfer fulfils.

    Phases of the request that never began are added. Further phases, and received bytes beyond the requested count, are
    removed. The phases of `transfer` itself are changed.
    """
    phases = transfer.phases[: len(request.phases)]
    place: int = 0
    phase: Phase
    for phase in phases:
        asked: Phase = request.phases[place]
        phase.count = asked.count
        if phase.expect is None:
            phase.expect = asked.expect
        if len(phase.got) > asked.count:
            del phase.got[asked.count :]
        place += 1
    while place < len(request.phases):
        asked = request.phases[place]
        phases.append(Phase(asked.address, asked.read, asked.data, asked.count, asked.expect))
        place += 1
    return Transfer(request.name, phases, transfer.stop_at, transfer.lost)


def may_be(made: Phase, request: Transfer) -> bool:
    """Return True if a transfer that begins with the phase `made` may fulfil `request`.

    The written bytes of the two need only agree up to the length of the shorter one, because a NACK ends a write.
    """
    asked: Phase = request.phases[0]
    if made.address != asked.address or made.read != asked.read:
        return False
    return made.data.startswith(asked.data) or asked.data.startswith(made.data)
