"""docs/schedule.md has a rate for each kind of scenarios that the bench measures. Nothing is timed here."""

from __future__ import annotations

import pytest

from tests.bench.schedule import changes, windows
from tests.bench.schedule_page import MARKS, PAGE, table, with_table

MACHINE = {"date": "2026-01-02", "processor": "a processor", "python": "CPython 3.11", "load": 0.1}
RATE = {"what": "phases", "scenarios": 100_000, "rounds": 50, "per_s": 234_567.8, "cpu_s": 0.4}
TOLD = {"machine": {**MACHINE, "forms": ["compiled"]}, "parts": {"schedule": [{"what": "terms", "cpu_s": 0.1}, RATE]}}


def test_the_page_has_a_line_for_each_kind_of_scenarios():
    (shown,) = MARKS.findall(PAGE.read_text("utf-8"))
    lines = [line.split(" | ")[0].removeprefix("| ") for line in shown.splitlines() if line.startswith("| ")]
    assert lines[1:] == [*changes(1), *windows(1)]


def test_the_table_has_each_rate_in_three_digits_and_the_machine():
    page = "before\n<!-- rates: python -m tests.bench.schedule_page -->\nold\n<!-- end of rates -->\nbehind\n"
    shown = with_table(page, TOLD)
    assert "| phases | 235,000 |\n" in shown and "terms" not in shown and "old" not in shown
    assert "2026-01-02, one core of a processor, CPython 3.11, compiled: calls of 100,000 scenarios" in shown
    assert shown.startswith("before\n") and shown.endswith("<!-- end of rates -->\nbehind\n")
    assert with_table(shown, TOLD) == shown


def test_figures_of_a_busy_machine_say_so():
    told = {**TOLD, "machine": {**MACHINE, "forms": ["interpreted"], "load": 7.6}}
    assert "interpreted, beside other work (load 8): " in " ".join(table(told).split())


def test_a_page_without_marks_is_refused():
    with pytest.raises(ValueError, match="no marks"):
        with_table("nothing", TOLD)
