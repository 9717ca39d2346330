"""A small case whose firmware reads and writes registers of an SCI that has no clock.

span work: a read and a write in peripheral frame 2, 14 cycles by default
budget late: a second write, only if the first one had an effect, which clock_gate_access decides
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from periph_sim.interfaces.reports.questions.dependence import Dependence, dependences
from periph_sim.interfaces.reports.questions.explore import Exploration, explore

FIRMWARE = """\
def main(dsp, settings):
    sci = dsp.module("SCI-A")
    with dsp.span("work"):
        sci.SCICCR.all
        sci.SCIHBAUD.all = 7
    dsp.compute(100)
    if sci.SCIHBAUD.all:
        sci.SCILBAUD.all = 7
"""
CASE = """\
name = "small"
duration = "20 us"
[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
[[budget]]
name = "work"
measure = "span:work"
max = "1 us"
"""
LATE = """\
[[budget]]
name = "late"
measure = "count of access W SCI-A.SCILBAUD"
exactly = 0
"""
LENGTH = Fraction(20, 1_000_000)


def written(folder: Path, case: str = CASE, firmware: str = FIRMWARE) -> Path:
    """Write the case and its firmware, and return the path of the case."""
    (folder / "mine.py").write_text(firmware, encoding="utf-8")
    file = folder / "small.toml"
    file.write_text(case, encoding="utf-8")
    return file


def explored(file: Path, *changes: str) -> Exploration:
    return explore(file, changes, LENGTH, jobs=1)


def answers(explored: Exploration) -> list[dict[str, object]]:
    """Return the answers of each run, without the unit's name."""
    return [{a.question.name.removeprefix("dsp."): a.value for a in one.answers} for one in explored.attempts]


def by_name(explored: Exploration) -> dict[str, Dependence]:
    return {one.name: one for one in dependences(explored)}


def departures(explored: Exploration, budget: str) -> list[tuple[dict[str, object], str]]:
    """Return answers and verdict of the runs in which the verdict of the budget differs."""
    tried = answers(explored)
    return [(tried[one.number], one.word) for one in by_name(explored)[budget].departures]
