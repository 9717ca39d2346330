"""`python -m tests.proof.dimensions CASE`: the dimensions of a case, measured by rounds with random inputs.

    random starts of rounds and frames --[inputs]--> one long run --> per round: phase, requests, writes --> counts

docs/proof.md explains the terms and quotes the figures. Cycles are those of the unit's own clock. The random starts are
on the grid of ticks. A schedule is the list of the writes that the main program makes in a round, without the written
data: their registers, and their cycles since the start of the round. A request is *near* if it comes within AFTER
cycles after a write of the main program, or within BEFORE cycles before the next one.
"""

from __future__ import annotations

import argparse
import sys
import time
from bisect import bisect
from collections import Counter, defaultdict
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import NamedTuple

from periph_sim.core.records import Kind, Record
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

AFTER, BEFORE = 60, 400
PASS = 10  # cycles of a pass of the emulators' waits
REGISTERS = ("I2C-A.I2CDXR", "I2C-A.I2CMDR", "I2C-A.I2CCNT", "I2C-A.I2COAR", "GPIO.GPBSET", "GPIO.GPBCLEAR")
ACTIVE = 415_000  # cycles from the start of a round to the last write of its models, about
REST = 60_000  # cycles after which the next round may start
BETWEEN = 161_000  # least number of cycles between two requests: a frame is 156 250 cycles long
FIRST = Fraction(40, 1000)  # start of the first round, in seconds: start-up is over
PERIOD = Fraction(20, 1000)


class Ran(NamedTuple):
    """A round. phase, end_phase: the cycle within a pass of the wait, at the start of the round and after its end."""

    phase: int
    requests: tuple[int, ...]
    schedule: tuple[tuple[int, str], ...]
    end_phase: int


def ran(path: Path, rounds: int, requests: int, seed: int, changes: Sequence[str]) -> list[Ran]:
    """Return `rounds` rounds of a case, with `requests` interrupt requests each at random instants."""
    random, case = Random(seed), load(path, list(changes))
    per_second = Scene(case).timebase.per_second
    cycle = per_second // 150_000_000
    starts, frames = [], []
    for number in range(rounds):
        start = int((FIRST + number * PERIOD) * per_second) + random.randrange(1640 * cycle)
        starts.append(start)
        frames += [start + cycle * (at - 156_040) for at in _instants(random, requests)]
    lists = {"rounds": starts, "frames": frames}
    inputs = InputsTable(**{name: tuple(Fraction(tick, per_second) for tick in ticks) for name, ticks in lists.items()})
    records: list[Record] = []
    subjects = {Kind.ACCESS: [f"dsp.{register}" for register in REGISTERS]}
    scene = Scene(
        case.model_copy(update={"budget": (), "inputs": inputs}),
        lambda recorder, _: recorder.subscribe([Kind.ACCESS, Kind.IRQ], records.append, subjects),
    )
    dsp, found = scene.units["dsp"], []
    for start in starts:
        scene.advance(start - cycle)
        origin = dsp.clock.cycle_at(start)
        phase = _phase(dsp, origin)
        records.clear()
        scene.advance(start + cycle * (ACTIVE + REST))
        writes = [one for one in records if one.kind is Kind.ACCESS and one.what.startswith("W ")]
        entries = [dsp.clock.cycle_at(one.tick) - origin for one in records if one.kind is Kind.IRQ and one.text]
        schedule = tuple((dsp.clock.cycle_at(one.tick) - origin, one.what) for one in writes)
        found.append(Ran(phase, tuple(entries), schedule, _phase(dsp, origin)))
    return found


def _instants(random: Random, count: int) -> list[int]:
    while True:
        found = sorted(random.randrange(500, ACTIVE) for _ in range(count))
        if all(after - before >= BETWEEN for before, after in pairwise(found)):
            return found


def _phase(dsp: Dsp, cycle: int) -> int:
    spin = dsp.program.spin
    assert spin is not None, "the program does not wait between two rounds"
    return (cycle - spin.start) % PASS


class Far(NamedTuple):
    """Rounds whose requests are all far from writes.

    share: percent of the requests that are near.
    kinds: number of combinations of a phase and the segments in which the requests come.
    schedules: number of combinations by their number of schedules.
    revisits: number of rounds with a combination, and a cycle of the request modulo PASS, of an earlier round.
    contradictions: number of such combinations with more than one schedule.
    """

    share: float
    kinds: int
    schedules: dict[int, int]
    revisits: int
    contradictions: int


def far(rounds: Sequence[Ran]) -> Far:
    near = total = revisits = 0
    exact, coarse = defaultdict(set), defaultdict(set)
    for one in rounds:
        cycles = [cycle for cycle, _ in one.schedule]
        places = []
        for entry in one.requests:
            place = bisect(cycles, entry)
            is_near = place > 0 and entry - cycles[place - 1] < AFTER
            is_near |= place < len(cycles) and cycles[place] - entry < BEFORE
            total += 1
            near += is_near
            places.append(None if is_near else (place, (entry - one.phase) % PASS))
        if None in places:
            continue
        key, outcome = (one.phase, *places), (one.schedule, one.end_phase)
        revisits += key in exact
        exact[key].add(outcome)
        coarse[one.phase, *(place[0] for place in places if place)].add(outcome)
    several = sum(len(outcomes) > 1 for outcomes in exact.values())
    return Far(100 * near / max(total, 1), len(coarse), dict(Counter(map(len, coarse.values()))), revisits, several)


def gaps(rounds: Sequence[Ran]) -> int:
    """Return the number of different pairs of a write of a round and the cycles to the next one."""
    found = {
        (place, after[0] - before[0]) for one in rounds for place, (before, after) in enumerate(pairwise(one.schedule))
    }
    return len(found)


def main(arguments: Sequence[str]) -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.proof.dimensions", description=__doc__.splitlines()[0])
    parser.add_argument("case", type=Path)
    parser.add_argument("--rounds", type=int, default=2000)
    parser.add_argument("--requests", type=int, default=1, help="requests of the SCI in each round")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    chosen = parser.parse_args(arguments)
    began = time.process_time()
    rounds = ran(chosen.case, chosen.rounds, chosen.requests, chosen.seed, chosen.set)
    spent = time.process_time() - began
    print(f"{len(rounds)} rounds with {chosen.requests} requests each; {1000 * spent / len(rounds):.2f} ms CPU each")
    before, after = {one.phase for one in rounds}, {one.end_phase for one in rounds}
    print(f"phases of the wait: {len(before)} before a round, {len(after)} after it")
    print(f"schedules: {len({one.schedule for one in rounds})}; gaps between two writes: {gaps(rounds)}")
    if chosen.requests:
        print(*(f"{name}: {value}" for name, value in far(rounds)._asdict().items()), sep="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
