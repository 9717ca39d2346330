"""Groups of a case with rounds and frames, and their runs. The glossary in `periph_sim.proof` has the terms.

rest ---- R ============ rest          a round alone
rest -- X ======= R ======== rest      a frame and a round that overlap; its distance R to X is negative
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple, cast

from ..core.chip import NEVER
from ..core.records import Record
from ..f28335.xint.module import Xint
from ..processor.dsp import Dsp
from .free_run import FreeRun, NotClosed
from .normal_state import NormalState, digest, period_of, periods_of
from .record_digests import SCI, GroupDigest
from .stretch import CoveredCase

MOST_ORBITS = 24
EXTERNAL = "an external interrupt is enabled, whose flags could show the line of the frame"
MARGIN = 8  # cycles before and after a service routine in which it may still affect the wait that it interrupts
REQUESTS = ("PIEIFR9.INTx1", "PIEIFR9.INTx3", "PIEIFR8.INTx5")  # SCIRXINTA, SCIRXINTB, SCIRXINTC
PASSES = 4  # maximum number of passes after a service routine until a wait must be as before


class Group(NamedTuple):
    """A round, a frame, or both, that start from an orbit.

    round: the tick of the orbit at which the round starts, modulo the own period; None for a frame alone.
    frame: the distance in ticks from the start of the round to the first tick of the cell of frames; None for a
        round alone. For a frame alone, it is the tick of the orbit at which the cell of frames begins.
    """

    round: int | None
    frame: int | None


class GroupRun(NamedTuple):
    """The effects of a group, as they were in one run of it.

    after: the number of the orbit that the group leads to.
    shift: the distance between the two orbits, in ticks: t - s - n modulo the new period, if the group starts at tick s
        of the old orbit, and the scene rests n ticks later at tick t of the new orbit. It does not depend on n.
    main: the digest of all records but those of the service routine. routine: the digest of the routine.
    delay: the ticks from the beginning of the cell of frames to the interrupt request of the SCI; 0 for a round alone.
    length: the ticks from the first start to the rest.
    within: True if the service routine ran in the wait that was given to `run_group`, and the wait then went on; also
        True if no wait was given.
    """

    after: int
    shift: int
    main: int
    routine: int
    delay: int
    length: int
    within: bool

    def is_like(self, other: GroupRun) -> bool:
        """Return True if two runs of groups are alike: they are equal except for `length` and `within`."""
        return self[:5] == other[:5]


class Sleep(NamedTuple):
    """A wait: a time in which the firmware runs a loop whose passes are all equal.

    begin, end: the ticks at which it begins and ends, counted from the start of the round.
    period: the number of ticks of a pass.
    reads: the addresses of the registers that a pass reads, with their values.
    """

    begin: int
    end: int
    period: int
    reads: tuple[tuple[int, int], ...]


class Cells(NamedTuple):
    """The cells of frames: equal ranges of ticks. Frames that start in one of them are received at the same instant.

    period: the number of ticks of a cell, which is the period of the SCI's samples.
    first: the tick at which a cell begins, modulo `period`.
    begins: the least number of ticks from the beginning of a cell of frames to the entry into the service routine.
    ends: the greatest number of ticks from the beginning of a cell of frames to the end of the service routine.
    """

    first: int
    period: int
    begins: int
    ends: int


class Orbit(NamedTuple):
    """An orbit.

    keys: the digests of its states, one for each cycle of the period.
    origin: the tick of its first state, modulo the period of the SCI's samples.
    """

    keys: tuple[bytes, ...]
    origin: int

    @property
    def cycles(self) -> int:
        return len(self.keys)


class Orbits:
    """The orbits that were found, and the place of each of their states.

    known: the orbits. The index of an orbit is its number.
    places: for the digest of each state, the number of its orbit, and its cycle in the orbit.
    own: the own period of all orbits, in cycles; 0 before the first orbit is found.
    """

    def __init__(self) -> None:
        self.known: list[Orbit] = []
        self.places: dict[bytes, tuple[int, int]] = {}
        self.own = 0

    def add(self, orbit: Orbit) -> None:
        """Add an orbit, unless it is known."""
        if orbit.keys[0] not in self.places:
            self.places |= {key: (len(self.known), cycle) for cycle, key in enumerate(orbit.keys)}
            self.known.append(orbit)


class GroupRunner:
    """A run of the case with many groups, one after the other.

    records: the digests of the last group.
    at: the present place of rest: the number of its orbit, and the cycle in the orbit.
    first_noticed: what the firmware notices of the case's first frame, apart from the service routine; "" for nothing.
    """

    def __init__(
        self, covered: CoveredCase, ignored: Sequence[str], orbits: Orbits, cells: Cells | None = None
    ) -> None:
        """Run the first round and the first frame of the case, up to the first rest.

        ignored: the ignored attributes. cells: the cells of frames; None while they are not known.
        """
        self.records = GroupDigest()
        self._requested = [0]  # one item: the tick of the last interrupt request of a receiving SCI
        # The callback must not refer to this object: the reference would keep both alive for ever.
        self.run = FreeRun(covered, ignored, False, False, self.records, partial(_note_request, self._requested))
        self.first_noticed = self.records.noticed
        self.records.noticed = ""  # until now, accesses are allowed: start-up code sets up the SCI
        self.orbits = orbits
        self.cells = cells
        (dsp, *_) = self.run.scene.units.values()
        program: Any = dsp.program
        self._polls: Any = program.cpu.polls
        self._bus: Any = dsp.processor.bus
        self._unit = dsp.name
        if has_external_interrupt(dsp):
            raise NotClosed(EXTERNAL)
        self._sci = tuple(f"{name}.{SCI}" for name in self.run.scene.units)
        self._lspclk = {f"{name}.SYS.chip.lspclk_phase" for name in self.run.scene.units}
        self.at = self.place()

    @property
    def cycle(self) -> int:
        """The number of ticks of a cycle."""
        return self.run.ticks_per_cycle

    def place(self) -> tuple[int, int]:
        """Return the present place, as in `at`, and add its orbit if it is new. Raise NotClosed if it has no orbit."""
        key = digest(self.run.state())
        if key not in self.orbits.places:
            self._add_orbit()
            key = digest(self.run.state())
        return self.orbits.places[key]

    def run_group(self, group: Group, offset: int = 0, sleep: Sleep | None = None) -> GroupRun:
        """Run a group from the present place.

        offset: the start of the frame, counted in ticks from the beginning of its cell of frames. In `host_rates`, it
            can be negative or beyond the end of this cell.
        sleep: the wait in which the service routine must come, and which must then go on (`GroupRun.within`); None to
            check nothing.
        """
        run, cells, cycle = self.run, self.cells, self.cycle
        orbit = self.orbits.known[self.at[0]]
        period, now = orbit.cycles * cycle, run.now
        from_orbit = now - self.at[1] * cycle  # the tick at which the present period of the orbit began
        if group.round is None:
            assert group.frame is not None
            at = group.frame
        else:
            at = self._round_in(orbit, group)
        start = from_orbit + at
        later = 0 if group.round is None else group.frame or 0
        while start + min(0, later + min(0, offset)) <= now:
            start += period
        frame = None if group.frame is None else start + (group.frame if group.round is not None else 0)
        if frame is not None:
            assert cells is not None
            if (frame - cells.first) % cells.period:
                raise AssertionError("a frame is not at the first tick of its cell")
            frame += offset
        first = min(one for one in (frame, start if group.round is not None else None) if one is not None)
        run.start(frame, None if group.round is None else start, count_from=start)
        within = sleep is None or self._waits_until(start + sleep.end, sleep)
        run.settle()
        if sleep is not None:
            entered, left = self.records.entered - start, self.records.left - start
            within = within and sleep.begin <= entered and left < sleep.end
            within = within and (sleep.end < NEVER or self._goes_on(sleep))
        self.check_frame(frame is not None)
        delay = 0 if frame is None else self._requested[0] - frame + offset
        self.at = after, there = self.place()
        length = run.now - start
        shift = (there * cycle - at - length) % (self.orbits.known[after].cycles * cycle)
        return GroupRun(after, shift, self.records.digest, self.records.routine, delay, run.now - first, within)

    def check_frame(self, is_sent: bool) -> None:
        """Raise NotClosed if the firmware has noticed anything of a frame but one call of the SCI's service routine.

        is_sent: True if a frame was sent. If not, the routine must not have been called.
        """
        records = self.records
        if records.noticed:
            raise NotClosed(f"the firmware notices more of a frame than its service routine: {records.noticed}")
        if records.services != is_sent:
            raise NotClosed(f"a frame has {records.services} service routines of the SCI, not one")

    def sleeps(self, group: Group) -> list[Sleep]:
        """Run `group`, a round alone, and return the waits in it. The first one is the wait of the rest before it."""
        run, kernel = self.run, self.run.scene.kernel
        orbit = self.orbits.known[self.at[0]]
        period = orbit.cycles * self.cycle
        start = run.now + (self._round_in(orbit, group) - self.at[1] * self.cycle) % period + period
        run.start(rounds=start)
        found: list[Sleep] = []
        asleep, begun = self._asleep(), -NEVER
        while kernel.next_time() < NEVER or not run.is_over():
            tick = kernel.next_time()
            run.scene.advance(tick)
            kernel.settle()
            now = self._asleep()
            if now != asleep:
                if asleep is not None:
                    found.append(Sleep(begun, tick - start, asleep[1] * self.cycle, asleep[2]))
                begun, asleep = tick - start, now
        if asleep is not None:
            found.append(Sleep(begun, NEVER, asleep[1] * self.cycle, asleep[2]))
        run.settle()
        self.at = self.place()
        return found

    def _asleep(self) -> tuple[int, int, tuple[tuple[int, int], ...]] | None:
        """Return what is known of the present wait; None if the firmware does not wait.

        The result has the cycle at which a pass began, the number of cycles of a pass, and the addresses and values
        that a pass reads.
        """
        polls = self._polls
        found = polls.normal_state(0, 0)
        if not polls.asleep or found["_most"] != NEVER:
            return None
        return polls.began, found["_period"], found["_spin"]

    def _waits_until(self, end: int, sleep: Sleep) -> bool:
        """Advance to the tick before `end`, at which a wait ends. Return True if the firmware is still in this wait."""
        if end >= NEVER:
            return True
        self.run.scene.advance(end - 1)
        self.run.scene.kernel.settle()
        return self._goes_on(sleep)

    def _goes_on(self, sleep: Sleep) -> bool:
        """Return True if the firmware is in this wait, and has not done anything else since the service routine.

        The only accesses since then must be reads of registers that the wait reads. They keep their values until the
        wait ends. The value of any other read could depend on the time at which the routine came.
        """
        asleep = self._asleep()
        if asleep is None or (asleep[1] * self.cycle, asleep[2]) != (sleep.period, sleep.reads):
            return False
        operands = [self._bus.find(address, 16) for address, _ in sleep.reads]
        allowed = {f"{self._unit} R {one.place.name}.{one.register.name}" for one in operands}
        return self.records.accessed_since <= allowed

    def _round_in(self, orbit: Orbit, group: Group) -> int:
        """Return a tick of an orbit at which the round of a group can start (see `rounds_in`)."""
        assert group.round is not None
        if group.frame is None:
            return group.round
        found = self.rounds_in(orbit, group.round, group.frame)
        assert found, "no round of the orbit has a frame at this distance"
        return found[0]

    def rounds_in(self, orbit: Orbit, tick: int, frame: int) -> list[int]:
        """Return the ticks of an orbit at which the round of a group can start.

        tick: the tick of the round modulo the own period. One tick in each own period is tried.
        frame: the distance of the frame. At this distance from each tick of the result, a cell of frames begins.
        """
        assert self.cells is not None
        first, period = orbit.origin + frame - self.cells.first, self.cells.period
        places = range(tick, orbit.cycles * self.cycle, self.orbits.own * self.cycle)
        return [at for at in places if (first + at) % period == 0]

    def like(self, group: Group) -> Group:
        """Return the group of the present orbit that is most similar to `group`, a group of another orbit.

        The cells of frames begin at other ticks of the present orbit. So the value of `frame` is increased to the next
        distance at which such a cell begins. The value of `round` does not change.
        """
        orbit = self.orbits.known[self.at[0]]
        if group.frame is None:
            return group
        if group.round is None:
            assert self.cells is not None
            return Group(None, group.frame + (self.cells.first - orbit.origin - group.frame) % self.cells.period)
        distances = range(group.frame, group.frame + self.orbits.own * self.cycle, self.cycle)
        return next(Group(group.round, one) for one in distances if self.rounds_in(orbit, group.round, one))

    def _add_orbit(self) -> None:
        """Advance by one period, and add the states of this period as an orbit."""
        run, orbits = self.run, self.orbits
        if len(orbits.known) == MOST_ORBITS:
            raise NotClosed(f"there are more than {MOST_ORBITS} states of rest, apart from the clocks")
        period, sci = period_of(run.scene), self.sci_period()
        states: list[NormalState] = []
        keys: list[bytes] = []
        own: list[bytes] = []
        origin = run.now % (sci * self.cycle)
        for _ in range(period):
            states[:] = [run.state()]
            keys.append(digest(states[0]))
            own.append(digest(self._without_sci(states[0])))
            run.next_cycle()
        last = run.state()
        if digest(last) != keys[0]:
            raise run.not_repeating(states[0], last)
        repeats = next(n for n in range(1, period + 1) if own[n:] == own[:-n])
        if orbits.own not in (0, repeats) or len(set(keys)) < period or period % repeats:
            raise NotClosed("the states of rest have different periods")
        orbits.own = repeats
        orbits.add(Orbit(tuple(keys), origin))

    def sci_period(self) -> int:
        """Return the number of cycles from one sample of the SCI to the next."""
        periods = {p for name, p in periods_of(self.run.scene).items() if name.startswith(self._sci)}
        if len(periods) != 1:
            raise NotClosed("it has more than one SCI, or none is on")
        return periods.pop()

    def _without_sci(self, state: NormalState) -> NormalState:
        return {key: value for key, value in state.items() if not key.startswith(self._sci) and key not in self._lspclk}


def _note_request(requested: list[int], record: Record) -> None:
    if record.value and record.what in REQUESTS:
        requested[0] = record.tick


def has_external_interrupt(dsp: Dsp) -> bool:
    """Return True if an external interrupt of a unit is enabled now."""
    xint = dsp.sockets.get("XINT")
    return xint is not None and bool(cast(Xint, xint.chip).enabled)


def far_ranges(sleeps: Sequence[Sleep], cells: Cells, cycle: int) -> list[tuple[int, int, Sleep]]:
    """Return, for each wait, the least and greatest distance of frames whose routine is surely in it, and the wait."""
    found = []
    for sleep in sleeps:
        least = sleep.begin - cells.begins + MARGIN * cycle
        most = sleep.end - cells.ends - MARGIN * cycle - PASSES * sleep.period
        if least <= most:
            found.append((least, most, sleep))
    return found
