"""The functions in the guided tour of CONTRIBUTING.md call each other in the order of its tables."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from typing import cast

import pytest

from tests.docs.pages import ROOT

Calls = list[list[str]]

TOUR = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("\n## A guided tour\n")[2].partition("\n## ")[0]
WALKS = {
    title: [[file, name] for file, name in re.findall(r"^\| `([\w/]+\.py)` \| `([\w.]+)`", body, re.MULTILINE)]
    for title, _, body in (part.partition("\n") for part in TOUR.split("\n### ")[1:])
}
BYTE, ACCESS, VERDICT = WALKS


@pytest.fixture(scope="module")
def calls() -> tuple[Calls, Calls]:
    """Return the calls of a run, and those of a command that judges a case."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.docs.tour"],
        cwd=ROOT,
        env={**os.environ, "PERIPH_SIM_FORM": "interpreted"},
        capture_output=True,
        text=True,
        check=True,
    )
    return cast("tuple[Calls, Calls]", json.loads(done.stdout))


@pytest.mark.parametrize(("walk", "most"), [(BYTE, 250), (ACCESS, 100)])
def test_the_last_function_is_reached_from_the_first(calls: tuple[Calls, Calls], walk: str, most: int) -> None:
    """Search backwards from the first call of the last function for the nearest call of each function before it."""
    run, names = calls[0], WALKS[walk]
    at = end = run.index(names[-1])
    for name in reversed(names[:-1]):
        at = max(place for place in range(at) if run[place] == name)
    assert len(names) >= 6 and end - at < most


def test_a_verdict_passes_through_the_functions_in_their_order(calls: tuple[Calls, Calls]) -> None:
    names = WALKS[VERDICT]
    firsts = [calls[1].index(name) for name in names]
    assert firsts == sorted(firsts) and len(names) >= 8
