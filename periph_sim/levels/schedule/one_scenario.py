"""One scenario after the other: a row of what it is goes in, a row of what it came to comes out.

The rules are those of `rounds`, which passes over arrays of all scenarios. Here a number is a register of the CPU,
where the module is compiled. A round without an interrupt comes to what it came to before, as `kept` has it.
"""

# core: compiled

from __future__ import annotations

from typing import final

from .clock import Ints
from .kept import NOTHING, Kept, Memory
from .one_lane import FAR, Lane, Piece
from .one_read import OneRead
from .receiver import Receiver
from .terms import Terms
from .value_range import ValueRange

# What a scenario is. Ratios are ticks of a period, and of a cycle; places are of the first draw for it.
HOST_FIRST, FRAME_NUM, FRAME_DEN, FIRST, ROUND_NUM, ROUND_DEN, NUM, DEN, COST, COSTS_AT, FRAMES_AT, ROUNDS_AT, ENDS = (
    range(13)
)
GIVEN = 13
# What it came to: worst, least and count of each measure, and then these.
MEASURES = ("response", "round", "slack", "age", "margin of I2CDXR", "span:model", "asked", "SDIR rises")
COUNTS = 24
MISSED, NACKED, NACKED_ROUNDS, OVER, DUE, HELD, PHASES, HUNG_AT, REFUSED = range(COUNTS, COUNTS + 9)
FOUND = COUNTS + 9


