"""`python -m tests.firmware_mutants`: change each statement of both emulators, and report which budget catches it.

    every mutant --> Trial --> tests/firmware_mutants/results.md, survivors on the screen

The exit status is 1 if less than 95 % of the mutants that are not argued to have no effect are caught, if an argued
one is caught, or if one survives that is not listed in survivors.py.
"""

from __future__ import annotations

import argparse
import gc
import sys
from random import Random

from .page import page
from .real import PAGE, section_of, with_section
from .tally import Tally
from .trials import FUNCTIONS, all_mutants, tried


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.firmware_mutants", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("file", nargs="*", default=list(FUNCTIONS), help=f"one of {', '.join(FUNCTIONS)}; default: all")
    parser.add_argument("--only", default="", help="mutants whose text contains this; no page is written")
    parser.add_argument("--sample", type=int, default=0, help="random mutants of each file to run; no page is written")
    options = parser.parse_args(arguments)
    gc.freeze()  # a scene has many reference cycles; imported objects need not be searched for them
    trials, holds = {}, True
    for file in options.file:
        chosen = [one for one in all_mutants(file) if options.only in str(one)]
        if options.sample:
            chosen = Random(1).sample(chosen, min(options.sample, len(chosen)))
        trials[file] = [tried(mutant) for mutant in chosen]
        tally = Tally(trials[file])
        print(f"{file}: {tally}")
        for trial in tally.survivors:
            print(f"{'survived, not listed in survivors.py' if trial in tally.unknown else 'survived'}: {trial.mutant}")
        for trial in tally.refuted:
            print(f"argued to have no effect, but caught by {trial.by}: {trial.mutant}")
        holds = tally.holds and holds
    if set(trials) == set(FUNCTIONS) and not options.only and not options.sample:
        kept = section_of(PAGE.read_text(encoding="utf-8"))
        PAGE.write_text(with_section(page(trials), kept) if kept else page(trials), encoding="utf-8")
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
