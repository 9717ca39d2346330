"""A check that is interrupted or has cases that cannot be compared: which cases are judged and which are rejected."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports.baselines.check import STOPPED, check
from periph_sim.interfaces.reports.baselines.files import BadCheck
from periph_sim.interfaces.reports.baselines.outcome import RejectedCase
from periph_sim.scene.project import baseline_path
from tests.interfaces.reports.baselines.desk import put


def stops_after(wanted: float) -> Callable[[float], None]:
    def on_progress(part: float) -> None:
        assert part == wanted
        raise KeyboardInterrupt

    return on_progress


def test_progress_is_reported_after_each_case(cases: Path):
    for name in ("y", "z"):
        put(cases, name)
    parts: list[float] = []
    check([cases], jobs=1, on_progress=parts.append, update=True)
    assert parts == [1 / 3, 2 / 3, 1]


def test_cases_that_ran_before_the_interruption_are_judged_without_second_runs(cases: Path):
    """The findings have neither reasons nor chains of causes, because both need another run."""
    put(cases, sdir_wait=False)
    late = put(cases, "z")
    refused: list[RejectedCase] = []
    (one,) = check([cases], jobs=1, on_progress=stops_after(1 / 2), on_refused=refused.append)
    assert (one.outcome.path, one.state, one.causes) == (cases / "small.toml", "changed", {})
    assert "wrong bytes worst 0 -> 12 bytes" in [finding.text for finding in one.findings]
    assert refused == [RejectedCase(late, f"{late}: {STOPPED}")]


@pytest.mark.parametrize("update", [False, True])
def test_an_update_or_a_check_without_a_callback_stops_at_once(cases: Path, update: bool):
    before = baseline_path(put(cases, wait=3000)).read_bytes()
    for on_refused in (None, pytest.fail) if update else (None,):
        with pytest.raises(KeyboardInterrupt):
            check([cases], jobs=1, on_progress=stops_after(1), update=update, on_refused=on_refused)
    assert baseline_path(cases / "small.toml").read_bytes() == before


def test_a_case_driven_from_outside_is_skipped_if_rejected_cases_are_reported(cases: Path):
    driven = put(cases, "driven")
    driven.write_text(driven.read_text() + '[outside]\nwires = ["SDA", "SCL"]\n', encoding="utf-8")
    for update in (False, True):
        refused: list[RejectedCase] = []
        (one,) = check([cases], jobs=1, update=update, on_refused=refused.append)
        assert one.outcome.path == cases / "small.toml" and one.passed
        assert [(case.path, case.outside) for case in refused] == [(driven, True)]
        with pytest.raises(BadCheck, match="driven"):
            check([cases], jobs=1, update=update)
    assert not baseline_path(driven).exists()


@pytest.mark.parametrize("on_refused", [None, pytest.fail])
def test_a_case_that_cannot_run_leaves_all_baselines_unchanged(cases: Path, on_refused: Any):
    before = baseline_path(put(cases, wait=3000)).read_bytes()
    bad = put(cases, "zz", does="raise ValueError('boom')")
    with pytest.raises(BadCheck, match=r"^dsp: ValueError at line .* of .*zz_firmware.py: boom$"):
        check([cases], jobs=1, update=True, on_refused=on_refused)
    assert baseline_path(cases / "small.toml").read_bytes() == before and not baseline_path(bad).exists()
