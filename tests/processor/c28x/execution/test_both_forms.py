"""The compiled and the interpreted CPU are equal after each of many random instructions of every form.

`make explore` compares a million instructions. The test is skipped where the suite runs interpreted. The interpreted
CPU runs in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim import form
from periph_sim.form import COMPILED, INTERPRETED, VARIABLE
from tests.processor.c28x.execution.random_instructions import FORMS, digests
from tests.profiles import explores

ROOT = Path(__file__).parents[4]


def other_form(count: int, seed: int) -> list[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path]), VARIABLE: INTERPRETED}
    command = [sys.executable, "-m", "tests.processor.c28x.execution.random_instructions", str(count), str(seed)]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.long
@pytest.mark.skipif(form.running != COMPILED, reason="compared by the tests of the compiled form: make core")
def test_registers_memory_and_cycles_are_equal() -> None:
    """If it fails, `random_instructions COUNT SEED FROM TO`, run in both forms, shows where they differ."""
    count, seed = (1_000_000, 2) if explores() else (20_000, 1)
    assert count > 40 * len(FORMS)
    compiled, interpreted = digests(count, seed), other_form(count, seed)
    assert (compiled[0], interpreted[0]) == (COMPILED, INTERPRETED)
    assert compiled[1:] == interpreted[1:]
