"""All values of a run: their number, the worst and the least of them, and their times."""

from __future__ import annotations

from pathlib import Path

from periph_sim import Scene, load
from tests.interfaces.reports.html.made import CASE


def test_values_are_kept_on_request_and_agree_with_the_verdicts(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_text(CASE.replace('duration = "70 ms"', 'duration = "70 ms"\nstart = "3 s"'), encoding="utf-8")
    case = load(path, [])
    scene = Scene(case, keep_values=True)
    result = scene.run()
    kept = [limit.values(scene.start) for limit in scene.limits]
    assert [one is None for one in kept] == [
        False,
        False,
        False,
        False,
        True,
        True,
    ]  # a count, and a measure without a value
    for limit, verdict, one in zip(scene.limits, result.budgets, kept, strict=True):
        if one is not None:
            assert len(one.values) == len(one.at) == verdict.count
            assert (one.values.max(), one.values.min()) == (limit.measure.worst, limit.measure.least)
            assert one.at[one.values.argmax()] == limit.measure.worst_at - scene.start
            assert (one.at >= 0).all()
    assert kept[0].unit == "time" and kept[0].limits == {"max": 180_000}
    assert kept[3].unit == "words" and kept[3].limits == {"max": 13}


def test_values_are_not_kept_by_default(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_text(CASE, encoding="utf-8")
    scene = Scene(load(path, []))
    scene.run()
    assert any(limit.measure.tally is not None for limit in scene.limits)
    assert not any(limit.values(0) for limit in scene.limits)
