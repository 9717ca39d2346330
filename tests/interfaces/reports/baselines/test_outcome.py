"""One run of a case: the figures in its outcome, and the report of firmware that holds the bus."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.interfaces.reports.baselines.outcome import Outcome, baseline_of, run_case
from tests.interfaces.reports.baselines.desk import put
from tests.scene.runs import TIMING

BUS = """\
name = "bus"
duration = "12 ms"
[controller]
period = "10 ms"
[[controller.request]]
chip = "gyroscope"
[[budget]]
name = "nacks"
measure = "nacked rounds"
max = 9
"""


def outcome(path: Path, *changes: str) -> Outcome:
    return run_case(path, changes)


def test_a_case_without_units_counts_ticks_and_keeps_no_values(tmp_path: Path):
    (tmp_path / "bus.toml").write_text(BUS, encoding="utf-8")
    ran = outcome(tmp_path / "bus.toml")
    assert (ran.figures.ticks_per_cycle, ran.values) == (1, [None])


@pytest.mark.parametrize(("end", "held_since"), [("85 ms", ""), ("115 ms", "110.295 ms")])
def test_firmware_that_holds_scl_at_the_end_of_the_run_is_reported(tmp_path: Path, end: str, held_since: str):
    """The firmware computes 33 ms before it answers the rounds at 5, 45 and 85 ms. A hold is reported after 25 ms."""
    ran = outcome(put(tmp_path, wait=5_000_000), f"duration={end}")
    held = f"SCL is held low by dsp.GPIO33 at {held_since}: dsp computes at line 110 of small_firmware.py"
    assert ran.trouble == ([held] if held_since else [])
    assert ran.figures.counts["stuck"] == (3 if held_since else 2)


@pytest.mark.parametrize(
    ("silent", "at", "start", "shown"),
    [(False, 0, 0, 0), (False, 7, 4, 3), (False, -1, 0, None), (True, 7, 4, None), (True, -1, 0, None)],
)
def test_instants_are_relative_to_the_begin_of_the_run(silent: bool, at: int, start: int, shown: int | None):
    measure = SimpleNamespace(silent=silent, unit="time", count=1, worst=5, worst_at=at, least=3, least_at=at)
    part = SimpleNamespace(budget=SimpleNamespace(name="b", measure="it", max=9), measure=measure)
    scene: Any = SimpleNamespace(
        case=SimpleNamespace(name="c", unit={}), kernel=SimpleNamespace(now=10), start=start,
        timebase=SimpleNamespace(per_second=1), limits=[SimpleNamespace(parts=[part])],
    )  # fmt: skip
    result: Any = SimpleNamespace(events=1, counts={}, wire_bytes=0, sci_bytes=0, sci_bytes_sent=0)
    found = baseline_of(scene, result)
    assert found.simulated == 10 - start
    figures = found.budgets["b"]
    assert (figures.worst_at, figures.least_at) == (shown, shown)
    assert (figures.worst, figures.least) == ((None, None) if silent else (5, 3))


BUDGET = """
[[budget]]
name = "fresh and right"
measure = "age of gyroscope"
max = "25 ms"
after = "20 ms"
and = [{ measure = "value error of gyroscope", max = 6 }]
"""


def test_each_condition_has_its_own_figures(tmp_path: Path):
    text = (TIMING / "imu_hil_published.toml").read_text(encoding="utf-8").split("[[budget]]")[0] + BUDGET
    path = tmp_path / "joined.toml"
    path.write_text(text.replace('"10 s"', '"0.1 s"'), encoding="utf-8")
    ran = outcome(path)
    figures = ran.figures.budgets
    assert list(figures) == ["fresh and right", "fresh and right and value error of gyroscope"]
    age, error = figures.values()
    assert (age.unit, error.unit, error.worst, error.count) == ("time", "LSB", 5_823_750, age.count)
    assert [verdict.name for verdict in ran.verdicts] == ["fresh and right"]
