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

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .draws import drawn
from .extremes import Extremes
from .frames import begins, latches
from .inputs import Inputs
from .lanes import Interrupts
from .read import Read, read
from .result import Observable, Observables
from .structure import Structure

MEASURES = ("response", "round", "slack", "age", "margin of I2CDXR", "span:model", "asked", "SDIR rises")


class Rounds:
    """All scenarios of one call, or of a part of it."""

    def __init__(self, structure: Structure, inputs: Inputs) -> None:
        self._structure, self._inputs, self._terms = structure, inputs, structure.terms
        count = inputs.scenarios
        self._begun = begins(structure, inputs)
        self._interrupts = Interrupts(latches(structure, inputs, self._begun), self._terms.service, self._terms.waits)
        self._ended = self._begun + inputs.line.end  # of each frame
        self.values = {name: Extremes(count) for name in MEASURES}
        self.held = np.zeros(count, np.int64)
        self.phases = np.zeros(count, np.int64)  # that were acknowledged
        self.missed, self.nacked, self.nacked_rounds = (np.zeros(count, np.int64) for _ in range(3))
        self.over = np.zeros(count, np.int64)  # rounds
        self.due = np.zeros(count, np.int64)  # rounds
        self.hung_at = np.full(count, -1, np.int64)
        self.refused = np.zeros(count, np.bool_)
        # The firmware, of each scenario:
        self._first = np.zeros(count, np.int64)  # the first fetch of its wait for AAS
        self._ready = np.zeros(count, np.int64)  # the cycle in which IRS rose
        self._off = np.zeros(count, np.int64)  # and that in which it fell before
        self._served = np.full(count, -1, np.int64)  # the chip whose address was its own up to there
        self._chip = np.zeros(count, np.int64)  # that it waits for
        self._taken = np.zeros(count, np.int64)  # interrupts so far
        self._shown = np.zeros(count, np.int64)  # frames up to the one that the chips show
        self._models = np.zeros(count, np.int64)  # runs of the models so far
        self._stop = np.full(count, -(1 << 40), np.int64)  # of the last transfer
        self.all = np.arange(count)

    @cached_property
    def _costs(self) -> Ints:
        """int64[runs, scenarios], cycles of each run of the models."""
        least, most = self._inputs.cost
        if np.array_equal(least, most):
            return np.broadcast_to(least, (self._inputs.rounds + 1, self._inputs.scenarios))
        name = self._structure.unit
        wide = int(most[0] - least[0]) + 1
        late = drawn(self._inputs.seeds, wide, self._inputs.rounds + 1, lambda seed: f"{seed} {name} computations")
        return late + least

    @cached_property
    def _late(self) -> Ints:
        """int64[rounds, scenarios], ticks by which the controller begins a round late."""
        jitter, rounds = self._inputs.controller_jitter, self._inputs.rounds
        if not jitter:
            return np.zeros((rounds, self._inputs.scenarios), np.int64)
        return drawn(self._inputs.seeds, jitter + 1, rounds, lambda seed: seed)

    # The run -----------------------------------------------------------------------

    def run(self) -> None:
        first = np.full(self._inputs.scenarios, self._terms.first_model, np.int64)
        self._work(self.all, first)
        for number in range(self._inputs.rounds):
            self._round(number)
        self._hang_on()

    def _work(self, who: Ints, begin: Ints) -> None:
        """The models run from this cycle on, and the firmware waits for the first chip."""
        lanes = self._interrupts.lanes(who, self._taken[who])
        self._shown[who] = lanes.taken
        clock, end = self._inputs.clock.of(who), lanes.run(begin, self._costs[self._models[who], who])
        first, (off, ready) = lanes.code(end, self._terms.start)
        self._first[who], self._ready[who], self._taken[who] = first, ready, lanes.taken
        self._off[who] = off
        self._chip[who] = 0
        self._models[who] += 1
        ended = clock.tick(end)
        within = ended <= self._inputs.end[who]
        self.values["span:model"].take(who[within], (ended - clock.tick(begin))[within])

    def _round(self, number: int) -> None:
        inputs, terms = self._inputs, self._terms
        due = inputs.due(number)
        begin = due + self._late[number]
        there = begin <= inputs.end
        busy = (self.hung_at >= 0) | (self._stop >= begin)
        self.due += there
        self.missed += there & busy
        who = np.flatnonzero(there & ~busy)
        start = np.maximum(begin, self._stop + terms.free)
        begun, refused = start.copy(), np.zeros(inputs.scenarios, np.bool_)
        for chip in range(len(terms.names)):
            who = who[self.hung_at[who] < 0]
            answered = self._answers(chip, who, start[who])
            self._refuse(chip, who[~answered], start, refused)
            if answered.any():
                self._serve(chip, who[answered], start)
            self._stop[who] = start[who]
            start[who] += terms.gap
        who = who[(self.hung_at[who] < 0) & (self._stop[who] <= inputs.end[who])]
        self.over[who] += 1
        self.nacked_rounds[who] += refused[who]
        begun = np.minimum(begun, due + inputs.controller_jitter)
        self.values["round"].take(who, self._stop[who] - begun[who])
        self.values["slack"].take(who, (due + inputs.round_.down(1))[who] - self._stop[who])

    def _answers(self, chip: int, who: Ints, start: Ints) -> NDArray[np.bool_]:
        """Which of them acknowledge a request of this chip."""
        clock = self._inputs.clock.of(who)
        own = self._chip[who] == chip
        mine = np.flatnonzero(own)
        spare = start[mine] - self._inputs.clock.of(who[mine]).tick(self._first[who[mine]])
        self.values["asked"].take(who[mine], spare)
        heard: NDArray[np.bool_] = own & (self._ready[who] < clock.cycle_at(start) + self._terms.seen)
        return heard

    def _refuse(self, chip: int, who: Ints, start: Ints, refused: NDArray[np.bool_]) -> None:
        """Nobody acknowledges: a STOP behind the address. `start` becomes the STOP."""
        bus = self._terms.bus[chip]
        heard = self._inputs.clock.of(who).cycle_at(start[who] + bus.eighth) + self._terms.seen <= self._off[who]
        self.refused[who] |= heard & (self._served[who] == chip)
        start[who] += bus.refused
        self.nacked[who] += start[who] <= self._inputs.end[who]
        refused[who] = True

    def _serve(self, chip: int, who: Ints, start: Ints) -> None:
        """A read. `start` becomes the STOP; the firmware goes on to the next chip, or to the models."""
        lanes = self._interrupts.lanes(who, self._taken[who])
        came = read(self._terms, chip, self._inputs.clock.of(who), lanes, start[who], self._first[who])
        hung = came.hung
        self.hung_at[who[hung]] = came.let_go[hung]
        start[who] = came.stop
        end, marks = lanes.code(came.seen, self._terms.reads[chip].after)
        self._taken[who], self._served[who] = lanes.taken, chip
        self.values["SDIR rises"].take(who[~came.missed], came.cleared[~came.missed])
        self._measure(who, came, ~hung & (came.stop <= self._inputs.end[who]))
        if marks:
            self._first[who], self._chip[who] = end, chip + 1
            self._off[who], self._ready[who] = marks
        else:
            well = ~hung
            self._work(who[well], end[well])

    def _measure(self, who: Ints, came: Read, over: NDArray[np.bool_]) -> None:
        """What measures take of reads that are over."""
        who = who[over]
        self.phases[who] += 2
        self.held[who] = np.maximum(self.held[who], came.held[over])
        self.values["response"].take(who, came.response[over])
        for margin in came.margins:
            self.values["margin of I2CDXR"].take(who, margin[over])
        again, shown = came.again[over], self._shown[who]
        since = np.where(shown > 0, self._ended[np.maximum(shown - 1, 0), who], self._ended[0, who])
        known = self._ended[0, who] <= again
        self.values["age"].take(who[known], (again - np.minimum(since, again))[known])

    def _hang_on(self) -> None:
        """What the end of the run finds where SCL is held for ever."""
        who = np.flatnonzero((self.hung_at >= 0) & (self.hung_at < self._inputs.end))
        lasted = self._inputs.end[who] - self.hung_at[who]
        self.phases[who] += lasted > self.held[who]  # as a value that the end of the run cuts off
        self.held[who] = np.maximum(self.held[who], lasted)
        self.values["margin of I2CDXR"].take(who, -lasted)

    # What it came to ------------------------------------------------------------------

    def observables(self) -> Observables:
        found = {name: Observable.of(name, values) for name, values in self.values.items()}
        found["stretch"] = Observable("stretch", "ticks", self.held, np.zeros_like(self.held), self.phases)
        found["missed rounds"] = Observable.counter("missed rounds", self.missed, self.due)
        found["nacked rounds"] = Observable.counter("nacked rounds", self.nacked_rounds, self.over)
        found["nacked"] = Observable.counter("nacked", self.nacked, self.due * len(self._terms.names))
        return found
