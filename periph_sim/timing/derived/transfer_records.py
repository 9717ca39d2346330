"""Records of I2C transfers and of rounds, as values that budgets measure.

The records of a transfer and its phases are made when the transfer is over. "Others" are all parties except the master.

thing        tick                                                           value
phase        START of each addressed phase, refused ACK polls excluded      address of the phase
read         START of each phase that reads                                 address of the phase
acknowledge  SCL fall that ends the ACK slot of a read's address            0; for each read with a first data bit
answer       SCL rise of the first data bit of a read                       0
stretch      START of each acknowledged phase                               longest time others held SCL low, in ticks
write end    STOP of a transfer whose last phase wrote at least one byte    address of this phase
refused      START of a transfer that lost arbitration, of which an         number of its phases
             address was not acknowledged, or that lacks a phase of its
             request
held         release of SCL by the master, if others hold SCL low until     ticks from this release to the run's end
             the run ends
"""

# core: compiled

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...bus.i2c.transfer import Phase, Transfer
from ...core.records import Kind, Recorder
from ...core.time import NO_TIME
from ...devices.sensor_rounds import Round
from ..rounds import BusRounds

if TYPE_CHECKING:
    from ...core.records import Topic


I2C = "I2C"  # the place (`where`) of these records


def begin_of(transfer: Transfer, phase: Phase) -> int:
    """Return the tick of a phase's START.

    If the phase never began, because an earlier phase was refused, return the tick of the transfer's START.
    """
    if phase.start_at != NO_TIME:
        return phase.start_at
    first: Phase = transfer.phases[0]
    return first.start_at


class TransferRecords:
    """Makes the records of the transfers of one bus.

    polls: True if refused writes are ACK polls, which make no record "phase". False if they are requests.
    """

    def __init__(self, recorder: Recorder, polls: bool) -> None:
        self._polls = polls
        self._phase: Topic = recorder.topic(Kind.TRANSFER, I2C, "phase")
        self._read: Topic = recorder.topic(Kind.TRANSFER, I2C, "read")
        self._acknowledge: Topic = recorder.topic(Kind.TRANSFER, I2C, "acknowledge")
        self._answer: Topic = recorder.topic(Kind.TRANSFER, I2C, "answer")
        self._stretch: Topic = recorder.topic(Kind.TRANSFER, I2C, "stretch")
        self._refused: Topic = recorder.topic(Kind.TRANSFER, I2C, "refused")
        self._write_end: Topic = recorder.topic(Kind.TRANSFER, I2C, "write end")
        self._held: Topic = recorder.topic(Kind.TRANSFER, I2C, "held")

    def transfer(self, transfer: Transfer) -> None:
        """Record a transfer that is over."""
        self._record_refusal(transfer)
        phase: Phase
        for phase in transfer.phases:
            begin = begin_of(transfer, phase)
            if phase.acked or phase.read or not self._polls:
                self._phase.emit(begin, phase.address)
            if phase.acked:
                self._stretch.emit(phase.start_at, phase.stretch)
            if phase.read:
                self._read.emit(begin, phase.address)
                if phase.answer_at != NO_TIME:
                    self._acknowledge.emit(phase.answer_from)
                    self._answer.emit(phase.answer_at)
        if phase.acked and phase.data:  # `data` has the bytes written, so it is empty for a read
            self._write_end.emit(transfer.stop_at, phase.address)

    def finish(self, now: int, unfinished: Transfer | None, held_since: int) -> None:
        """Make the records "refused" and "held" for the transfer that the end of the run cuts off.

        unfinished: the transfer that has no STOP yet, or None. If one of its addresses was not acknowledged, the record
            "refused" is made. The other records of a transfer are not made.
        held_since: the tick since which parties other than the master have held SCL low. The record "held" has the time
            from this tick to `now`. NO_TIME for no record.
        """
        if unfinished is not None:
            self._record_refusal(unfinished)
        if held_since != NO_TIME:
            self._held.emit(held_since, now - held_since)

    def _record_refusal(self, transfer: Transfer) -> None:
        first: Phase = transfer.phases[0]
        if first.start_at != NO_TIME and not transfer.acked:
            self._refused.emit(first.start_at, len(transfer.phases))


class RoundRecords:
    """Makes the records of rounds. A round is one execution of the master's periodic list of requests.

    thing     tick                      value
    due       due time of a round       0; recorded when the round is complete, broken off or missed
    missed    due time of a round       0; recorded if the round did not begin
    missed    START of a transfer       0; recorded if a request of the round is missing and this transfer came instead
    begin     start of the round        0; recorded for each complete round, when it ends
    end       last STOP of the round    0; recorded for each complete round
    next      due time of next round    0; recorded for each complete round, even if the round ended after this time
    refused   due time of the round     number of transfers as in the record "refused" above; recorded if not 0

    period: the number of ticks from the due time of a round to the due time of the next round.
    starts: the due times of all rounds, if the case lists them; else empty. If it is not empty, `period` applies only
        to the last round.
    """

    def __init__(self, recorder: Recorder, rounds: BusRounds, period: int, starts: Sequence[int] = ()) -> None:
        names = ("due", "missed", "begin", "end", "next", "refused")
        self._topics: dict[str, Topic] = {what: recorder.topic(Kind.ROUND, I2C, what) for what in names}
        self._period = period
        self._starts = starts
        rounds.on_due.append(self._topics["due"].emit)
        rounds.on_missed.append(self._topics["missed"].emit)
        rounds.on_round.append(self.round)

    def round(self, over: Round) -> None:
        """Record a round that is over."""
        self._topics["begin"].emit(over.start)
        self._topics["end"].emit(over.end)
        following = bisect_right(self._starts, over.due)
        last = following == len(self._starts)
        self._topics["next"].emit(over.due + self._period if last else self._starts[following])
        if over.nacked:
            self._topics["refused"].emit(over.due, over.nacked)
