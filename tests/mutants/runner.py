"""Run pytest for trials: tests of a tree and room pass, fail or take too long.

There is one warm process per tree and room (`warm.py`), from its first mutant until the tree is no longer used.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from .sample import ROOMS
from .tree import Tree

Outcome = Literal["killed", "timeout", "survived"]

WARM = Path(__file__).with_name("warm.py")
OPTIONS = ("-q", "-x", "--tb=line", "-p", "no:cacheprovider", "-p", "no:cov", "-p", "no:slipcover")
NOTHING_COLLECTED = 5  # pytest's exit status


@dataclass(frozen=True)
class Ran:
    """Result of a run. by: the failed test, or another reason. cpu: seconds of processor time."""

    outcome: Outcome
    by: str = ""
    cpu: float = 0.0


class Runner:
    """Runs tests of one tree, one call at a time. It is a context manager, which ends its processes.

    A test that takes more than `a_test` seconds, or a call that takes more than `a_run`, counts as an endless loop.
    """

    def __init__(self, tree: Tree, a_test: int = 60, a_run: int = 1800) -> None:
        self.tree = tree
        self._a_test, self._a_run = a_test, a_run
        self._warm: dict[str, subprocess.Popen[str]] = {}

    def __enter__(self) -> Runner:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._warm.values():
            assert process.stdin is not None and process.stdout is not None
            process.stdin.close()
            process.wait()
            process.stdout.close()

    def run(self, room: str, tests: list[str], without: list[str], patience: float = 3600) -> Ran:
        """Run tests except `without` up to the first failure. A mutant without one in `patience` CPU seconds survives.

        Raise SystemExit if the warm process fails.
        """
        arguments = [*OPTIONS, "-o", f"timeout={self._a_test}", *tests, *(f"--deselect={test}" for test in without)]
        process = self._of(room)
        assert process.stdin is not None and process.stdout is not None
        try:
            request = {"arguments": arguments, "seconds": self._a_run, "cpu": max(1, round(patience))}
            print(json.dumps(request), file=process.stdin, flush=True)
            answer = json.loads(process.stdout.readline())
        except (OSError, ValueError):
            raise SystemExit(f"the warm process of room {room!r} broke down; its output is above") from None
        return Ran(*_read(answer["status"], answer["output"], self._a_run), answer["cpu"])

    def _of(self, room: str) -> subprocess.Popen[str]:
        if room not in self._warm:
            packages = [source.replace("/", ".") for source in ROOMS[room].sources]
            self._warm[room] = subprocess.Popen(
                [sys.executable, "-P", str(WARM), *packages],
                cwd=self.tree.folder,
                env=self.tree.environment(),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        return self._warm[room]


def _read(status: int | None, output: str, seconds: int) -> tuple[Outcome, str]:
    if status is None:
        return "timeout", f"{seconds} s of tests"
    if status in (0, NOTHING_COLLECTED, -signal.SIGXCPU):
        return "survived", ""
    by = next((line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))), "")
    by = by.partition(" - ")[0].partition(" ")[2] or f"pytest ended with status {status}"
    return "timeout" if "Failed: Timeout" in output or "Timeout (>" in output else "killed", by
