"""The parts of the bench give rows of the right contents. No times are tested."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from periph_sim.form import INTERPRETED
from tests.bench import growth, images, levels, nothing
from tests.bench.__main__ import kept
from tests.bench.child import in_form


def test_every_shipped_case_and_variant_is_measured() -> None:
    assert {"imu_hil", "two_dsps", "imu_moving", *levels.VARIANTS} <= set(levels.cases())
    shipped = {path.stem for path in levels.TIMING.glob("*.toml")} - set(levels.POLLED)
    assert set(levels.cases()) == shipped | set(levels.VARIANTS)


def test_a_case_has_a_row_with_optimizations_and_one_without() -> None:
    rows = in_form(INTERPRETED, "levels", "measured", "responder", "responder", [], "0.01", 1)
    assert [(row["level"], row["form"]) for row in rows] == [(level, INTERPRETED) for level in levels.LEVELS]
    exact, plain = (row["events_per_byte"] for row in rows)
    assert 0 < 2 * exact < plain


def test_a_run_that_carries_other_bytes_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(levels.LEVELS, levels.PLAIN, ("controller.period=3 ms",))
    with pytest.raises(AssertionError, match="responder: runs of the same case carried"):
        levels.measured("responder", "responder", [], "0.01", 1)


def test_a_bus_has_up_to_61_slaves_and_100_are_rejected() -> None:
    most, more = growth.slaves(61), growth.slaves(100)
    assert most["bytes_per_s"] > 0 and "refused" not in most
    assert more["refused"] == "wire SDA: d62 would be party 63; a wire has up to 62"


def test_slaves_that_are_not_addressed_cost_less_than_an_event_per_byte() -> None:
    """Each slave only receives the address, so each adds a fraction of an event to the events per byte."""
    few, many = (growth.slaves(number)["events_per_byte"] for number in (1, 11))
    assert 0 <= (many - few) / 10 < 1


def test_an_echo_that_loses_characters_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    assert images.echo("300 us", "0.02") > 0
    monkeypatch.setattr(images, "BAUD", 118_000)  # characters arrive faster than they are sent
    with pytest.raises(RuntimeError, match="characters were sent"):
        images.echo("0 s", "0.02")


def test_absent_things_are_counted_beside_present_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nothing.absent, "ROWS", {"GPIO": nothing.absent.ROWS["GPIO"]})
    (row,) = nothing.rows([INTERPRETED])
    assert (row["imports"], row["objects"]) == (0, 0)
    assert row["imports_with_it"] >= 4 and row["objects_with_it"] >= 3 and row["events_with_it"] >= row["events"]


def test_parts_of_another_day_or_machine_are_not_kept(tmp_path: Path) -> None:
    here = {"date": "2026-01-02", "processor": "p", "python": "3", "forms": ["compiled"], "periph_sim": "1"}
    file = tmp_path / "bench.json"
    assert kept(file, here) == {}
    file.write_text(json.dumps({"machine": here, "parts": {"start": [1]}}), "utf-8")
    assert kept(file, here) == {"start": [1]}
    assert kept(file, {**here, "date": "2026-01-03"}) == {}


def test_the_busy_program_executes_instructions_for_ever() -> None:
    few, more = images.busy(1_000_000)["instructions"], images.busy(2_000_000)["instructions"]
    assert few > 1000 and 1.8 < more / few < 2.2
