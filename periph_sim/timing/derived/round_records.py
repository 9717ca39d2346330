"""Records of rounds that are due, complete and missed, as values that budgets measure.

thing     tick                     value
due       when it was due          0; of each round, once it is known whether it began
missed    when it was due          0; or the START that shows that a request is missing
begin     its begin                0; of each complete round, when it is over
end       its last STOP            0
next      when the next is due     0; of each complete round, which may have ended later
refused   when it was due          number of its requests whose address was not acknowledged, if any
"""

from __future__ import annotations

from ...core.records import Kind, Recorder
from ...devices.sensor_rounds import Round
from ..rounds import BusRounds
from .transfer_records import I2C


class RoundRecords:
    """period: ticks from one round's due time to the next one's."""

    def __init__(self, recorder: Recorder, rounds: BusRounds, period: int) -> None:
        self._due, self._missed, self._begin, self._end, self._next, self._refused = (
            recorder.topic(Kind.ROUND, I2C, what) for what in ("due", "missed", "begin", "end", "next", "refused")
        )
        self._period = period
        rounds.on_due.append(self.due)
        rounds.on_missed.append(self.missed)
        rounds.on_round.append(self.round)

    def due(self, tick: int) -> None:
        """Record a round of which it is known whether it began."""
        self._due.emit(tick)

    def missed(self, tick: int) -> None:
        """Record a round that did not begin, or lacks a request."""
        self._missed.emit(tick)

    def round(self, over: Round) -> None:
        """Record a round that is over."""
        self._begin.emit(over.start)
        self._end.emit(over.end)
        self._next.emit(over.due + self._period)
        if over.nacked:
            self._refused.emit(over.due, over.nacked)
