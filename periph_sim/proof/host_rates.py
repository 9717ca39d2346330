"""Proof that a closed table with rounds and frames holds for all bit rates of the host within a range.

    rates from -100 to 100 ppm --rate_runs--> each sequence of samples that an SCI can take of a frame
    a frame with such a sequence, run alone --> like a frame of the table, some samples earlier or later

An SCI receives of a frame only the levels that it samples, a *sequence of samples*. At another rate, an edge of the
frame moves by up to a few ticks, so few edges move from one side of a sample to the other. Therefore, a range of rates
has far fewer sequences of samples than rates and starts. Each sequence is run at one rate, with the earliest and the
latest start between two samples that gives it there.

Each of these runs must be like a frame of the table: the service routine comes at the same instant, with the same data.
The rest of the scene notices nothing else of a frame (`GroupRunner.check_frame`). So a round with such a frame is like
a group of the table, too. Random groups are run to check this. The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import deepcopy
from fractions import Fraction
from itertools import islice, pairwise
from math import ceil, floor
from pathlib import Path
from random import Random

from msgspec import Struct

from ..bus.uart.frame_format import UartFormat
from .calls import CallAll
from .cover import case_of
from .free_run import NotClosed
from .pair_budgets import within_round
from .pair_groups import Group, GroupRun
from .pair_run import Known, PairRun, Task
from .pair_table import OTHER_REST, KnownGroup, PairMaker
from .stretch import CoveredCase, Job

MOST_RATES = 2000  # maximum number of scenes, each with another rate
SOME = 8  # number of groups from which one is chosen for a run
# Lengths of a bit in ticks, each with offsets of frames: for each sequence of samples, the least and the greatest one.
RatePlan = list[tuple[Fraction, tuple[tuple[int, int], ...]]]


class RateTask(Struct, frozen=True):
    """The frames and groups to run at one rate of the host.

    error: the value of `host.error`, in percent.
    starts: for each sequence of levels that an SCI can sample of a frame, the least and the greatest offset of the
        frame with which the SCI samples it.
    frames: for each orbit, some frames alone of the table. Three of them are run for each sequence in `starts`.
    groups: for each orbit, some groups of the table that have a round and a frame.
    count: the number of these groups that are run, each with an offset for one of the sequences.
    """

    error: Fraction
    starts: tuple[tuple[int, int], ...]
    frames: dict[int, list[KnownGroup]]
    groups: dict[int, list[KnownGroup]]
    count: int


def rate_runs(
    places: Sequence[Fraction], bits: tuple[Fraction, Fraction], sample: int, first: int
) -> Iterator[tuple[Fraction, tuple[tuple[int, int], ...]]]:
    """Yield lengths of a bit, each with starts of frames, so that each possible sequence of samples comes once.

    A start is counted in ticks from the sample before it. It is given as a pair for each sequence: the least and the
    greatest start that gives this sequence.

    places: the places of the edges of a frame after its start, in bits, in ascending order.
    bits: the least and the greatest length of a bit, in ticks.
    sample: the number of ticks from one sample to the next.
    first: the start of the first frame of the case, which cannot be moved. For each of its sequences, a length of a bit
        is yielded, if necessary without starts.
    """
    least, most = bits
    changes = {
        Fraction(tick, 1) / place
        for place in places
        if place
        for tick in range(floor(place * least) + 1, floor(place * most) + 1)
    }
    seen: set[tuple[int, ...]] = set()
    seen_first: set[tuple[int, ...]] = set()
    known: set[tuple[tuple[int, ...], tuple[int, ...]]] = set()
    for bit in sorted({least, *changes}):
        edges = [floor(place * bit) for place in places]
        # for each edge, the least start with which one more sample is taken before the edge than with start 0
        limits = [-edge % sample for edge in edges]
        order = {limit: number for number, limit in enumerate(sorted({0, first, *limits}))}
        kind = tuple(-(-edge // sample) for edge in edges), tuple(order[one] for one in (first, *limits))
        if kind in known:
            continue
        known.add(kind)
        samples = tuple((first + edge) // sample for edge in edges)
        is_new = samples not in seen_first
        seen_first.add(samples)
        starts = []
        for begin, end in pairwise([*sorted({0, *limits}), sample]):
            samples = tuple((begin + edge) // sample for edge in edges)
            if samples not in seen:
                seen.add(samples)
                starts.append((begin, end - 1))
        if starts or is_new:
            yield bit, tuple(starts)


def plan_rates(maker: PairMaker, ignored: Sequence[str], within: Fraction) -> RatePlan:
    """Return the rates of the host to run, each as the length of a bit with the offsets of frames (see `rate_runs`).

    maker: the maker of the table, after `explore`.
    ignored: the ignored attributes.
    within: the greatest difference from the rate of the case, in ppm.

    Raise NotClosed if there are too many rates, if the SCI does not request its interrupt during the last character of
    a frame, or if the start-up code may notice more of the first frame than the service routine.
    """
    covered, known = maker.covered, maker.known
    host, cells = covered.case.host, known.cells
    assert host is not None and cells is not None
    pair = PairRun(covered, ignored, known)
    if pair.runner.first_noticed:
        raise NotClosed(f"start-up code may notice the rate of the first frame: {pair.runner.first_noticed}")
    orbit = pair.runner.at[0]
    frame = (cells.first - known.orbits.known[orbit].origin) % cells.period
    delay, scene = pair.run(Task(orbit, Group(None, frame), 0, None)).delay, pair.runner.run.scene
    assert scene.host is not None
    data, line, bit = scene.host.last_data, UartFormat(), _exact_bit(covered) / (1 + host.error / 100)
    last = (len(data) - 1) * (line.length + host.gap)
    if not 0 <= delay - (last + line.length - 1) * bit <= 2 * bit:
        raise NotClosed("the interrupt of the SCI is not requested with the last character of a frame")
    # The last character of a frame starts at a sample if the frame starts at the beginning of a cell of frames.
    shift = floor(last * bit) % cells.period
    first = (scene.start + covered.phases.first_starts()["frames"] - cells.first - shift) % cells.period
    bits = bit / (1 + within / 10**6), bit / (1 - within / 10**6)
    found = list(islice(rate_runs(edge_places(data, host.gap), bits, cells.period, first), MOST_RATES + 1))
    if len(found) > MOST_RATES:
        raise NotClosed(f"the frames have more than {MOST_RATES} different sequences of samples in this range of rates")
    return [(bit, tuple((one + shift, two + shift) for one, two in starts)) for bit, starts in found]


def prove_rates(
    plan: RatePlan, maker: PairMaker, job: Job, ignored: Sequence[str], least_again: int, call_all: CallAll
) -> None:
    """Run frames at all rates of a plan. Raise NotClosed if one of them is like no frame of the table.

    maker: the maker of the closed table. `apart` of this table is increased to the distance that these rates need.
    job: the case. ignored: the ignored attributes.
    least_again: the least number of groups with a round and a frame that are run at these rates.
    call_all: makes the calls that run frames, possibly in other processes.
    """
    each = ceil(least_again / sum(bool(starts) for _, starts in plan))
    orbits = range(len(maker.known.orbits.known))
    frames, groups = ({at: maker.random_groups(at, is_alone) for at in orbits} for is_alone in (True, False))
    tasks = [
        RateTask(
            (_exact_bit(maker.covered) / bit - 1) * 100,
            starts,
            {orbit: list(islice(found, SOME)) for orbit, found in frames.items()},
            {orbit: list(islice(found, SOME)) for orbit, found in groups.items()},
            each if starts else 0,
        )
        for bit, starts in plan
    ]
    calls = [(job, ignored, maker.known, task, number) for number, task in enumerate(tasks)]
    longest = max(call_all(run_rate, calls))
    maker.table.again += sum(task.count for task in tasks)
    maker.table.apart = max(maker.table.apart, longest + 1 + maker.long)


def edge_places(data: bytes, gap: Fraction) -> list[Fraction]:
    """Return the places of the edges in a frame, in bits from its start. gap: the idle bits between its characters."""
    line, found = UartFormat(), []
    for number, byte in enumerate(data):
        begin, levels = number * (line.length + gap), [1, *line.levels(byte)]
        found += [begin + place for place, (before, then) in enumerate(pairwise(levels)) if before != then]
    return found


def _exact_bit(covered: CoveredCase) -> Fraction:
    """Return the length of a bit of the host in ticks, if its rate has no error."""
    assert covered.case.host is not None
    return Fraction(covered.phases.ticks_per_second) / covered.case.host.baud


def run_rate(job: Job, ignored: Sequence[str], known: Known, task: RateTask, seed: int) -> int:
    """Run the frames and groups of a task, and return the greatest length of a group, in ticks.

    Raise NotClosed if one of them is not like those of the table. Worker processes call this.

    ignored: the ignored attributes.
    known: what the runs of the table have found.
    seed: determines which groups are run, and with which offsets.
    """
    try:
        return _run_rate(job, ignored, known, task, seed)
    except NotClosed as error:
        raise NotClosed(f"at a host.error of {float(task.error):.6g} %, {error}") from None


def _run_rate(job: Job, ignored: Sequence[str], known: Known, task: RateTask, seed: int) -> int:
    """Do the same as `run_rate`, with messages that do not name the rate."""
    covered = within_round(case_of(job, Path.cwd())).with_host("error", task.error)
    orbits, random = len(known.orbits.known), Random(seed)
    known = deepcopy(known)  # a call must not change the arguments of other calls in this process
    assert known.cells is not None
    sample, pair, lengths = known.cells.period, PairRun(covered, ignored, known), [0]

    def run(groups: dict[int, list[KnownGroup]], offset: int) -> tuple[GroupRun, GroupRun]:
        """Run one of the groups of the present orbit with this offset. Return its run in the table, and the new run."""
        orbit = pair.runner.at[0]
        if orbit >= orbits:
            raise NotClosed(OTHER_REST)
        one = random.choice(groups[orbit])
        found = pair.run(Task(orbit, one.group, offset, None))
        lengths.append(found.length)
        return one.run, found

    def is_like(groups: dict[int, list[KnownGroup]], offset: int) -> bool:
        """Run one of the groups of the present orbit. Return True if it is like its run in the table."""
        known, found = run(groups, offset)
        return known.is_like(found)

    found: list[range] = []
    for least, most in task.starts:
        before, after = run(task.frames, least)
        later = after.delay - before.delay
        offsets = range(least - later, most - later + 1)
        if later % sample or not is_like(task.frames, offsets[0]) or not is_like(task.frames, offsets[-1]):
            raise NotClosed("a frame has other effects than each frame of the table")
        found.append(offsets)
    for _ in range(task.count):
        if not is_like(task.groups, random.choice(random.choice(found))):
            raise NotClosed("a frame and a round have other effects than those of the table")
    pair.end()
    failures = set[str]().union(*(outcome.failures for outcome in pair.done.outcomes))
    if failures:
        raise NotClosed(f"a run breaks {', '.join(sorted(failures))}")
    if len(known.orbits.known) > orbits:
        raise NotClosed(OTHER_REST)
    return max(lengths)
