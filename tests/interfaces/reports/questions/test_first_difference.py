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


LATE = f"{SYSTEM}.pf2_write_ws=15"
FIVE, FAILS, GONE = (f"unit.dsp.firmware={name}.py" for name in ("five", "fails", "gone"))
READ = "dsp: SCI-A.SCICCR read, 0x0000 at main:4 at 0.047 us"
WROTE = "dsp: SCI-A.SCIHBAUD written, 0x0007 at main:5 at 0.100 us"
CHANGED = "dsp.SCI-A.SCIHBAUD.BAUD = 7 at 0.100 us"


@pytest.mark.parametrize(
    ("before", "answers", "base", "other"),
    [
        ((), (LATE,), WROTE, WROTE.replace("0.100", "0.200")),
        ((), (FIVE,), WROTE, WROTE.replace("0x0007", "0x0005")),
        ((), (GATE,), None, CHANGED),
        ((GATE,), (), CHANGED, None),
        ((FAILS,), (FAILS, GATE), None, CHANGED),  # firmware that fails ends the comparison
        ((), (GONE,), READ, None),  # a run that cannot be built has no event
        ((GONE,), (), None, READ),
    ],
)
def test_a_later_a_changed_or_a_missing_event_is_the_difference(
    tmp_path: Path, before: tuple[str, ...], answers: tuple[str, ...], base: str | None, other: str | None
) -> None:
    (tmp_path / "five.py").write_text(FIRMWARE.replace("= 7", "= 5"), encoding="utf-8")
    fails = FIRMWARE.replace("sci.SCILBAUD.all = 7", "raise ValueError('no')")
    (tmp_path / "fails.py").write_text(fails, encoding="utf-8")
    result = compared(written(tmp_path), *answers, before=before)
    assert [event and f"{event.text} at {event.at_s * 1e6:.3f} us" for event in result] == [base, other]
    assert [event and f"{event.text} at {event.at}" for event in result] == [base, other]


def test_runs_that_do_not_differ_have_no_first_difference(tmp_path: Path) -> None:
    assert compared(written(tmp_path)) is None
    assert compared(tmp_path / "small.toml", GONE, before=(GONE,)) is None


def test_a_difference_in_a_later_slice_is_found_and_one_after_the_end_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    late = FIRMWARE.replace("    with dsp", "    dsp.compute(1500)\n    with dsp")
    monkeypatch.setattr(module, "SLICE", Fraction(1, 1_000_000))
    result = compared(written(tmp_path, firmware=late), LATE)
    assert result is not None and result.base is not None and result.base.at == "10.100 us"
    assert compared(tmp_path / "small.toml", LATE, length=Fraction(9, 1_000_000)) is None


def test_an_event_after_the_slice_is_later_and_not_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "SLICE", Fraction(11, 100_000_000))
    result = compared(written(tmp_path), LATE)
    assert result is not None and result.base is not None and result.other is not None
    assert (result.base.at, result.other.at) == ("0.100 us", "0.200 us")


def test_the_other_runs_are_compared_if_one_cannot_be_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With one answer to the question about the clock gate, no scene can be built."""
    build = PreparedScene.scene

    def refusing(self: PreparedScene, changes: Sequence[str] = (), *others: Any) -> Scene:
        if GATE in changes:
            raise BadCase("no such scene")
        return build(self, changes, *others)

    monkeypatch.setattr(PreparedScene, "scene", refusing)
    file = written(tmp_path)
    result = explored(file, "budget.work.max=183.333 ns")
    found = first_differences(file, ["budget.work.max=183.333 ns"], LENGTH, result.attempts, dependences(result))
    alone = [attempt.answers[0].change if len(attempt.answers) == 1 else "" for attempt in result.attempts]
    assert found[alone.index(GATE)] is not None and len(found) == 3


def test_a_pair_is_compared_with_its_first_answer_and_the_number_is_limited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = written(tmp_path)
    result = explored(file, "budget.work.max=183.333 ns")  # 27.5 cycles
    found = first_differences(file, ["budget.work.max=183.333 ns"], LENGTH, result.attempts, dependences(result))
    alone, pair = found.values()
    assert alone is not None and pair is not None and alone.base is not None and pair.base is not None
    assert (alone.base.at, pair.base.at) == ("0.100 us", "0.187 us")  # the pair's first answer delays it by 13 cycles
    monkeypatch.setattr(module, "MOST_EXPLAINED", 1)
    fewer = first_differences(file, [], LENGTH, result.attempts, dependences(result))
    assert [*fewer] == [next(iter(found))]
