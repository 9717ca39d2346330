"""The table of speeds in docs/fidelity.md agrees with the figures in docs/bench.json. Nothing is timed."""

from __future__ import annotations

import json

import pytest

from tests.bench import targets
from tests.bench.levels import EXACT
from tests.bench.speed_table import KEPT, PAGE, ROWS, figures, table, with_table

MACHINE = {"date": "2026-01-02", "processor": "a processor", "python": "CPython 3.11", "load": 0.1, "cores": 2}


def bench(**parts: list[dict[str, object]]) -> dict[str, object]:
    return {"machine": MACHINE, "parts": parts}


def test_the_page_shows_the_kept_figures() -> None:
    kept = json.loads(KEPT.read_text("utf-8"))
    text = PAGE.read_text("utf-8")
    assert with_table(text, kept) == text
    assert [row["what"] for row in kept["rows"]] == [what for what, _, _ in ROWS]


def test_the_table_has_machine_date_form_and_every_row() -> None:
    row = {"case": "imu_hil", "level": EXACT, "form": "compiled", "bytes_per_s": 61234.5}
    shown = table(figures(bench(levels=[row])))
    assert "| compiled | interpreted |" in shown and "2026-01-02, one core of a processor, CPython 3.11: I2C" in shown
    assert "| `imu_hil` with all its budgets | 61,200 bytes/s | - |" in shown
    assert shown.count("| - | - |") == len(ROWS) - 1


def test_figures_of_a_busy_machine_are_marked() -> None:
    kept = figures({**bench(), "machine": {**MACHINE, "load": 7.6}})
    assert "CPython 3.11, beside other work (load 8): " in " ".join(table(kept).split())


def test_the_table_names_speed_and_missing_features_of_another_simulator() -> None:
    row = {"what": "cocotb + Icarus Verilog + cocotbext-i2c: a master asks a memory", "per_s": 1234.0, "lacks": "x; y"}
    assert "cocotbext-i2c: 1,230 bytes/s of x." in " ".join(table(figures(bench(peers=[row]))).split())
    assert "cocotb" not in table(figures(bench(peers=[{**row, "per_s": None}])))


def test_a_page_without_its_marks_is_an_error() -> None:
    with pytest.raises(ValueError, match="no marks"):
        with_table("# periph_sim\n", figures(bench()))


def test_targets_have_rows_of_the_measured_figures() -> None:
    edge = {"case": "responder", "level": EXACT, "form": "compiled", "bytes_per_s": 120_000.0}
    psr = {"case": "imu_hil", "recorded": ".psr", "form": "interpreted", "times_as_long": 1.6}
    found = list(targets.rows({"levels": [edge], "recorded": [psr]}))
    assert [(row["what"], row["form"], row["part"]) for row in found] == [
        ("responder", "compiled", 0.5),
        ("imu_hil, .psr recorded", "interpreted", 1.25),
    ]
    assert targets.line(found[0]).endswith("120,000 bytes/s, >= 240,000: 0.50 of it")
    assert targets.line(found[1]).endswith("1.6 x as long, <= 2: reached")
