"""One mutant tried: it, a tree and the tests that reach it go in; killed, killed by timeout or survived comes out.

tests that run the line --pass--> whole files of these tests, the long ones too --pass--> survived
         | one fails                        | one fails
         +----> killed <--------------------+            a limit of time: killed by timeout, counted apart

Files are those of its room; where no short test runs the line, all of them.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

from .reach import Reach
from .sample import ROOMS, Mutant
from .tree import Tree

Outcome = Literal["killed", "timeout", "survived"]

SECONDS_A_TEST = 60  # a short test takes less than one; a mutant that waits for ever is ended
SECONDS_A_RUN = 1800
NOTHING_COLLECTED = 5  # pytest's exit status
TESTS_FAILED, INTERRUPTED = 1, 2  # interrupted: a test file could not be imported


@dataclass(frozen=True)
class Trial:
    """by: the test that failed, or what else ended it. reached: how many test functions run the line."""

    mutant: Mutant
    outcome: Outcome
    by: str
    reached: int
    seconds: float


def tried(mutant: Mutant, tree: Tree, reach: Reach) -> Trial:
    begin = perf_counter()
    near = reach.tests_of(mutant.path, mutant.change.line)
    with tree.mutated(mutant):
        outcome, by = _ran(tree, near, reach.failing) if near else ("survived", "")
        if outcome == "survived":
            own = ROOMS[mutant.room].tests
            files = sorted({test.partition("::")[0] for test in near if test.startswith(own)}) or list(own)
            outcome, by = _ran(tree, files, reach.failing)
    return Trial(mutant, outcome, by, len(near), perf_counter() - begin)


def _ran(tree: Tree, tests: list[str], failing: list[str]) -> tuple[Outcome, str]:
    command = [sys.executable, "-m", "pytest", "-q", "-x", "--tb=line", "-p", "no:cacheprovider", "-p", "no:cov"]
    command += ["-o", f"timeout={SECONDS_A_TEST}", *tests]
    command += [f"--deselect={test}" for test in failing]
    try:
        ran = subprocess.run(
            command, cwd=tree.folder, env=tree.environment(), capture_output=True, text=True, timeout=SECONDS_A_RUN
        )
    except subprocess.TimeoutExpired:
        return "timeout", f"{SECONDS_A_RUN} s of tests"
    if ran.returncode in (0, NOTHING_COLLECTED):
        return "survived", ""
    told = f"{ran.stdout}\n{ran.stderr}"
    by = next((line for line in told.splitlines() if line.startswith(("FAILED ", "ERROR "))), "")
    by = by.partition(" - ")[0].partition(" ")[2] or f"pytest ended with status {ran.returncode}"
    return ("timeout" if "Failed: Timeout" in told or "Timeout (>" in told else "killed"), by
