"""`python -m tests.mutants`: run the tests on a sample of one-line mutants of the committed tree, and list survivors.

    --seed 1 --count 60 --room measures     60 random lines, one change of each
    --file periph_sim/timing/rounds.py      every change of every line
    --unmapped                              for a room whose tests take seconds: all run, without a map of lines

Neither mutmut nor cosmic-ray can be used here. mutmut calls every function through a trampoline, but this package
counts frames to find the place of firmware and switches greenlets in the middle of them; cosmic-ray runs one command
for each mutant, in the tree in which it is started. Neither draws a seeded sample. The remaining work is small: `ast`
finds the changes, coverage's contexts name the tests that reach a line, and pytest runs in a fork.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from random import SystemRandom

from .equivalents import why_equivalent
from .reach import Reach, measured
from .runner import Runner
from .sample import ROOMS, USUAL, Mutant, drawn, every
from .tree import Tree, commit_of, unpack
from .trial import Trial, tried

ROOT = Path(__file__).parents[2]
OUT = ROOT / "build" / "mutants"
ENDS = ("killed", "timeout", "equivalent", "survived")


def main(arguments: list[str]) -> int:
    options = _options(arguments)
    commit = commit_of(ROOT, options.commit)
    rooms = tuple(options.room or USUAL)
    print(f"commit {commit[:10]}, rooms {', '.join(rooms)}", flush=True)
    enough = True
    with tempfile.TemporaryDirectory(prefix="mutants-") as scratch:
        trees = [Tree(Path(scratch) / f"tree{number}") for number in range(options.workers)]
        for tree in trees:
            unpack(ROOT, commit, tree.folder)
        reach = Reach({}) if options.unmapped else _reach(trees[0], commit, rooms, options.workers)
        with ExitStack() as running:
            runners = [running.enter_context(Runner(tree)) for tree in trees]
            for name, chosen in _chosen(options, rooms, trees[0].folder):
                print(f"{name}: {len(chosen)} mutants", flush=True)
                kept = _killed_before(name, commit) if options.again else {}
                left = [mutant for mutant in chosen if str(mutant) not in kept]
                trials = [*(kept[str(mutant)](mutant) for mutant in chosen if str(mutant) in kept)]
                trials += _all_tried(left, runners, reach, options.patience)
                enough = _reported(name, commit, trials, options.least) and enough
    return 0 if enough else 1


def _options(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description="Test mutants of the committed tree.")
    parser.add_argument("--count", type=int, default=300, help="mutants per seed")
    parser.add_argument("--seed", action="append", help="a number, or 'drawn' for a random one; may be repeated")
    parser.add_argument("--file", action="append", help="all mutants of a file instead of a sample; may be repeated")
    parser.add_argument("--room", action="append", choices=sorted(ROOMS), help="may be repeated")
    parser.add_argument("--commit", default="HEAD", help="the commit whose tree is mutated")
    parser.add_argument("--workers", type=int, default=2, help="number of parallel processes")
    parser.add_argument("--patience", type=float, default=120.0, help="seconds of processor time per mutant")
    parser.add_argument("--again", action="store_true", help="only the survivors in the saved report of the sample")
    parser.add_argument("--unmapped", action="store_true", help="do not measure which tests reach each line")
    parser.add_argument("--least", type=float, default=95.0, help="required percentage killed, without equivalents")
    return parser.parse_args(arguments)


def _chosen(options: argparse.Namespace, rooms: tuple[str, ...], root: Path) -> Iterator[tuple[str, list[Mutant]]]:
    """Yield samples with their names in reports: all mutants of each given file, or else those of each seed."""
    for path in options.file or ():
        yield path, every(path, root)
    for seed in () if options.file else _seeds(options.seed):
        yield f"seed {seed}", drawn(rooms, options.count, seed, root)


def _seeds(given: list[str] | None) -> list[int]:
    """Return the seeds of the command line; by default 1, 2, 3 and a random one."""
    wanted = given or ["1", "2", "3", "drawn"]
    return [SystemRandom().randrange(10**6) if seed == "drawn" else int(seed) for seed in wanted]


def _reach(tree: Tree, commit: str, rooms: tuple[str, ...], workers: int) -> Reach:
    """Measure the reach once per commit and choice of rooms, and read it from its file afterwards."""
    kept = OUT / f"reach-{commit[:10]}-{'-'.join(rooms)}.json"
    if not kept.exists():
        print("running the short tests without a mutant, under coverage", flush=True)
        measured(tree, rooms, workers).write(kept)
    return Reach.read(kept)


def _all_tried(chosen: list[Mutant], runners: list[Runner], reach: Reach, patience: float) -> list[Trial]:
    free: SimpleQueue[Runner] = SimpleQueue()
    for runner in runners:
        free.put(runner)

    def one(mutant: Mutant) -> Trial:
        runner = free.get()
        try:
            trial = tried(mutant, runner, reach, patience)
        finally:
            free.put(runner)
        print(f"{trial.outcome:<9}{trial.cpu:6.1f} s  {mutant}", flush=True)
        return trial

    with ThreadPoolExecutor(len(runners)) as pool:
        return list(pool.map(one, chosen))


def _killed_before(name: str, commit: str) -> dict[str, Callable[[Mutant], Trial]]:
    """Return the trials in the saved report that need not be repeated. Raise SystemExit if the package has changed."""
    kept = _report_file(name)
    if not kept.exists():
        raise SystemExit(f"{name}: there is no saved report; run it once without --again")
    report = json.loads(kept.read_text(encoding="utf-8"))
    if subprocess.run(
        ["git", "diff", "--quiet", report["commit"], commit, "--", "periph_sim"], cwd=ROOT, check=False
    ).returncode:
        raise SystemExit(f"{name}: periph_sim has changed since {report['commit'][:10]}; run it without --again")
    return {
        row["mutant"]: partial(
            Trial, outcome=row["outcome"], by=row["by"], reached=0, cpu=row["cpu_s"], seconds=row["seconds"]
        )
        for row in report["mutants"]
        if row["outcome"] != "survived"
    }


def _report_file(name: str) -> Path:
    return OUT / f"{name.replace('/', '.').replace(' ', '-')}.json"


def _reported(name: str, commit: str, trials: list[Trial], least: float) -> bool:
    """Print and save the results of a sample. Return True if enough mutants were killed."""
    argued = [trial for trial in trials if trial.outcome == "survived" and why_equivalent(trial.mutant)]
    survived = [trial for trial in trials if trial.outcome == "survived" and not why_equivalent(trial.mutant)]
    real = len(trials) - len(argued)
    timeouts = sum(trial.outcome == "timeout" for trial in trials)
    killed = real - len(survived)
    share = 100 * killed / real if real else 100.0
    print(
        f"\n{name}: {len(trials)} mutants, {len(argued)} equivalent, {killed} of {real} others killed "
        f"({share:.1f} %), {timeouts} of them by timeout; {sum(trial.cpu for trial in trials):.0f} s of processor time"
    )
    for room in sorted({trial.mutant.room for trial in trials}):
        of_room = [trial for trial in trials if trial.mutant.room == room]
        ends = Counter("equivalent" if trial in argued else trial.outcome for trial in of_room)
        print(f"  {room}: {len(of_room)} mutants, {', '.join(f'{ends[end]} {end}' for end in ENDS)}")
    for trial in sorted(survived, key=lambda one: (one.mutant.path, one.mutant.change.line)):
        reached = f"{trial.reached} short tests run it" if trial.reached else "no short test is known to run it"
        print(f"  {reached}: {trial.mutant}")
    print(flush=True)
    OUT.mkdir(parents=True, exist_ok=True)
    rows = [
        {"mutant": str(t.mutant), "room": t.mutant.room, "kind": t.mutant.change.kind, "outcome": t.outcome, "by": t.by}
        | {"equivalent": why_equivalent(t.mutant), "cpu_s": round(t.cpu, 1), "seconds": round(t.seconds, 1)}
        for t in trials
    ]
    report = {"sample": name, "commit": commit, "killed_percent": share, "mutants": rows}
    _report_file(name).write_text(json.dumps(report, indent=1), encoding="utf-8")
    return share >= least


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