@final
class OneScenario:
    """costs, late, begins: draws of all seeds, those of a seed in a row; each empty where nothing is drawn. late: ticks
    by which frames are late; begins: by which rounds are.
    """

    _response: ValueRange
    _round: ValueRange
    _slack: ValueRange
    _age: ValueRange
    _margin: ValueRange
    _model: ValueRange
    _asked: ValueRange
    _cleared: ValueRange
    _poll: int
    _length: int
    _low: int
    _first_again: int
    _last_again: int
    _bytes: int
    _free: int
    _gap: int
    _seen: int
    _margin_cycles: int
    _first_model: int

    def __init__(self, terms: Terms, receiver: Receiver, line_end: int, costs: Ints, late: Ints, begins: Ints) -> None:
        self._costs, self._begins = costs, begins
        self._drawn_costs, self._drawn_begins = len(costs) > 0, len(begins) > 0
        self._lane = Lane(terms, receiver)
        self._late = late
        self._start = Piece(terms.start)
        self._response, self._round, self._slack, self._age, self._margin, self._model, self._asked, self._cleared = (
            self._ranges
        ) = [ValueRange() for _ in MEASURES]
        self._reads = [OneRead(terms, chip, self._lane, self._margin, self._cleared) for chip in range(len(terms.bus))]
        since = [sum(bus.stop + terms.gap for bus in terms.bus[:chip]) for chip in range(len(terms.bus))]
        edges = [
            begin + edge
            for begin, bus in zip(since, terms.bus, strict=True)
            for edge in (bus.aas, 0, bus.again, bus.rrdy, bus.sdir, *bus.needs, bus.stop)
        ]
        self._memory, self._poll = Memory(edges, terms.poll), terms.poll
        self._length, self._low = since[-1] + terms.bus[-1].stop, terms.low
        self._first_again, self._last_again = terms.bus[0].again, since[-1] + terms.bus[-1].again
        self._bytes = sum(len(bus.needs) for bus in terms.bus)
        self._chips, self._free, self._gap, self._seen = len(terms.bus), terms.free, terms.gap, terms.seen
        self._margin_cycles, self._first_model, self._line_end = terms.margin, terms.first_model, line_end
        self._nothing = NOTHING
        self._clocks = self._as_before = 0
        self._first = self._off = self._ready = self._shown = self._cost = self._cost_at = 0
        self._served, self._chip, self._stop, self._end, self._end_cycle = -1, 0, 0, 0, 0
        self._missed = self._nacked = self._nacked_rounds = self._over = self._due = self._held = self._phases = 0
        self._hung_at, self._refused, self._unheard = -1, False, False

    def run(self, given: Ints, found: Ints, count: int, jitter: int, pause: bool, length: int) -> None:
        """given, found: int64[scenarios, GIVEN] and [scenarios, FOUND], one row behind the other.

        count: rounds. jitter: ticks by which one may begin late. pause: as the host is paced. length: frames of each.
        """
        self._lane.hosts(self._late, len(self._late) > 0, pause, length)
        row: int
        for row in range(len(given) // GIVEN):
            self._one(given, found, row, count, jitter)

    def _one(self, given: Ints, found: Ints, row: int, count: int, jitter: int) -> None:
        at, lane = row * GIVEN, self._lane
        if given[at + NUM] != lane.num or given[at + DEN] != lane.den or not self._clocks:
            self._of_clock(given[at + NUM], given[at + DEN])
        range_: ValueRange
        for range_ in self._ranges:
            range_.clear()
        lane.host(given[at + HOST_FIRST], given[at + FRAME_NUM], given[at + FRAME_DEN], given[at + FRAMES_AT])
        self._end = given[at + ENDS]
        self._end_cycle = lane.cycle_at(self._end + 1)
        self._cost, self._cost_at = given[at + COST], given[at + COSTS_AT]
        self._served, self._stop, self._hung_at, self._refused = -1, -(1 << 40), -1, False
        self._missed = self._nacked = self._nacked_rounds = self._over = self._due = self._held = self._phases = 0
        self._as_before = 0
        self._models(self._first_model)
        due, num, den = given[at + FIRST], given[at + ROUND_NUM], given[at + ROUND_DEN]
        whole, part = num // den, 0
        rest, lates = num - whole * den, given[at + ROUNDS_AT]
        for number in range(count):
            begin = due + self._begins[lates + number] if self._drawn_begins else due
            if begin <= self._end:
                self._due += 1
                if self._hung_at >= 0 or self._stop >= begin:
                    self._missed += 1
                else:
                    self._make(begin, due + jitter, due + whole)
            due += whole
            part += rest
            if part >= den:
                part -= den
                due += 1
        self._count_kept()
        self._hang_on()
        self._tell(found, row * FOUND)

    def _of_clock(self, num: int, den: int) -> None:
        lane = self._lane
        lane.num, lane.den = num, den
        self._clocks += 1
        self._memory.of_clock(num, den)
        read: OneRead
        for read in self._reads:
            read.of_clock(self._clocks)
        takes = self._margin_cycles * num
        self._margin.takes_least, self._margin.takes_most = takes // den, -(-takes // den)
        self._model.takes_most = 1  # floor(part / den), where the others are its ceiling
        range_: ValueRange
        for range_ in self._ranges:
            range_.den = den

    def _make(self, begin: int, latest: int, next_due: int) -> None:
        """A round that is not missed. latest: when it begins as late as can be."""
        lane, kept = self._lane, self._nothing
        start = max(begin, self._stop + self._free)
        cycle = -(-start * lane.den // lane.num)
        rest = cycle * lane.num - start * lane.den
        if self._chip == 0:
            asked = start * lane.den - self._first * lane.num
            if asked > self._asked.above or asked <= self._asked.below:
                self._asked.take_parts(asked, asked, 0)
            self._asked.count += 1
            if self._ready < cycle + self._seen:
                flag = cycle + self._memory.whole[0] + self._seen + (1 if self._memory.part[0] > rest else 0)
                self._first = lane.wait_from_far(self._first, flag, self._poll)
                kept = self._memory.find(rest, self._first - flag)
        if not self._as_kept(kept, start, cycle, rest):
            self._by_reads(kept, start, cycle, rest)
        if self._stop <= self._end and self._hung_at < 0:
            self._over += 1
            self._nacked_rounds += self._unheard
            lasted, slack = self._stop - min(start, latest), next_due - self._stop
            if lasted > self._round.worst or lasted < self._round.least:
                self._round.take_all(lasted, lasted, 0)
            if slack > self._slack.worst or slack < self._slack.least:
                self._slack.take_all(slack, slack, 0)

    def _as_kept(self, kept: Kept, start: int, cycle: int, rest: int) -> bool:
        """Take a round like one that is kept; False if it is not, or if several margins compete to be a new extreme.

        Values that are no new extremes are only counted, and all of them by `_count_kept`.
        """
        lane, end, stop = self._lane, cycle + kept.end, start + self._length
        since, again = self._shown + self._line_end, start + self._first_again
        if kept.of != self._clocks or stop > self._end or since > again or lane.first_begun + self._line_end > again:
            return False
        if lane.lowest <= end * lane.num and lane.latch() <= end:
            return False
        if kept.margins.most - rest > self._margin.above or kept.margins.least - rest <= self._margin.below:
            if not kept.margins.alone:
                return False
            kept.margins.take(self._margin, lane, start, cycle)
        if kept.asked_most - rest > self._asked.above or kept.asked_least - rest <= self._asked.below:
            self._asked.take_parts(kept.asked_most - rest, kept.asked_least - rest, 0)
        if kept.cleared_most - rest > self._cleared.above or kept.cleared_least - rest <= self._cleared.below:
            self._cleared.take_parts(kept.cleared_most - rest, kept.cleared_least - rest, 0)
        if start + self._last_again - since > self._age.worst or again - since < self._age.least:
            self._age.take_all(start + self._last_again - since, again - since, 0)
        self._as_before += 1
        self._served, self._stop, self._unheard = self._chips - 1, stop, False
        self._models(end)
        return True

    def _count_kept(self) -> None:
        chips = self._chips * self._as_before
        if chips:
            self._response.take_all(self._low, self._low, chips)
            self._asked.count += chips - self._as_before
            self._cleared.count += chips
            self._age.count += chips
            self._margin.count += self._bytes * self._as_before
            self._phases += 2 * chips
        self._round.count = self._slack.count = self._over

    def _by_reads(self, kept: Kept, start: int, cycle: int, rest: int) -> None:
        """One read after the other; they are kept where nothing comes between."""
        lane, number, chips = self._lane, self._lane.number, self._chips
        plain: bool
        begun, first_rest, plain = cycle, rest, True
        first_start = start
        cleared_most: int
        cleared_least: int
        cleared_most, cleared_least, asked_most, asked_least = -FAR, FAR, -FAR, FAR
        self._unheard = False
        for chip in range(chips):
            read: OneRead = self._reads[chip]
            if chip:
                start = self._stop + self._gap
                cycle = lane.cycle_at(start)
                rest = cycle * lane.num - start * lane.den
                if self._chip == chip:
                    asked = start * lane.den - self._first * lane.num
                    self._asked.take_part(asked)
                    asked_most, asked_least = max(asked_most, asked), min(asked_least, asked)
            if self._chip != chip or self._ready >= cycle + self._seen:
                self._refuse(read, chip, start)
                continue
            self._serve(read, chip, start, cycle, rest)
            if read.hung:
                return
            plain = plain and read.plain
            cleared_most, cleared_least = max(cleared_most, read.written), min(cleared_least, read.written)
        if self._chip < chips:
            return
        if plain and not self._unheard and lane.number == number and kept is not self._nothing:
            kept.of, kept.end = self._clocks, self._first - begun
            kept.asked_most, kept.asked_least = asked_most + first_rest, asked_least + first_rest
            kept.cleared_most, kept.cleared_least = cleared_most + first_rest, cleared_least + first_rest
            kept.margins.clear(lane.den)
            for chip in range(chips):
                read = self._reads[chip]
                read.keep_margins(kept.margins, first_start, begun)
        self._models(self._first)

    def _refuse(self, read: OneRead, chip: int, start: int) -> None:
        """Nobody acknowledges: a STOP behind the address."""
        self._unheard = True
        self._stop = start + read.refused
        seen = self._lane.cycle_at(start + read.eighth) + self._seen
        if seen <= self._off and self._served == chip:
            self._refused = True
        self._nacked += self._stop <= self._end

    def _serve(self, read: OneRead, chip: int, start: int, cycle: int, rest: int) -> None:
        """A read; the firmware goes on to the next chip, or to the models."""
        lane, end = self._lane, self._end
        read.serve(start, cycle, rest, self._first, end)
        if read.hung:
            self._hung_at = read.let_go
            return
        self._stop, self._served, self._chip = read.stop, chip, chip + 1
        self._first, self._off, self._ready = read.end, read.off, read.ready
        if read.stop <= end:
            self._phases += 2
            self._held = max(self._held, read.held)
            self._response.take(read.response)
            since = self._shown + self._line_end
            if lane.first_begun + self._line_end <= read.again:
                self._age.take(read.again - since if since < read.again else 0)

    def _models(self, begin: int) -> None:
        """They run from this cycle on, and the firmware waits for the first chip."""
        lane, cost = self._lane, self._cost
        self._shown, self._chip = lane.before, 0
        if self._drawn_costs:
            cost += self._costs[self._cost_at]
            self._cost_at += 1
        end = begin + cost
        if lane.lowest > (end + self._start.last) * lane.num:  # no interrupt, neither in them nor in the code behind
            self._first = end + self._start.length
            self._off, self._ready = end + self._start.calm_first, end + self._start.calm_second
        else:
            end = lane.run(begin, cost)
            self._first = lane.code(end, self._start)
            self._off, self._ready = lane.mark, lane.second_mark
        if end < self._end_cycle:
            part = (end - begin) * lane.num
            if part > self._model.above or part <= self._model.below:
                self._model.take(lane.tick(end) - lane.tick(begin))
            else:
                self._model.count += 1
        elif begin < self._end_cycle:
            self._model.take_unfinished(self._end - lane.tick(begin))

    def _hang_on(self) -> None:
        """What the end of the run finds where SCL is held for ever."""
        if 0 <= self._hung_at < self._end:
            lasted = self._end - self._hung_at
            self._phases += lasted > self._held  # as a value that the end of the run cuts off
            self._held = max(self._held, lasted)
            self._margin.take(-lasted)

    def _tell(self, found: Ints, at: int) -> None:
        place = at
        range_: ValueRange
        for range_ in self._ranges:
            found[place], found[place + 1], found[place + 2] = range_.worst, range_.least, range_.count
            place += 3
        found[at + MISSED], found[at + NACKED], found[at + NACKED_ROUNDS] = (
            self._missed,
            self._nacked,
            self._nacked_rounds,
        )
        found[at + OVER], found[at + DUE], found[at + HELD] = self._over, self._due, self._held
        found[at + PHASES], found[at + HUNG_AT], found[at + REFUSED] = self._phases, self._hung_at, self._refused
