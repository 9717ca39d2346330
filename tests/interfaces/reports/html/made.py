"""Reports built by hand, so that the contents of the page are known, and a small case that runs quickly."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from periph_sim.interfaces.reports.html.gather import BudgetReport, CaseReport, case_report
from periph_sim.interfaces.reports.html.over_time import OverTime, over_time
from periph_sim.interfaces.reports.html.timeline import Lane, Timeline
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.timing.budgets import Values
from periph_sim.timing.verdict import Verdict

US = 3000  # ticks
CYCLE = 20

CASE = """\
name = "small"
about = "The IMU emulator for three rounds, and a budget of a name that is not to be believed."
duration = "70 ms"
breaks = ["known bug"]

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A", "SCI-A", "GPIO"]
pins = { MODEL = 34 }
settings = { order = [0x68] }

[controller]
order = ["gyroscope"]

[host]
baud = 115200

[[budget]]
name = "response"
measure = "response"
max = "60 us"
why = "from the read address on the wire to the first data bit"
source = "specification 4.2"

[[budget]]
name = "<script>alert(1)</script>"
measure = "from edge SCL fall to edge SCL rise"
max = "4 us"
p95 = "3 us"
why = "</script><img src=x onerror=alert(2)> & more"

[[budget]]
name = "known bug"
measure = "round"
max = "1 us"

[[budget]]
name = "words"
measure = "fifo high-water"
max = 13

[[budget]]
name = "nothing"
measure = "overruns"
max = 0

[[budget]]
name = "misspelt"
measure = "from span modle begin to span model end"
max = "1 ms"
"""


def small_report(folder: Path) -> CaseReport:
    """Return the report of CASE as `periph-sim run --html` builds it, with a constant wall time."""
    path = folder / "small.toml"
    path.write_text(CASE, encoding="utf-8")
    return report_of(path)


def report_of(path: Path) -> CaseReport:
    """Return the report of a case file with a constant wall time."""
    case = load(path, [])
    scene = Scene(case, keep_values=True)
    result = replace(scene.run(), wall_s=0.25)
    values = [limit.values(scene.start) for limit in scene.limits]
    return case_report(case, result, values, scene.typical(), scene.timebase.per_second)


def drawn() -> Timeline:
    """A timeline from -100 us to 200 us, shown from -20 us to 30 us; 0 is 12.345 ms after the begin of the run.

    LINE   high, falls at -10 us, rises at 5 us, falls at 15 us
    WORDS  3 from -100 us, 4 from 5 us to 200 us
    span   "work" from 0 to 10 us
    REG    read at -1 us, written at 2 us
    """
    moved = ["LINE fell\nheld low by dsp", "moved", "moved"]
    line = Lane("wave", "LINE", initial=1, at=[-10 * US, 5 * US, 15 * US], says=moved)
    words = Lane("boxes", "SCIFFRX.RXFFST", "dsp", at=[-100 * US, 5 * US], end=[5 * US, 200 * US])
    words.labels, words.says = ["3", "4"], ["RXFFST = 3", "RXFFST became 4"]
    span = Lane("boxes", "span", "dsp", at=[0], end=[10 * US], labels=["work"], says=["span work\nat main:7"])
    register = Lane("marks", "REG", "dsp", at=[-1 * US, 2 * US], labels=["11", "<b>"])
    register.says = ["read REG = 0x0011\nat main:3", "write of REG\nat main:4"]
    register.strong, register.places = [0, 1], ["main:3", "main:4"]
    return Timeline(
        origin=12_345 * US,
        begin=0,
        end=5 * US,
        per_second=1_000_000 * US,
        cycles={"dsp": float(CYCLE)},
        shown=(-20 * US, 30 * US),
        kept=((-100 * US, 200 * US),),
        groups=(("pins", (line,)), ("flags", (words,)), ("firmware", (span,)), ("accesses", (register,))),
    )


def budget(name: str, worst: float, limit: float = 10.0, timeline: Timeline | None = None) -> BudgetReport:
    verdict = "pass" if worst <= limit else "fail"
    said = Verdict(name, "response", "us", worst, limit, limit - worst, 3, verdict, 0.012345, why=f"why {name}")
    return BudgetReport(said, (("max", f"{limit} us"),), "", False, None, timeline, None)


def run_of(numbers: list[int], which: str = "max", **limits: int) -> OverTime:
    """Return values in microseconds, one each millisecond from 1 ms on, of a run of 100 ms or longer if necessary."""
    data = np.array(numbers, np.int64) * US
    at = np.arange(1, len(data) + 1) * 1000 * US
    values = Values("time", data, at, {key: limit * US for key, limit in limits.items()})
    verdict = replace(budget("made", float(max(numbers))).verdict, which=which)
    return over_time(values, verdict, max(100, len(data) + 1) * 1000 * US)


def report(*budgets: BudgetReport, name: str = "by hand") -> CaseReport:
    verdict = "fail" if any(one.verdict.verdict == "fail" for one in budgets) else "pass"
    return CaseReport(
        name=name,
        about="Made by hand.",
        verdict=verdict,
        standing="good" if verdict == "pass" else "bad",
        simulated_s=1.0,
        wall_s=0.25,
        clocks=(("dsp", "150 MHz"),),
        options=(),
        changes=(),
        counts={},
        findings=(),
        notes=(),
        budgets=budgets,
    )
