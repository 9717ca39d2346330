"""A journal told to measures, as a scene on edges tells them: what happened goes in, values are taken.

    Journal --> transfers --BusRounds--> transfers as asked, rounds due, made and missed
            --> frames of the host, spans of the models, bytes sent

What is not over as the run ends is told as far as it has come.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import cast

import numpy as np
from msgspec.structs import replace

from ...bus.i2c.transfer import Phase, Transfer
from ...core.records import Kind
from ...core.time import NO_TIME
from ...devices.sensor_rounds import Round
from ...timing.measures.margin import Margin
from ...timing.measures.measure import MODEL, Measure, ReadOrigins, SceneEvents
from ...timing.measures.origins import BEFORE_ANY, Origin
from ...timing.measures.span import SpanTime
from ...timing.rounds import BusRounds
from .inputs import Inputs
from .journal import Journal, Made
from .read import margins_of
from .rounds import Rounds
from .structure import Structure

OnFrame = Callable[[int, tuple[int, ...], int], None]


class Told:
    """Stands in for a scene where measures listen: for those alone that the level answers.

    i2c_bytes: of transfers that are over. frames: that have begun. rounds: that are over. forgotten: the frame that a
    read carries may be one that edges have forgotten.
    """

    def __init__(self, structure: Structure, inputs: Inputs, rounds: Rounds, journal: Journal) -> None:
        self._structure, self._inputs = structure, inputs
        self._end = int(inputs.end[0])
        self._models = [each for each in journal.models if each[0] <= self._end]
        self._made = [each for each in journal.made if each.start <= self._end]
        period = inputs.round_
        self._bus = BusRounds(
            replace(
                structure.asked,
                first=int(inputs.controller_first[0]),
                period=Fraction(_one(period.num), _one(period.den)),
                late=inputs.controller_jitter,
            ),
            self._begun_at,
        )
        counts = rounds.values["age"].count[0]
        self.forgotten = bool(counts and not rounds.observables()["age"].count[0])
        self._begun = [at for at in rounds.begun.at(np.arange(rounds.begun.rows)).tolist() if at <= self._end]
        self._on_frame: list[OnFrame] = []
        self._origins: dict[int, Origin] = {}
        self.i2c_bytes = 0
        self.frames = len(self._begun)

    @property
    def rounds(self) -> int:
        return self._bus.completed

    def tell(self, measures: Iterable[Measure]) -> None:
        margins: list[Margin] = []
        for measure in measures:
            if isinstance(measure, Margin):
                margins.append(measure)
            elif isinstance(measure, SpanTime):
                self._tell_models(measure)
            else:
                measure.listen(cast(SceneEvents, self))  # those that the level answers ask for no more than is here
        happened = [*self._frames(), *self._transfers()]
        for _, tell in sorted(happened, key=lambda one: one[0]):
            tell()
        for margin in margins:
            self._tell_bytes(margin)
        self._bus.finish(self._end)

    # What measures listen to ---------------------------------------------------------

    def on_transfer(self, told: Callable[[Transfer], None]) -> None:
        self._bus.on_transfer.append(told)

    def on_round(self, told: Callable[[Round], None]) -> None:
        self._bus.on_round.append(told)

    def on_round_due(self, told: Callable[[int], None]) -> None:
        self._bus.on_due.append(told)

    def on_missed_round(self, told: Callable[[int], None]) -> None:
        self._bus.on_missed.append(told)

    def on_frame(self, told: OnFrame) -> None:
        self._on_frame.append(told)

    def round_period(self) -> int:
        return int(self._inputs.round_.down(1))

    def open_transfer(self) -> Transfer | None:
        return None

    def held_since(self) -> int:
        held = self._held()
        return NO_TIME if held is None else held

    def origins(self) -> ReadOrigins:
        return self

    def of(self, phase: Phase) -> Origin | None:
        """As origins of what a phase of the transfer that is just over has read."""
        return self._origins.get(id(phase))

    # What happened -------------------------------------------------------------------

    def _frames(self) -> Iterator[tuple[int, Callable[[], None]]]:
        for number, begun in enumerate(self._begun):
            ended = begun + self._inputs.line.end
            if ended <= self._end:
                yield ended, lambda number=number, ended=ended: self._frame(number, ended)  # type: ignore[misc]

    def _frame(self, number: int, ended: int) -> None:
        for told in self._on_frame:
            told(number, (), ended)

    def _transfers(self) -> Iterator[tuple[int, Callable[[], None]]]:
        for made in self._made:
            if made.stop <= self._end:
                yield made.stop, lambda made=made: self._transfer(made)  # type: ignore[misc]

    def _transfer(self, made: Made) -> None:
        write, read = self._structure.asked.requests[made.chip].phases
        pointer = Phase(write.address, read=False, data=write.data, start_at=made.start, acked=made.acked)
        phases = [pointer]
        if made.acked:
            pointer.acks = [True] * len(write.data)
            since = made.start + self._structure.terms.bus[made.chip].needs[0]
            asked = Phase(read.address, read=True, count=read.count, acked=True, got=bytearray(read.count))
            asked.acks, asked.start_at, asked.stretch = [True] * read.count, made.again, made.held
            asked.answer_from, asked.answer_at = since, made.rise[0]
            phases.append(asked)
            self._origins = {id(asked): self._origin(made.frame)}
        transfer = Transfer(self._structure.terms.names[made.chip], phases, made.stop)
        self.i2c_bytes += transfer.wire_bytes
        self._bus.transfer(transfer)

    def _origin(self, frame: int) -> Origin:
        if frame < 0:
            return Origin(BEFORE_ANY, NO_TIME, b"")
        return Origin(frame, self._begun[frame] + self._inputs.line.end, b"")

    def _tell_models(self, span: SpanTime) -> None:
        tag = span.tag_of(Kind.SPAN, self._structure.unit, MODEL)
        for begin, end in self._models:
            span.hear(tag, begin, 1)
            if end <= self._end:
                span.hear(tag, end, 0)

    def _tell_bytes(self, margin: Margin) -> None:
        """As its `needed` and `finish` take them."""
        terms, clock, end = self._structure.terms, self._inputs.clock, self._end
        for made in self._made:
            if made.acked and not made.hung:
                let_go, writes = (np.array(each, np.int64) for each in (made.let_go, made.landed))
                spare = margins_of(terms, clock, let_go, writes).tolist()
                for value, rise, landed in zip(spare, made.rise, made.landed, strict=False):
                    if rise <= end:
                        margin.occasion(rise)
                        margin.take(value, landed)
        held = self._held()
        if held is not None:
            margin.occasion(end)
            margin.take(held - end, held)

    def _held(self) -> int | None:
        """Since when SCL is held as the run ends, which the controller has let go of; None if it is not."""
        for made in self._made:
            rises = [2 * self._end] if made.hung else made.rise
            for let_go, rise in zip(made.let_go, rises, strict=True):
                if let_go <= self._end < rise:
                    return let_go
        return None

    def _begun_at(self) -> int:
        """The START of the transfer under way, whose first clock has come; NO_TIME if there is none."""
        high = self._structure.terms.high
        under_way = [made for made in self._made if made.start + high <= self._end < made.stop]
        return under_way[-1].start if under_way else NO_TIME


def _one(value: object) -> int:
    """Of the one scenario."""
    return int(np.max(cast(int, value)))
