"""`python -m tests.firmware_mutants.real`: measure the share of real mutants that the shipped budgets detect.

    Random(seed) --> mutants of both firmwares --reality--> real ones --shipped--> detected by a budget
                                                                '--phases of baselines--> detected by a figure
                                                                '--neither--> listed with the number of phases

A seed is drawn for each of two samples unless seeds are given. The result replaces the section of the page.
The exit status is 1 if budgets detect less than 80 % of the real mutants of any sample.
"""

from __future__ import annotations

import argparse
import gc
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from random import Random, SystemRandom
from typing import Any

from periph_sim.interfaces.reports.baselines.compare import compare
from periph_sim.interfaces.reports.baselines.event_chain import EventDigests
from periph_sim.interfaces.reports.baselines.files import Baseline
from periph_sim.interfaces.reports.baselines.outcome import baseline_of
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene

from .changes import Mutant
from .reality import BENCHES, ENDS, PHASES, SLOW, Difference, Phase, difference, differences, phases
from .shipped import detected
from .trials import ROOT, STALLED, all_mutants, mutated, unchanged

PAGE = ROOT / "tests" / "firmware_mutants" / "results.md"
SECTION, NEXT = "## Real mutants and the budgets\n", "\n## "
ENOUGH = 80  # percent of the real mutants
SAMPLE = 60
BASELINES = 24  # phases whose figures and bytes are compared
BUDGET, FIGURE, NEITHER = "budget", "figure", "neither"


@dataclass(frozen=True)
class Judged:
    """A real mutant and how it is detected.

    by: the case and its budget, or the figure that differs.
    rare: number of phases in which it differs, counted if nothing detects it.
    """

    mutant: Mutant
    difference: Difference
    by: str = ""
    how: str = NEITHER
    rare: int = 0


def judged(mutant: Mutant, seed: int) -> Judged | None:
    """Return how a mutant is detected, or None if it behaves as the unchanged firmware or ends the run."""
    found = difference(mutant, seed)
    if found is None or found.kind == ENDS:
        return None
    if found.kind == SLOW:
        return Judged(mutant, found)
    by = detected(mutant)
    if by:
        return Judged(mutant, found, by, BUDGET)
    moved = figure_moved(mutant, seed)
    if moved:
        return Judged(mutant, found, moved, FIGURE)
    return Judged(mutant, found, rare=sum(1 for _ in differences(mutant, seed)))


def figure_moved(mutant: Mutant, seed: int) -> str:
    """Return the first figure that differs in phases other than those of the decision, or "" if none does."""
    for phase in phases(mutant.file, seed + 1, BASELINES):
        firmware = phase.run.firmware
        changes = compare(_usual(phase), _figures(phase, mutated(firmware, mutant)))
        for change in changes:
            if not change.note:
                return f"{phase.run.case}: {change.budget or change.figure}"
    return ""


@cache
def _usual(phase: Phase) -> Baseline:
    return _figures(phase, unchanged(phase.run.firmware))


def _figures(phase: Phase, module: Any) -> Baseline:
    run = phase.run
    case = load(ROOT / "timing" / f"{run.case}.toml", [*run.changes, *phase.changes, STALLED])
    digests = EventDigests(case.start)
    scene = Scene(case, digests.subscribe, programs={"dsp": Firmware("mutant", module.main, module.Settings)})
    result = scene.run(scene.timebase.seconds(scene.timebase.ticks(run.seconds + " s", "nearest")))
    return baseline_of(scene, result).model_copy(update={"bus_bytes": digests.bus_bytes})


