"""The first event that differs between two runs: later, with another value, in only one of them, or none."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports.questions import first_difference as module
from periph_sim.interfaces.reports.questions.dependence import dependences
from periph_sim.interfaces.reports.questions.first_difference import (
    FirstDifference,
    first_difference,
    first_differences,
)
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.prepared import PreparedScene
from periph_sim.scene.scene import Scene
from tests.interfaces.reports.questions.small import FIRMWARE, LENGTH, explored, written

SYSTEM = "unit.dsp.options.system"
GATE = 'unit.dsp.options.sci.clock_gate_access="accessible"'


def compared(
    file: Path, *answers: str, before: tuple[str, ...] = (), length: Fraction = LENGTH
) -> FirstDifference | None:
    return first_difference(PreparedScene(file), before, answers, length)


def test_an_event_that_comes_later_has_both_times(tmp_path: Path) -> None:
    came = compared(written(tmp_path), f"{SYSTEM}.pf2_write_ws=15")
    assert came is not None and came.base is not None and came.other is not None
    assert came.base.text == came.other.text == "dsp: SCI-A.SCIHBAUD written, 0x0007 at main:5"
    assert came.other.at_s - came.base.at_s == pytest.approx(15 / 150e6)
    assert came.base.at == "0.100 us" and came.base.at_s == pytest.approx(15 / 150e6)


def test_a_value_that_differs_is_shown_with_both_values(tmp_path: Path) -> None:
    file = written(tmp_path)
    (tmp_path / "five.py").write_text(FIRMWARE.replace("= 7", "= 5"), encoding="utf-8")
    came = compared(file, "unit.dsp.firmware=five.py")
    assert came is not None and came.base is not None and came.other is not None
    assert came.base.text == "dsp: SCI-A.SCIHBAUD written, 0x0007 at main:5"
    assert came.other.text == "dsp: SCI-A.SCIHBAUD written, 0x0005 at main:5"
    assert came.base.at_s == came.other.at_s


def test_an_event_of_only_one_run_is_missing_in_the_other(tmp_path: Path) -> None:
    came = compared(written(tmp_path), GATE)
    assert came is not None and came.base is None
    assert compared(written(tmp_path), before=(GATE,)) == FirstDifference(came.other, None)


def test_runs_that_do_not_differ_have_no_first_difference(tmp_path: Path) -> None:
    assert compared(written(tmp_path)) is None


def test_a_difference_in_a_later_slice_is_found_and_one_after_the_end_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    late = FIRMWARE.replace("    with dsp", "    dsp.compute(1500)\n    with dsp")
    monkeypatch.setattr(module, "SLICE", Fraction(1, 1_000_000))
    came = compared(written(tmp_path, firmware=late), f"{SYSTEM}.pf2_write_ws=15")
    assert came is not None and came.base is not None and came.base.at == "10.100 us"
    assert compared(tmp_path / "small.toml", f"{SYSTEM}.pf2_write_ws=15", length=Fraction(9, 1_000_000)) is None


def test_an_event_that_comes_after_the_slice_is_later_and_not_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SLICE", Fraction(11, 100_000_000))
    came = compared(written(tmp_path), f"{SYSTEM}.pf2_write_ws=15")
    assert came is not None and came.base is not None and came.other is not None
    assert (came.base.at, came.other.at) == ("0.100 us", "0.200 us")


def test_firmware_that_fails_ends_the_comparison(tmp_path: Path) -> None:
    fails = FIRMWARE.replace("sci.SCILBAUD.all = 7", "raise ValueError('no')")
    came = compared(written(tmp_path, firmware=fails), GATE)
    assert came is not None and came.other is not None and "SCIHBAUD" in came.other.text


def test_a_run_that_cannot_be_built_has_no_event(tmp_path: Path) -> None:
    gone = "unit.dsp.firmware=gone.py"
    came = compared(written(tmp_path), gone)
    assert came is not None and came.base is not None and came.other is None
    assert compared(tmp_path / "small.toml", before=(gone,)) == FirstDifference(None, came.base)
    assert compared(tmp_path / "small.toml", gone, before=(gone,)) is None


def test_the_other_runs_are_compared_though_one_cannot_be_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer of the question about the clock gate is one with which no scene can be built."""
    build = PreparedScene.scene

    def refusing(self: PreparedScene, changes: Sequence[str] = (), *others: Any) -> Scene:
        if GATE in changes:
            raise BadCase("no such scene")
        return build(self, changes, *others)

    monkeypatch.setattr(PreparedScene, "scene", refusing)
    file = written(tmp_path)
    came = explored(file, "budget.work.max=183.333 ns")
    found = first_differences(file, ["budget.work.max=183.333 ns"], LENGTH, came.attempts, dependences(came))
    alone = [attempt.answers[0].change if len(attempt.answers) == 1 else "" for attempt in came.attempts]
    assert found[alone.index(GATE)] is not None and len(found) == 3


def test_a_pair_is_compared_with_its_first_answer_and_the_number_is_limited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = written(tmp_path)
    came = explored(file, "budget.work.max=183.333 ns")  # 27.5 cycles
    found = first_differences(file, ["budget.work.max=183.333 ns"], LENGTH, came.attempts, dependences(came))
    alone, pair = found.values()
    assert alone is not None and pair is not None and alone.base is not None and pair.base is not None
    assert (alone.base.at, pair.base.at) == ("0.100 us", "0.187 us")  # the pair's first answer delays it by 13 cycles
    monkeypatch.setattr(module, "MOST_EXPLAINED", 1)
    fewer = first_differences(file, [], LENGTH, came.attempts, dependences(came))
    assert [*fewer] == [next(iter(found))]
