"""Rounds by table: the firmware's state of all scenarios goes in; theirs behind the round comes out, and who is left.

    q <= flag - enough      served while the firmware waits for the round: the phase moves by `service`
    q in a window           the row of its wait
    no q in the round       row 0
    START comes too early   refused, all of the round; the firmware waits on
    it hangs                missed
    anything else           left to `rounds`, read by read: an interrupt near a flag or in code

    begin of the models = flag + table[row, phase];  end = begin + cost, later by each interrupt in it;  first fetch ..

What takes time is passing over arrays, so each is passed over as seldom as can be, and most of them in place.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .clock import CpuClock, Ints
from .extremes import Extremes
from .inputs import Inputs
from .lanes import Interrupts
from .stored import Stored
from .tables import RoundTable, round_tables
from .terms import Terms


class State(Protocol):
    """Of `rounds.Rounds`."""

    first: Ints
    ready: Ints
    off: Ints
    served: Ints
    next: Ints
    shown: Ints
    cost: Ints
    cost_step: int
    stop: Ints
    odd: NDArray[np.bool_]
    refused: NDArray[np.bool_]
    hung_at: Ints
    due: Ints
    over: Ints
    missed: Ints
    nacked: Ints
    nacked_rounds: Ints
    phases: Ints
    begun: Stored
    interrupts: Interrupts
    values: dict[str, Extremes]
    all: Ints
    costs: Ints


def plain_rounds(state: State, terms: Terms, inputs: Inputs) -> PlainRounds | None:
    """None where scenarios differ in when rounds begin, or in the unit's clock: then each goes read by read."""
    clock = inputs.clock
    alike = inputs.controller_jitter == 0 and isinstance(clock.num, int)
    alike &= isinstance(inputs.round_.num, int) and bool((inputs.controller_first == inputs.controller_first[0]).all())
    if not alike or inputs.scenarios < 2:
        return None
    first = int(inputs.controller_first[0])
    starts = np.array([first + int(inputs.round_.down(number)) for number in range(inputs.rounds + 1)], np.int64)
    length = sum(bus.stop for bus in terms.bus) + terms.gap * len(terms.bus) + terms.free
    if int(np.diff(starts).min()) <= length:
        return None
    return PlainRounds(state, terms, inputs, clock, starts)


