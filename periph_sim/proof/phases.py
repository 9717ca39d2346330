"""The phases of a case: which starts a coverage moves, and the inputs that place them at given phases.

    rounds   R0-------R1-------R2-------      a frame's phase is counted from the round in which the frame begins
    frames        F0-------F1-------F2--
              |-p-|

With a host and a controller, the frames move, and the rounds keep the schedule of the case. Frames do not come more
often than in the case: if their period is 3.2 rounds, for example, there is a frame in each fourth round. With only a
host or only a controller, its starts move, and a phase is counted from the time at which the start would be due without
jitter. With only a table [serial], all its times `at` are later by the phase, and each run has one phase.

In a coverage of the start-up, a phase is the time from the start of the run to the first moved start. The other starts
follow at the distance of a period. The phases end at the first round of the case or, without rounds, after one period.
The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import accumulate
from math import ceil
from random import Random
from typing import Literal, NamedTuple

from ..scene.case.inputs_table import InputsTable
from ..scene.case.model import BadCase, Case
from ..scene.case.party_tables import HOST_SEED
from ..scene.plan import ScenePlan

# The default of `rounds`. At 115200 baud, an SCI samples every 41 cycles of LSPCLK. Therefore its sampling instants
# have the same position in a round of 20 ms, which is 750,000 of these cycles, only in every 41st round.
ROUNDS = 41
REPEATED = 2  # repetitions of the last phase of a run: a phase can affect ages of data up to two rounds later
WARM_UP = 3  # minimum number of periods before the first moved start; the firmware starts up in them
# Tolerance in rounds: if the period of the frames is 0.95 to 1.05 rounds, runs have one frame in each round.
NEARLY = Fraction(1, 20)
SERIAL_SPAN = Fraction(1, 1000)  # in seconds: the phases of sends, which have no period, are below this by default

Moved = Literal["frames", "rounds", "sends"]


class Grid(NamedTuple):
    """The times at which periods begin. first: the tick at which the first one begins. period: in ticks, exact."""

    first: int
    period: Fraction

    def due(self, number: int) -> int:
        return self.first + number * self.period.numerator // self.period.denominator


class Phases:
    """The phases of one case. Raise BadCase if its starts cannot be moved (see `moved_starts`).

    rounds: the number of moved starts in a run with one phase alone.
    start_up: False for moved starts after the start-up, each at its phase in a period. True for a first moved start at
        its phase in the start-up; the other starts follow it at distances of a period.
    moved: the starts that move: frames of the host, rounds of the controller, or sends of [serial].
    cycle: the length of a cycle of the fastest unit at its nominal clock, in ticks. Phases are counted in such cycles.
    count: the number of phases: the cycles in a period; with `start_up` and a controller, those before the first round.
    first_start: the tick at which the first start is due, counted from the start of the run.
    jitter: the largest delay of a moved start in the case, in ticks; 0 without jitter.
    warm_up: if `start_up` is False, the number of periods before the first moved start, so that it comes after the time
        `after` of each budget; if it is True, the number of starts that are added at the end of a run.
    """

    def __init__(self, plan: ScenePlan, start_up: bool = False, rounds: int = ROUNDS) -> None:
        case, ticks = plan.case, plan.ticks
        self.moved = moved_starts(case)
        self.start_up = start_up
        self.rounds = rounds
        if start_up and self.moved == "sends":
            raise case.mistake("its times are counted from the start-up anyway; leave --start-up out", "serial")
        self._case, self._plan = case, plan
        self.ticks_per_second = self._per_second = ticks.timebase.per_second
        self._start = ticks.start
        self.cycle = int(self._per_second / max(unit.oscclk * unit.pll / 2 for unit in case.unit.values()))
        self._grid = _grid(plan)
        self.first_start = self._grid.first - self._start
        self.jitter = _jitter(plan, self.moved)
        self._adds_delays = self.moved == "frames" and plan.host[0].paced_by == "pause"
        is_before_rounds = start_up and case.controller is not None
        self.count = int((self.first_start if is_before_rounds else self._grid.period) // self.cycle)
        if not self.count:
            raise case.mistake(
                "the first round starts at once, so there is no start-up before it", "controller", "first"
            )
        self._rounds_per_frame = 1
        if case.host is not None and case.controller is not None:
            self._rounds_per_frame = max(1, ceil(case.host.period / case.controller.period - NEARLY))
        judged_from = max((limit.not_before for limit in plan.limits), default=0)
        if self.is_relative:
            judged_from = max(judged_from, self._start + plan.host[0].first)
        self.warm_up = max(WARM_UP, ceil((judged_from - self._grid.first) / self._grid.period))

    @property
    def is_relative(self) -> bool:
        """True if a phase is counted from the start of a round, as for the frames of a case with rounds."""
        return self.moved == "frames" and self._case.controller is not None and not self.start_up

    @property
    def is_one_a_run(self) -> bool:
        """True if a run can contain only one phase."""
        return self.moved == "sends" or self.start_up

    def least_distance(self, within: Fraction = Fraction(0)) -> int:
        """Return the least distance of two starts in the case, in ticks.

        In a case with rounds and frames, it is that of two rounds or of two frames, whichever is smaller.

        within: the greatest difference of the controller's clock from that of the case, in ppm, which makes the
            distance smaller. It has no effect in a case with rounds and frames.
        """
        longest = self._grid.period + self.jitter
        if self.is_relative:
            host, rounds = self._plan.host[0], self._plan.head.schedule
            return min(int(one.period) - one.jitter for one in (host, rounds))
        return int(self._grid.period) - self.jitter - ceil(longest * 2 * within / 10**6)

    @property
    def most_starts(self) -> int | None:
        """The number of moved starts of the case; None if there is no limit."""
        return self._plan.host[0].frames if self.moved == "frames" else self._plan.head.schedule.rounds

    def due_starts(self, count: int) -> list[int]:
        """Return the ticks at which the first `count` moved starts are due, counted from the start of the run."""
        period = self._grid.period // 1 if self._adds_delays else self._grid.period
        grid = Grid(self.first_start, Fraction(period))
        return [grid.due(number) for number in range(count)]

    def delays(self, seed: int, count: int) -> list[int]:
        """Return the delays by jitter, in ticks, that the first `count` moved starts of the case have with this seed.

        With `paced_by = "pause"`, each delay also delays all later starts.
        """
        random = Random(seed + HOST_SEED if self.moved == "frames" else seed)
        drawn = [random.randrange(self.jitter + 1) for _ in range(count)]
        return list(accumulate(drawn)) if self._adds_delays else drawn

    def first_starts(self) -> dict[str, int]:
        """Return the tick at which the first start is due, from the start of the run, by the kind of the start.

        In a case with rounds and frames, the kinds are "frames" and "rounds"; otherwise, the only kind is `moved`.
        """
        if not self.is_relative:
            return {self.moved: self.first_start}
        return {"frames": self._plan.host[0].first, "rounds": self.first_start}

    def not_exact(self, any_tick: bool) -> str:
        """Return why a case with rounds and frames has no closed table because of its starts; "" if it can have one.

        The first starts must be without jitter. Rounds must start with a cycle, unless `any_tick` is True.
        """
        host, rounds = self._plan.host[0], self._plan.head.schedule
        for name, jitter in (("host", host.jitter), ("controller", rounds.jitter)):
            if jitter:
                return f'{name}.jitter moves the first start; set it to "0 ms", since all later starts are free anyway'
        if not any_tick and any(tick % self.cycle for tick in (self._start, rounds.first, Fraction(rounds.period))):
            way = "add --any-tick, or choose controller.first, period and ppm so"
            return f"its rounds do not start with cycles of the CPU; {way}"
        return ""

    def due(self, number: int) -> int:
        """Return the tick from which the phase of moved start `number` is counted. Do not call it with `start_up`."""
        return self._grid.due(self.warm_up + number * self._rounds_per_frame)

    def starts(self, phases: Sequence[int]) -> list[int]:
        """Return the ticks of moved starts, one for each of these phases, in this order.

        The first one comes after the warm-up. A coverage of the start-up has no warm-up: there, the first start has the
        first phase, and the others follow at distances of a period, whatever their phases are.
        """
        if self.start_up:
            first = self._start + phases[0] * self.cycle - self._grid.first
            return [first + self._grid.due(number * self._rounds_per_frame) for number in range(len(phases))]
        return [self.due(number) + phase * self.cycle for number, phase in enumerate(phases)]

    def inputs(self, phases: Sequence[int]) -> tuple[InputsTable, Fraction]:
        """Return a table [inputs] with moved starts of these phases, and the duration of the run in seconds.

        A single phase has `rounds` starts; in a coverage of the start-up, it has `warm_up` more. Of several phases,
        each has one start, and the last one has REPEATED more, so that late effects of its first start are seen.

        For sends, there must be exactly one phase. All sends of the case are then later by this phase.
        """
        if self.moved == "sends":
            (phase,) = phases
            return InputsTable(sends_later=self.seconds(phase)), self._case.duration + self.seconds(phase)
        more = 1 + (self.rounds - 1 if len(phases) == 1 else REPEATED) + (self.warm_up if self.start_up else 0)
        starts = [start - self._start for start in self.starts([*phases, *[phases[-1]] * more])]
        return self.inputs_at(starts[:-1]), Fraction(starts[-1] - 1, self._per_second)

    def inputs_at(self, starts: Sequence[int], rounds: Sequence[int] | None = None) -> InputsTable:
        """Return a table [inputs] with starts at these ticks, counted from the start of the run.

        starts: the moved starts, which must not be sends.
        rounds: the starts of rounds in a case whose frames move; None for the rounds of the schedule.
        """
        times = tuple(Fraction(start, self._per_second) for start in starts)
        if self.moved != "frames":
            return InputsTable(rounds=times)
        return InputsTable(
            frames=times, rounds=None if rounds is None else tuple(Fraction(one, self._per_second) for one in rounds)
        )

    def cycles_after_due(self, tick: int) -> int:
        """Return the number of cycles from the beginning of the period that contains a tick to this tick."""
        number = ceil((tick + 1 - self._grid.first) / self._grid.period) - 1  # number of the period with `tick`
        return (tick - self._grid.due(number)) // self.cycle

    def between(self, first: Fraction, last: Fraction) -> tuple[int, int]:
        """Return the lowest and the highest phase between two times, in seconds. Raise BadCase if there is no phase.

        Phases of sends have no upper limit; others are at most `count` - 1.
        """
        low = -(-first * self._per_second // self.cycle)
        high = last * self._per_second // self.cycle
        if self.moved != "sends":
            high = min(high, self.count - 1)
        if low > high:
            period = float(1000 * self.seconds(self.count))
            what = f"no phase lies between these two times; the phases are those of a period, 0 ms to {period:g} ms"
            raise BadCase(f"--phases: {what}")
        return int(low), int(high)

    def phase_at(self, phases: Sequence[int], at: float) -> int:
        """Return the phase that the last moved start had at a time, in a run with these phases.

        Before the first moved start, it is the first phase. at: seconds from the start of the run.
        """
        tick = self._start + round(at * self._per_second)
        number = sum(start <= tick for start in self.starts(phases))
        return phases[max(0, number - 1)]

    def seconds(self, phase: int) -> Fraction:
        """Return the duration of a phase in seconds."""
        return Fraction(phase * self.cycle, self._per_second)


def moved_starts(case: Case) -> Moved:
    """Return which starts of a case move.

    Raise BadCase if the case has no firmware or no free start, or if it has one of these inputs: faults, an outside
    party, starts in [inputs], [serial] beside [host] or [controller], a limited number of rounds beside [host], or
    frames with a period below 0.95 rounds.
    """
    if not case.unit:
        raise case.mistake("there is no firmware to cover; give it a [unit.NAME]", "unit")
    if case.fault:
        raise case.mistake("prove does not move the times of faults; remove the tables", "fault")
    if case.outside is not None:
        raise case.mistake("prove does not move the starts of an outside party; remove the table", "outside")
    for key in ("lose", "silent", "twice"):
        if case.host is not None and getattr(case.host, key):
            raise case.mistake("prove does not move the times of faults; remove the key", "host", key)
    inputs = case.inputs
    if inputs is not None and (inputs.rounds is not None or inputs.frames is not None or inputs.sends_later):
        raise case.mistake("prove chooses the starts itself; remove rounds, frames and sends_later", "inputs")
    if case.host is None and case.controller is None:
        if case.serial is None or not any(one.at is not None for one in case.serial.send):
            what = "no start is free: there is no [host], no [controller], and no [[serial.send]] with `at`"
            raise case.mistake(what, "name")
        return "sends"
    if case.serial is not None:
        raise case.mistake("prove moves either [serial], or [host] and [controller]; remove one of them", "serial")
    if case.host is None:
        return "rounds"
    if case.controller is not None and case.controller.rounds is not None:
        raise case.mistake("prove needs rounds without end; remove the key", "controller", "rounds")
    if case.controller is not None and case.host.period < (1 - NEARLY) * case.controller.period:
        what = "prove moves one frame in a round; give [host] a period that is not shorter than that of [controller]"
        raise case.mistake(what, "host", "period")
    return "frames"


def _grid(plan: ScenePlan) -> Grid:
    """Return the times at which periods begin, from which phases are counted."""
    start = plan.ticks.start
    if plan.case.controller is None and plan.case.host is None:
        return Grid(start, SERIAL_SPAN * plan.ticks.timebase.per_second)
    schedule = plan.host[0] if plan.case.controller is None else plan.head.schedule
    return Grid(start + schedule.first, Fraction(schedule.period))


def _jitter(plan: ScenePlan, moved: Moved) -> int:
    """Return the largest delay of a moved start by jitter, in ticks."""
    if moved == "frames":
        return plan.host[0].jitter
    return plan.head.schedule.jitter if moved == "rounds" else 0
