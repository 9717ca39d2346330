"""Groups of a case in which rounds and frames start independently, and the runs of such groups.

    rest ---- R ============ rest          a round alone
    rest -- X ======= R ======== rest      a frame and a round that overlap

A *group* begins when the scene is at rest (`closed_table`), and ends when it is at rest again. The SCI samples its
line periodically. Frames that start within one interval of the length of this period, called a *cell*, are received at
the same instant. `frame_cells` finds the limits of the cells. A frame's place in a group is the distance from the start
of the round to the first tick of the frame's cell.
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
PASSES = 4  # a wait must be as before at most this number of passes after a service routine


class Group(NamedTuple):
    """A round, a frame, or both, that start from an orbit of states of rest (`closed_table`).

    round: the tick of the orbit at which the round starts, modulo `Orbits.own` cycles; None for a frame alone.
    frame: the distance from the round to the first tick of the frame's cell, in ticks; None for a round alone. For a
        frame alone, it is counted from the beginning of the orbit.
    """

    round: int | None
    frame: int | None


class GroupRun(NamedTuple):
    """The result of the run of a group. Equal groups have equal results.

    after: the number of the orbit after the group.
    shift: the number of ticks by which the place in this orbit is beyond the place at which the group started plus the
        elapsed time, modulo the length of the orbit.
    main, routine: the digests of `GroupDigest`.
    delay: the number of ticks from the beginning of the frame's cell to the interrupt request of the SCI; 0 for a round
        alone.
    length: the number of ticks from the first start to the rest.
    within: True if the service routine ran within the wait that was given to `run_group`, and the wait then continued;
        always True if no wait was given.
    """

    after: int
    shift: int
    main: int
    routine: int
    delay: int
    length: int
    within: bool

    def is_like(self, other: GroupRun) -> bool:
        """Return True if two runs of a group, or of groups with equal effects, agree."""
        return self[:5] == other[:5]


class Sleep(NamedTuple):
    """A wait: an interval in which the firmware runs a loop whose passes are all equal.

    begin, end: the ticks at which the wait begins and ends, from the start of the round.
    period: the number of ticks of a pass.
    reads: the addresses of the registers that a pass reads, with their values.
    """

    begin: int
    end: int
    period: int
    reads: tuple[tuple[int, int], ...]


class Cells(NamedTuple):
    """The cells of the starts of frames: frames that start in one cell are received at the same instant.

    first: the first tick of a cell, modulo `period`.
    period: the number of ticks of a cell, which is the period of the SCI's samples.
    begins, ends: the least and the greatest number of ticks from the first tick of a cell to the instants at which the
        service routine is entered, and left.
    """

    first: int
    period: int
    begins: int
    ends: int


class Orbit(NamedTuple):
    """The states of rest of one period.

    keys: the digests of the states, one for each cycle.
    origin: the tick of the first state, modulo the period of the SCI's samples.
    """

    keys: tuple[bytes, ...]
    origin: int

    @property
    def cycles(self) -> int:
        return len(self.keys)


class Orbits:
    """The orbits that were found, and the place of each of their states.

    known: the orbits. places: a dictionary from the digest of a state to its orbit and its cycle in the orbit.
    own: the period, in cycles, of the part of the state that does not belong to the SCI; 0 before the first orbit.
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
    """A run of a scene with groups, one after the other.

    records: the records of the present group.
    at: the number of the orbit of the present state of rest, and its cycle in the orbit.
    first_noticed: as `GroupDigest.noticed`, for the time from the first start to the first rest.
    """

    def __init__(
        self, covered: CoveredCase, ignored: Sequence[str], orbits: Orbits, cells: Cells | None = None
    ) -> None:
        """Run the first round and the first frame of the case, up to the first rest.

        ignored: as for `normal_state`. cells: None while they are not known.
        """
        self.records = GroupDigest()
        self._requested = [0]  # the tick of the last interrupt request of an SCI's receiver
        # The callback does not refer to this object, for the reason given in FreeRun.
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
        """Return the orbit and cycle of the present state of rest, as in `at`. Raise NotClosed if it has none."""
        key = digest(self.run.state())
        if key not in self.orbits.places:
            self._add_orbit()
            key = digest(self.run.state())
        return self.orbits.places[key]

    def run_group(self, group: Group, offset: int = 0, sleep: Sleep | None = None) -> GroupRun:
        """Run a group from the present state of rest.

        offset: the number of ticks from the first start in the frame's cell to the start of the frame. A frame of
            another rate can start before or after the cell (`host_rates`).
        sleep: the wait that the service routine interrupts, and that must then go on as before; None to check nothing.
        """
        run, cells, cycle = self.run, self.cells, self.cycle
        orbit = self.orbits.known[self.at[0]]
        period, now = orbit.cycles * cycle, run.now
        from_orbit = now - self.at[1] * cycle  # a tick at which the orbit begins
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
        """Raise NotClosed if the firmware has noticed more of a frame than one service routine of the SCI.

        is_sent: True if a frame was sent; False if the routine must not have run at all.
        """
        records = self.records
        if records.noticed:
            raise NotClosed(f"the firmware notices more of a frame than its service routine: {records.noticed}")
        if records.services != is_sent:
            raise NotClosed(f"a frame has {records.services} service routines of the SCI, not one")

    def sleeps(self, group: Group) -> list[Sleep]:
        """Run a round alone and return the waits in it. The first wait has begun before the round."""
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
        """Return the cycle at which a pass of the present wait began, the cycles of a pass, and its reads.

        Return None if the firmware does not wait.
        """
        polls = self._polls
        found = polls.normal_state(0, 0)
        if not polls.asleep or found["_most"] != NEVER:
            return None
        return polls.began, found["_period"], found["_spin"]

    def _waits_until(self, end: int, sleep: Sleep) -> bool:
        """Advance to the tick before the end of a wait. Return True if the firmware is in this wait then."""
        if end >= NEVER:
            return True
        self.run.scene.advance(end - 1)
        self.run.scene.kernel.settle()
        return self._goes_on(sleep)

    def _goes_on(self, sleep: Sleep) -> bool:
        """Return True if the firmware is in this wait, and has accessed nothing else since the service routine.

        Reads of the registers that the wait reads are allowed, because these registers keep their values until the wait
        ends. The value of any other read could depend on the time at which the routine came.
        """
        asleep = self._asleep()
        if asleep is None or (asleep[1] * self.cycle, asleep[2]) != (sleep.period, sleep.reads):
            return False
        operands = [self._bus.find(address, 16) for address, _ in sleep.reads]
        allowed = {f"{self._unit} R {one.place.name}.{one.register.name}" for one in operands}
        return self.records.accessed_since <= allowed

    def _round_in(self, orbit: Orbit, group: Group) -> int:
        """Return a tick of an orbit for the start of a group's round, such that the frame starts with a cell."""
        assert group.round is not None
        if group.frame is None:
            return group.round
        found = self.rounds_in(orbit, group.round, group.frame)
        assert found, "no round of the orbit has a frame at this distance"
        return found[0]

    def rounds_in(self, orbit: Orbit, tick: int, frame: int) -> list[int]:
        """Return the ticks of an orbit, from `tick` on in steps of the own period, at which a group's round can start.

        frame: the distance of the group's frame, which must start with a cell.
        """
        assert self.cells is not None
        first, period = orbit.origin + frame - self.cells.first, self.cells.period
        places = range(tick, orbit.cycles * self.cycle, self.orbits.own * self.cycle)
        return [at for at in places if (first + at) % period == 0]

    def like(self, group: Group) -> Group:
        """Return the group of the present orbit that is most similar to `group`, a group of another orbit.

        Both groups have the same value of `round`. The value of `frame` is increased by as little as possible, such
        that the frame starts with a cell in the present orbit.
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
        """Advance by one period, and add the orbit of the present state."""
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
        """Return the number of cycles between two samples of the SCI."""
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
    """Return, as (least, greatest, wait), the distances of frames whose service routine is well within each wait."""
    found = []
    for sleep in sleeps:
        least = sleep.begin - cells.begins + MARGIN * cycle
        most = sleep.end - cells.ends - MARGIN * cycle - PASSES * sleep.period
        if least <= most:
            found.append((least, most, sleep))
    return found
