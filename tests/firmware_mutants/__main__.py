"""`python -m tests.firmware_mutants`: every statement of both emulators changed, and which budget catches it.

    every mutant --processes--> Trial --> build/firmware_mutants.md, survivors on the screen

Exit status 1 if less than 95 % of those that are not argued to have no effect are caught.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from random import Random

from .argued import why_without_effect
from .trials import ROOT, RUNS, SERVICE, Trial, all_mutants, tried, usual_figures

TABLE = ROOT / "build" / "firmware_mutants.md"
ENOUGH = 95


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.firmware_mutants", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("firmware", nargs="*", default=list(SERVICE), help="one of both; both if none is given")
    parser.add_argument("--workers", type=int, default=2, help="processes at a time")
    parser.add_argument("--only", default="", help="mutants whose text contains this")
    parser.add_argument("--sample", type=int, default=0, help="so many of them, drawn")
    options = parser.parse_args(arguments)
    enough, text = True, "# Mutants of the emulators\n"
    for firmware in options.firmware:
        for run in RUNS[firmware]:
            usual_figures(firmware, run)
        chosen = [one for one in all_mutants(firmware) if options.only in str(one)]
        if options.sample:
            chosen = Random(1).sample(chosen, min(options.sample, len(chosen)))
        with ProcessPoolExecutor(options.workers) as pool:
            trials = list(pool.map(partial(tried, firmware), chosen, chunksize=4))
        enough = reported(firmware, trials) and enough
        text += table(firmware, trials)
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(text, encoding="utf-8")
    return 0 if enough else 1


def reported(firmware: str, trials: list[Trial]) -> bool:
    """Print what was caught and each survivor; True if it was enough."""
    caught = [trial for trial in trials if trial.how]
    rest = [trial for trial in trials if not trial.how]
    argued = [trial for trial in rest if why_without_effect(trial.mutant)]
    counted = len(trials) - len(argued)
    share = 100 * len(caught) / counted if counted else 100.0
    how = Counter(trial.how for trial in trials)
    print(
        f"{firmware}: {len(trials)} mutants; {how['broken']} break a budget, {how['error']} end the run, "
        f"{how['moved']} move a budget's figures; {len(argued)} argued without effect; "
        f"{share:.1f} % of the others caught"
    )
    for trial in rest:
        if trial not in argued:
            print(f"survived: {trial.mutant}")
    return share >= ENOUGH


def table(firmware: str, trials: list[Trial]) -> str:
    """Markdown: of each mutant the budget that catches it, or why none can."""
    rows = [f"\n## {firmware}\n", "| mutant | caught by | in | how |", "|---|---|---|---|"]
    for trial in trials:
        by = trial.by or why_without_effect(trial.mutant) or "survived"
        how = trial.how or ("argued" if why_without_effect(trial.mutant) else "-")
        cells = (f"`{trial.mutant}`".replace("|", "\\|"), by.replace("|", "\\|")[:100], trial.case, how)
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
