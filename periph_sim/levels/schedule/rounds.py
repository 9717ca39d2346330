"""Rounds of many scenarios: inputs and terms go in; what measures make of each scenario's run comes out.

models --> wait for chip 0 --read--> wait for chip 1 --read--> wait for chip 2 --read--> models --> ...

A START is for the firmware where it waits for this chip, and IRS rose (ready) before the START was seen:
    ready < cycle_at(start) + seen        else nobody acknowledges, and the firmware waits on: a NACK window
A round is missed where the one before is not over, or hangs.
A request of the chip that the firmware served last, while IRS has not been cleared since, is answered by nobody
but the module, with what is left in it: such a scenario is refused.
Models work on the last frame whose service routine has begun when they do; reads show the models before them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.chip import NEVER
from .clock import Ints
from .draws import Drawn
from .frames import frames
from .inputs import Inputs
from .journal import Journal, Made
from .lanes import Interrupts
from .plain import plain_rounds
from .read import Read, read
from .structure import Structure
from .tally import Tally


class Rounds(Tally):
    """All scenarios of one call, or of a part of it. journal: told what happens, where there is one scenario."""

    def __init__(self, structure: Structure, inputs: Inputs, journal: Journal | None = None) -> None:
        super().__init__(structure, inputs)
        self._terms = structure.terms
        self._journal = journal
        count = inputs.scenarios
        self.begun, latches = frames(structure, inputs)  # when each frame begins, in the order of the interrupts
        self.interrupts = Interrupts(latches, self._terms.service, self._terms.waits)
        self.all = np.arange(count)
        self.odd = np.zeros(count, np.bool_)  # waits for another chip than the first
        # The firmware, of each scenario:
        self.first = np.zeros(count, np.int64)  # the first fetch of its wait for AAS
        self.ready = np.zeros(count, np.int64)  # the cycle in which IRS rose
        self.off = np.zeros(count, np.int64)  # and that in which it fell before
        self.served = np.full(count, -1, np.int64)  # the chip whose address was its own up to there
        self.chip = np.zeros(count, np.int64)  # that it waits for
        self.next = self.all.copy()  # the place of the next interrupt
        self.shown = self.all.copy()  # that of the first frame that the chips do not show
        self.costs, self.cost, self.cost_step = self._drawn_costs()
        self.stop = np.full(count, -(1 << 40), np.int64)  # of the last transfer

    def _drawn_costs(self) -> tuple[Ints, Ints, int]:
        """Cycles of the models' runs; the place of each scenario's first one; how many places on the next one is."""
        least, most = self._inputs.cost
        if np.array_equal(least, most):
            return least, self.all.copy(), 0
        name, wide = self._structure.unit, int(most[0] - least[0]) + 1
        drawn = Drawn(self._inputs.seeds, wide, self._inputs.rounds + 1, lambda seed: f"{seed} {name} computations")
        return drawn.numbers.reshape(-1) + least[0], drawn.column.copy(), drawn.numbers.shape[1]

    @cached_property
    def _late(self) -> Drawn | None:
        """Ticks by which the controller begins each round late; None: none."""
        jitter, rounds = self._inputs.controller_jitter, self._inputs.rounds
        return Drawn(self._inputs.seeds, jitter + 1, rounds, lambda seed: seed) if jitter else None

    # The run -----------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> None:
        """progress: told the part done, 0 to 1."""
        first = np.full(self._inputs.scenarios, self._terms.first_model, np.int64)
        self._work(self.all, first)
        plain = plain_rounds(self, self._terms, self._inputs)
        step = -(-self._inputs.rounds // 100)
        for number in range(self._inputs.rounds):
            self._round(number, self.all if plain is None else plain.round(number))
            if progress is not None and (number + 1) % step == 0:
                progress((number + 1) / self._inputs.rounds)
        if plain is not None:
            plain.count()
        self._hang_on()

    def _work(self, who: Ints, begin: Ints) -> None:
        """The models run from this cycle on, and the firmware waits for the first chip."""
        lanes = self.interrupts.lanes(self.next[who])
        self.shown[who] = lanes.places
        clock, end = self._inputs.clock.of(who), lanes.run(begin, self.costs[self.cost[who]])
        first, (off, ready) = lanes.code(end, self._terms.start)
        self.first[who], self.ready[who], self.next[who] = first, ready, lanes.places
        self.off[who] = off
        self.chip[who] = 0
        self.cost[who] += self.cost_step
        ended = clock.tick(end)
        within = ended <= self._inputs.end[who]
        began = clock.tick(begin)
        if self._journal is not None and who.size:
            self._journal.models.append((int(began[0]), int(ended[0])))
        self.values["span:model"].take(who[within], (ended - began)[within])
        cut = ~within & (began <= self._inputs.end[who])
        self.values["span:model"].take_unfinished(who[cut], (self._inputs.end[who] - began)[cut])

    def _round(self, number: int, who: Ints) -> None:
        """Read by read, of these scenarios."""
        if not who.size:
            return
        inputs, terms, given = self._inputs, self._terms, who
        due = np.broadcast_to(inputs.due(number), inputs.scenarios)[who]
        begin = due + (0 if self._late is None else self._late.row(number)[who])
        there = begin <= inputs.end[who]
        busy = (self.hung_at[who] >= 0) | (self.stop[who] >= begin)
        self.due[who] += there
        self.missed[who] += there & busy
        goes = there & ~busy
        who, due, begin = who[goes], due[goes], begin[goes]
        start = np.maximum(begin, self.stop[who] + terms.free)
        begun = np.minimum(start, due + inputs.controller_jitter)
        refused = np.zeros(who.size, np.bool_)
        for chip in range(len(terms.names)):
            runs = self.hung_at[who] < 0
            if not runs.all():
                who, due, begun, start = who[runs], due[runs], begun[runs], start[runs]
                refused = refused[runs]
            answered = self._answers(chip, who, start)
            refused |= ~answered
            stop = start + terms.bus[chip].refused
            if not answered.all():
                self._refuse(chip, who[~answered], start[~answered], stop[~answered])
            if answered.any():
                stop[answered] = self._serve(chip, who[answered], start[answered])
            self.stop[who] = stop
            start = stop + terms.gap
        over = (self.hung_at[who] < 0) & (self.stop[who] <= inputs.end[who])
        who, due, begun, refused = who[over], due[over], begun[over], refused[over]
        self.over[who] += 1
        self.nacked_rounds[who] += refused
        self.values["round"].take(who, self.stop[who] - begun)
        period = np.broadcast_to(inputs.round_.down(1), inputs.scenarios)[who]
        self.values["slack"].take(who, due + period - self.stop[who])
        self.odd[given] = self.chip[given] > 0

    def _answers(self, chip: int, who: Ints, start: Ints) -> NDArray[np.bool_]:
        """Which of them acknowledge a request of this chip."""
        clock = self._inputs.clock.of(who)
        own = self.chip[who] == chip
        spare = start - clock.tick(self.first[who])
        self.values["asked"].take(who[own], spare[own])
        heard: NDArray[np.bool_] = own & (self.ready[who] < clock.cycle_at(start) + self._terms.seen)
        return heard

    def _refuse(self, chip: int, who: Ints, start: Ints, stop: Ints) -> None:
        """Nobody acknowledges: a STOP behind the address."""
        seen = self._inputs.clock.of(who).cycle_at(start + self._terms.bus[chip].eighth) + self._terms.seen
        self.refused[who] |= (seen <= self.off[who]) & (self.served[who] == chip)
        self.nacked[who] += stop <= self._inputs.end[who]
        if self._journal is not None:
            self._journal.made.append(Made(chip, int(start[0]), int(stop[0])))

    def _serve(self, chip: int, who: Ints, start: Ints) -> Ints:
        """A read, and its STOP; the firmware goes on to the next chip, or to the models."""
        lanes = self.interrupts.lanes(self.next[who])
        came = read(self._terms, chip, self._inputs.clock.of(who), lanes, start, self.first[who])
        hung = came.hung
        self.hung_at[who[hung]] = came.let_go[hung]
        end, marks = lanes.code(came.seen, self._terms.reads[chip].after)
        self.next[who], self.served[who] = lanes.places, chip
        self.values["SDIR rises"].take(who, came.cleared)
        if self._journal is not None:
            self._journal.made.append(self._made(chip, int(start[0]), came))
        self._measure(who, came, ~hung & (came.stop <= self._inputs.end[who]))
        if marks:
            self.first[who], self.chip[who] = end, chip + 1
            self.off[who], self.ready[who] = marks
        else:
            well = ~hung
            self._work(who[well], end[well])
        return came.stop

    def _made(self, chip: int, start: int, came: Read) -> Made:
        """Of the one scenario that there is."""
        stop = NEVER if came.hung[0] else int(came.stop[0])
        let_go, rise = (tuple(int(byte[0]) for byte in each) for each in (came.let_gos, came.rises))
        if came.hung[0]:
            let_go = rise = (int(came.let_go[0]),)
        landed = tuple(int(write[0]) for write in came.landed)
        frame = int(self.shown[0]) - 1
        return Made(chip, start, stop, frame, int(came.again[0]), int(came.held[0]), let_go, rise, landed)

    def _measure(self, who: Ints, came: Read, over: NDArray[np.bool_]) -> None:
        """What measures take of reads that are over."""
        who = who[over]
        self.phases[who] += 2
        self.held[who] = np.maximum(self.held[who], came.held[over])
        self.values["response"].take(who, came.response[over])
        self.values["margin of I2CDXR"].take_rows(who, came.margins[:, over])
        again, ends = came.again[over], self._inputs.line.end
        since = self.begun.at(np.maximum(self.shown[who] - self._inputs.scenarios, who)) + ends
        known = self.begun.at(who) + ends <= again  # the first frame
        self.values["age"].take(who[known], (again - np.minimum(since, again))[known])

    def _hang_on(self) -> None:
        """What the end of the run finds where SCL is held for ever."""
        who = np.flatnonzero((self.hung_at >= 0) & (self.hung_at < self._inputs.end))
        lasted = self._inputs.end[who] - self.hung_at[who]
        self.phases[who] += lasted > self.held[who]  # as a value that the end of the run cuts off
        self.held[who] = np.maximum(self.held[who], lasted)
        self.values["margin of I2CDXR"].take(who, -lasted)
