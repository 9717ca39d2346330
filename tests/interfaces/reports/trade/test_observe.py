"""Observation and comparison of runs: verdicts, occurrences of times, and values read."""

from __future__ import annotations

from contextlib import nullcontext
from fractions import Fraction
from math import inf
from pathlib import Path

import numpy as np
import pytest

from periph_sim.interfaces.reports.trade import observe as module
from periph_sim.interfaces.reports.trade.observe import Error, Errors, Observed, compare, observe
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

ROUND = Fraction(3, 100)


def observed(
    verdicts: dict[str, str] | None = None,
    times: dict[str, list[float]] | None = None,
    samples: dict[str, list[list[int]]] | None = None,
    others: dict[str, list[int]] | None = None,
) -> Observed:
    arrays = [{name: np.array(values) for name, values in (one or {}).items()} for one in (times, samples, others)]
    return Observed(verdicts or {}, *arrays)


def test_a_run_has_its_verdicts_its_times_and_its_samples():
    found = observe(load(TIMING / "imu_hil_published.toml"), ROUND)
    assert found.verdicts["response"] == "pass" and len(found.times["response"]) == 2 * 3
    assert set(found.times["response"]) == {5e-6} and "wrong bytes" not in found.times
    assert sorted(found.samples) == ["accelerometer", "gyroscope", "magnetometer"]
    assert {codes.shape for codes in found.samples.values()} == {(2, 3)}
    assert not found.is_empty and observe(load(TIMING / "responder.toml"), Fraction(0)).is_empty


def test_reads_of_other_devices_are_bytes():
    found = observe(load(TIMING / "responder.toml"), ROUND)
    assert found.samples == {} and [len(data) for data in found.others.values()] == [6 * 16]


def test_units_of_another_kind_have_only_the_budgets_they_can_be_judged_by():
    published, image = (load(TIMING / f"imu_hil_{name}.toml") for name in ("published", "image"))
    found = compare(observe(published, ROUND), observe(published.model_copy(update={"unit": image.unit}), ROUND))
    assert "model execution" in found.differ and "wrong bytes" not in found.differ


def test_a_recording_is_written_and_changes_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(module, "TemporaryDirectory", lambda: nullcontext(tmp_path))
    case = load(TIMING / "imu_hil_published.toml")
    alone, recorded = (observe(case, ROUND, record) for record in ("", ".vcd"))
    assert [path.name for path in tmp_path.iterdir()] == ["run.vcd"] and (tmp_path / "run.vcd").stat().st_size > 10_000
    assert compare(alone, recorded) == Errors(len(alone.verdicts), (), Error(0, "s"), Error(0, "bytes"))


def test_budgets_agree_if_their_verdicts_are_equal():
    reference = observed({"a": "pass", "b": "fail", "c": "pass", "d": "not judged"})
    found = compare(reference, observed({"a": "pass", "b": "pass", "d": "pass"}))
    assert (found.judged, found.differ, found.cells[0]) == (3, ("b", "c"), "1 of 3")


def test_the_error_of_times_is_the_largest_of_an_occurrence():
    reference = observed(times={"a": [1.0, 2.0, 3.0], "b": [1.0], "c": [5.0]})
    found = compare(reference, observed(times={"a": [1.0, 2.5, 3.0], "b": [1.25]}))
    assert found.time == Error(0.5, "s", "a")
    more = compare(reference, observed(times={"a": [1.0, 2.0], "b": [9.0]}))
    assert more.time == Error(inf, "s", "a") and more.time.text == "other count"


def test_the_error_of_values_is_their_difference():
    """The codes 32,767 and -22,863 differ by 55,630, whatever their errors are."""
    reference = observed(samples={"gyroscope": [[0, 0, 32767]]}, others={"0x50": [1, 2, 3]})
    found = compare(reference, observed(samples={"gyroscope": [[3, 0, -22863]]}, others={"0x50": [1, 2, 4]}))
    assert found.value == Error(55630, "LSB", "gyroscope")
    same = compare(reference, observed(samples={"gyroscope": [[0, 0, 32767]]}, others={"0x50": [9, 2, 4]}))
    assert same.value == Error(2, "bytes", "0x50")
    assert compare(reference, observed()).value == Error(inf, "LSB", "gyroscope")


@pytest.mark.parametrize(
    ("amount", "unit", "text"),
    [
        (0.0, "s", "none"),
        (2.5e-9, "s", "2.5 ns"),
        (249.46e-6, "s", "249 us"),
        (0.02, "s", "20 ms"),
        (3.0, "s", "3 s"),
        (1e-13, "s", "0.0001 ns"),
        (2.0, "LSB", "2 LSB"),
        (55630.0, "LSB", "55630 LSB"),
    ],
)
def test_errors_are_formatted_with_their_unit(amount: float, unit: str, text: str):
    assert Error(amount, unit).text == text
