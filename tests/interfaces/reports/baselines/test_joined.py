"""A baseline keeps the figures of each condition of a joined budget."""

from __future__ import annotations

from pathlib import Path

from periph_sim.interfaces.reports.baselines.outcome import Outcome, run_case
from tests.scene.runs import TIMING

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
    outcome = run_case(path)
    assert isinstance(outcome, Outcome)
    figures = outcome.figures.budgets
    assert list(figures) == ["fresh and right", "fresh and right and value error of gyroscope"]
    age, error = figures.values()
    assert (age.unit, error.unit, error.worst, error.count) == ("time", "LSB", 5_823_750, age.count)
    assert [verdict.name for verdict in outcome.verdicts] == ["fresh and right"]