class PlainRounds:
    def __init__(self, state: State, terms: Terms, inputs: Inputs, clock: CpuClock, starts: Ints) -> None:
        self._state, self._terms, self._inputs, self._clock = state, terms, inputs, clock
        self._tables = round_tables(terms, clock, starts[:-1])
        self._dues = starts
        self._rounds = 0
        self._left = np.zeros(inputs.scenarios, np.int64)  # rounds that went read by read
        buses = [sum(bus.stop + terms.gap for bus in terms.bus[:chip]) for chip in range(len(terms.bus))]
        self._agains = [since + bus.again for since, bus in zip(buses, terms.bus, strict=True)]
        self._stop = buses[-1] + terms.bus[-1].stop
        self._known = int(state.begun.at(state.all).max()) + inputs.line.end  # the first frame of all is over

    def round(self, number: int) -> Ints:
        """The scenarios that are left, with the state that they had: they go read by read."""
        state, terms, table = self._state, self._terms, self._tables[number]
        latches, scenarios = state.interrupts.latches, self._inputs.scenarios
        first, place = state.first, state.next
        phase, place, coming = self._served_before(table, first - table.flag, place.copy())
        phase -= phase // terms.poll * terms.poll
        busy = state.odd | (state.stop > table.start - terms.free)
        late = np.flatnonzero((first >= table.heard) & ~busy)
        deaf = state.ready[late] >= table.heard
        refused, hung = late[deaf], np.flatnonzero(state.hung_at >= 0)
        left = [np.flatnonzero(busy), late[~deaf]]
        hit = np.flatnonzero(coming <= table.flag + table.last)
        if hit.size:
            at = np.searchsorted(table.windows, coming[hit] - table.flag, side="right")
            phase[hit] += ((at >> 1) + 1) * terms.poll
            left.append(hit[at & 1 == 0])
            phase[left[-1]] = 0
            place[hit] += scenarios
            coming[hit] = latches.at(place[hit])
            left.append(hit[coming[hit] <= table.flag + table.last])
        if not table.plain.all():
            left.append(np.flatnonzero(~table.plain[phase]))
        apart = np.zeros(self._inputs.scenarios, np.bool_)
        for some in left:
            apart[some] = True
        apart[refused] = apart[hung] = False
        but = np.flatnonzero(apart)
        apart[refused] = apart[hung] = True
        others = np.flatnonzero(apart)
        self._rounds += 1
        self._left[others] += 1
        self._take(number, table, phase, others)
        self._work(number, table, phase, place, coming, others)
        self._refuse(number, table, refused)
        state.due[hung] += 1
        state.missed[hung] += 1
        state.next[hung] = state.interrupts.latches.last_row + hung  # nobody looks at their interrupts any more
        return but

    def _refuse(self, number: int, table: RoundTable, who: Ints) -> None:
        """Nobody hears the first START, and so nobody acknowledges in this round; the firmware waits on."""
        if not who.size:
            return
        state, terms, values, start = self._state, self._terms, self._state.values, table.start
        values["asked"].take(who, start - self._clock.tick(state.first[who]))
        stop = start
        for chip, bus in enumerate(terms.bus):
            stop = start + bus.refused
            seen = int(self._clock.cycle_at(np.array([start + bus.eighth]))[0]) + terms.seen
            state.refused[who] |= (seen <= state.off[who]) & (state.served[who] == chip)
            start = stop + terms.gap
        for counted, by in ((state.due, 1), (state.over, 1), (state.nacked, len(terms.bus)), (state.nacked_rounds, 1)):
            counted[who] += by
        values["round"].take(who, np.full(who.size, stop - table.start, np.int64))
        slack = self._dues[number] + int(self._inputs.round_.down(1)) - stop
        values["slack"].take(who, np.full(who.size, slack, np.int64))
        state.stop[who] = stop

    def _served_before(self, table: RoundTable, phase: Ints, place: Ints) -> tuple[Ints, Ints, Ints]:
        """Interrupts that come while the firmware waits for the round: phase, place and latch of the next one."""
        terms, latches = self._terms, self._state.interrupts.latches
        until = table.flag - 2 * terms.poll - terms.waits - terms.service
        coming = latches.at(place)
        early = coming <= until
        found = np.count_nonzero(early)
        if 8 * found > early.size:  # most of them: all at once
            phase += early * terms.service
            place += early * self._inputs.scenarios
            coming = latches.at(place)
            early = coming <= until
        hit = np.flatnonzero(early)
        while hit.size:
            phase[hit] += terms.service
            place[hit] += self._inputs.scenarios
            coming[hit] = latches.at(place[hit])
            hit = hit[coming[hit] <= until]
        return phase, place, coming

    def _take(self, number: int, table: RoundTable, entry: Ints, but: Ints) -> None:
        """What measures take of the round, but for these scenarios."""
        state, values, clock = self._state, self._state.values, self._clock
        for name, range_ in (("margin of I2CDXR", table.margins), ("SDIR rises", table.rises), ("asked", table.asked)):
            if range_ is not None:
                worst, least = range_
                values[name].take_range(worst.take(entry, mode="clip"), least.take(entry, mode="clip"), but)
        values["asked"].take_all(table.start - clock.tick(state.first), but)
        since = state.begun.at(np.maximum(state.shown - self._inputs.scenarios, state.all))
        since += self._inputs.line.end
        self._take_age(table, since, but)
        stop = table.start + self._stop
        values["slack"].take_all(self._dues[number] + int(self._inputs.round_.down(1)) - stop, but)

    def _take_age(self, table: RoundTable, since: Ints, but: Ints) -> None:
        """since: the end of the frame that the reads carry."""
        age = self._state.values["age"]
        agains = [table.start + again for again in self._agains]
        if agains[0] >= self._known and int(since.max()) <= agains[0]:
            age.take_range(agains[-1] - since, agains[0] - since, but)
            return
        if agains[0] >= self._known:
            oldest, youngest = (again - np.minimum(since, again) for again in (agains[-1], agains[0]))
            age.take_range(np.maximum(oldest, youngest), np.minimum(oldest, youngest), but)
            return
        there = np.ones(since.size, np.bool_)
        there[but] = False
        age.count -= len(agains) * there  # as `count` takes all rounds to have one of each read
        first = self._state.begun.at(self._state.all) + self._inputs.line.end
        for again in agains:
            who = np.flatnonzero(there & (first <= again))
            age.take(who, again - np.minimum(since[who], again))

    def _work(self, number: int, table: RoundTable, entry: Ints, place: Ints, coming: Ints, but: Ints) -> None:
        """The models run, and the firmware waits for the first chip again."""
        state, terms, inputs = self._state, self._terms, self._inputs
        begin = table.begin.take(entry, mode="clip")
        begin += table.flag
        shown = place.copy()
        cost = state.costs.take(state.cost, mode="clip")
        end = begin + cost
        start = terms.start
        first = end + start.length
        off, ready = (end + calm for calm, _ in start.marks)
        hit = np.flatnonzero(coming <= end + start.last)
        if hit.size:
            lanes = state.interrupts.lanes(place[hit])
            end[hit] = late = lanes.run(begin[hit], cost[hit])
            first[hit], (off[hit], ready[hit]) = lanes.code(late, start)
            place[hit] = lanes.places
        ended = self._clock.tick(end)
        lasted = ended - table.begun.take(entry, mode="clip")
        if number + 1 < inputs.rounds or int(ended.max()) <= int(inputs.end.min()):
            state.values["span:model"].take_all(lasted, but)
        else:
            cut = np.unique(np.concatenate([but, np.flatnonzero(ended > inputs.end)]))
            state.values["span:model"].take_all(lasted, cut)
            cut = np.setdiff1d(cut, but)
            state.values["span:model"].count[cut] -= 1  # as `count` takes all of them to have one
            began = table.begun[entry[cut]]
            state.values["span:model"].take_unfinished(cut, inputs.end[cut] - began)
        news = ("first", first), ("off", off), ("ready", ready), ("next", place), ("shown", shown)
        for name, new in news:
            new[but] = getattr(state, name)[but]
            setattr(state, name, new)
        kept = state.stop[but], state.served[but], state.cost[but]
        state.stop.fill(table.start + self._stop)
        state.served.fill(len(terms.names) - 1)
        state.cost += state.cost_step
        state.stop[but], state.served[but], state.cost[but] = kept

    def count(self) -> None:
        """How many values all rounds by table took."""
        state, terms = self._state, self._terms
        times, reads = self._rounds - self._left, len(terms.names)
        values, there = state.values, np.flatnonzero(times)
        values["response"].take(there, np.full(there.size, terms.low, np.int64))
        values["round"].take(there, np.full(there.size, self._stop, np.int64))
        values["response"].count += reads * times - (times > 0)
        values["round"].count += times - (times > 0)
        values["margin of I2CDXR"].count += sum(len(bus.needs) for bus in terms.bus) * times
        for name, each in (("slack", 1), ("span:model", 1), ("age", reads), ("asked", reads), ("SDIR rises", reads)):
            values[name].count += each * times
        state.due += times
        state.over += times
        state.phases += 2 * reads * times