class Sample:
    """A sample of mutants drawn with a seed, and the real ones among them."""

    def __init__(self, seed: int, size: int, on_judged: Callable[[Judged], None] = lambda one: None) -> None:
        self.seed = seed
        mutants = [mutant for file in BENCHES for mutant in all_mutants(file)]
        self.drawn = Random(seed).sample(mutants, min(size, len(mutants)))
        self.real: list[Judged] = []
        for mutant in self.drawn:
            found = judged(mutant, seed)
            if found is not None:
                self.real.append(found)
                on_judged(found)

    def count(self, how: str) -> int:
        return sum(1 for one in self.real if one.how == how)

    @property
    def share(self) -> float:
        """Percentage of the real mutants that budgets detect."""
        return 100 * self.count(BUDGET) / len(self.real) if self.real else 0.0

    def __str__(self) -> str:
        counts = ", ".join(f"{self.count(how)} {how}" for how in (BUDGET, FIGURE, NEITHER))
        return f"seed {self.seed}: {len(self.drawn)} drawn, {len(self.real)} real: {counts}; budgets {self.share:.1f} %"


HEAD = f"""
`python -m tests.firmware_mutants.real` draws {SAMPLE} mutants of the firmwares with a seed of the moment, and decides
for each by running it whether it is real: whether, in any of {PHASES} phases, it changes a byte on the bus or the order
of events on SDA, SCL and MODEL, or misses a deadline of the bench that the unchanged firmware meets. The deadlines are
those of `tests/firmware_mutants/reality.py`, apart from the budgets. Then it runs the shipped cases in full with the
mutant: *by budgets* counts the mutants with which one of them fails. The rest is compared with the exact figures and
bytes of {BASELINES} other phases, as `periph-sim check` does. A mutant that ends a run with an error is not counted.

| seed | drawn | real | by budgets | by figures only | by neither |
|---:|---:|---:|---:|---:|---:|
"""


def section(samples: Sequence[Sample]) -> str:
    rows = [
        f"| {one.seed} | {len(one.drawn)} | {len(one.real)} | {one.count(BUDGET)} ({one.share:.0f} %) "
        f"| {one.count(FIGURE)} | {one.count(NEITHER)} |\n"
        for one in samples
    ]
    left = {found.mutant: found for one in samples for found in one.real if found.how != BUDGET}
    lines = [f"* `{found.mutant}`: {_reason(found)}\n" for found in left.values()]
    return SECTION + HEAD + "".join(rows) + ("\nNo budget detects:\n\n" + "".join(lines) if lines else "")


def _reason(found: Judged) -> str:
    what = f"{found.difference.kind} ({found.difference.what})" if found.difference.what else found.difference.kind
    if found.how == FIGURE:
        return f"{found.by} is another figure; {what}."
    if found.difference.kind == SLOW:
        return f"its waits execute each pass, so it is too slow to decide: {found.difference.what}; counted as real."
    return f"it differs in {found.rare} of {PHASES} phases only, and in none of the {BASELINES}; {what}."


def with_section(page: str, text: str) -> str:
    """Return the page with its section replaced, or inserted before the first other section."""
    start = page.find(SECTION)
    end = page.find(NEXT, max(start, 0)) + 1 or len(page)
    if start < 0:
        start = end
    return f"{page[:start]}{text}" + (f"\n{page[end:]}" if page[end:] else "")


def section_of(page: str) -> str:
    """Return the section of a page, or "" if it has none."""
    start = page.find(SECTION)
    return page[start : page.find(NEXT, start) + 1 or len(page)].rstrip("\n") + "\n" if start >= 0 else ""


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.firmware_mutants.real", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument(
        "--seed", type=int, action="append", help="seed of a sample, may be repeated; no page is written"
    )
    parser.add_argument("--sample", type=int, default=SAMPLE, help="number of mutants of both firmwares together")
    options = parser.parse_args(arguments)
    gc.freeze()
    drawn = SystemRandom()
    samples = []
    for seed in options.seed or [drawn.randrange(10**6) for _ in range(2)]:
        print(f"seed {seed}", flush=True)
        samples.append(Sample(seed, options.sample, _print_judged))
        print(samples[-1], flush=True)
    if not options.seed and options.sample == SAMPLE:
        PAGE.write_text(with_section(PAGE.read_text(encoding="utf-8"), section(samples)), encoding="utf-8")
    return 0 if all(one.share >= ENOUGH for one in samples) else 1


def _print_judged(one: Judged) -> None:
    print(f"{one.how}: {one.mutant}: {one.by if one.how == BUDGET else _reason(one)}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
