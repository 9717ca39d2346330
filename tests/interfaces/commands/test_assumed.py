"""The undocumented behaviours that a failure assumes: those used during it or shortly before it.

span early |--|                       nothing undocumented
span full            |--| at 5 ms     SCITXBUF is written while it is full
"""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.explain import assumed
from tests.interfaces.commands.conftest import Run

FULL = "txbuf_write_when_full"
FIRMWARE = """
from periph_sim.firmware import start_sci


def main(dsp, settings):
    dsp.compute(300_000)
    with dsp.span("early"):
        dsp.compute(1000)
    sci = start_sci(dsp, "SCI-A", fifo=False)
    dsp.compute(450_000)
    with dsp.span("full"):
        for value in range(3):
            sci.SCITXBUF.all = value
        dsp.compute(1000)
"""
CASE = """
name = "small"
duration = "6 ms"
[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
[[budget]]
name = "early"
measure = "span:early"
max = "{early} us"
[[budget]]
name = "full"
measure = "span:full"
max = "{full} us"
"""


@pytest.fixture(autouse=True)
def folder(here: Path) -> None:
    Path("mine.py").write_text(FIRMWARE, encoding="utf-8")
    write(early=1, full=1)


def write(early: int, full: int) -> None:
    Path("small.toml").write_text(CASE.format(early=early, full=full), encoding="utf-8")


def assumed_lines(text: str) -> str:
    """Return the names on the lines about undocumented behaviours as one line, or "" if there are none."""
    _, found, after = text.partition("  undocumented behaviours assumed in it or shortly before: ")
    first, *others = after.splitlines() if found else [""]
    return " ".join([first, *(line.strip() for line in itertools.takewhile(lambda one: one[:4] == "    ", others))])


def test_a_failure_counts_the_options_that_were_used_in_it_and_no_others(periph_sim: Run) -> None:
    result = periph_sim("run", "small.toml")
    lines = result.out.splitlines()
    early, full = (
        next(n for n, line in enumerate(lines) if line.startswith(f"{name}: ")) for name in ("early", "full")
    )
    assert result.status == 1 and full == early + 1, "nothing undocumented was used in span early"
    named = assumed_lines(periph_sim("run", "small.toml", "-v").out)
    count = len(re.findall(r"\b[a-z]\w+(?=[,;]|$)", named))
    assert lines[full + 1] == f"  it assumes {count} undocumented behaviours (worst names them)"
    assert named.startswith("dsp.sci: ") and FULL in named
    assert lines[-1].startswith("assumes ")


def test_explanation_report_and_json_name_the_assumed_behaviours(periph_sim: Run) -> None:
    named = assumed_lines(periph_sim("run", "small.toml", "-v").out)
    for command in (("worst", "small.toml", "full"), ("run", "small.toml", "--explain")):
        assert assumed_lines(periph_sim(*command).out) == named != ""
    report = periph_sim("worst", "small.toml", "--json").json_object["budgets"]
    assert report["early"]["assumes"] == [] and f"dsp.sci.{FULL}" in report["full"]["assumes"]
    periph_sim("run", "small.toml", "--html", "page.html")
    page = Path("page.html").read_text(encoding="utf-8")
    count = len(report["full"]["assumes"])
    assert f"It assumes {count} undocumented behaviours." in page.partition("full</strong>")[2].partition("</p>")[0]
    assert f'<p class="quiet">undocumented behaviours assumed in it or shortly before: {named}</p>' in page


def test_a_passing_budget_names_no_behaviour_and_a_passing_run_is_not_repeated(
    periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(early=1, full=100)
    assert "it assumes" not in periph_sim("run", "small.toml").out
    assert "shortly before" not in periph_sim("worst", "small.toml", "full").out
    write(early=100, full=100)
    monkeypatch.setattr(assumed, "Scene", None)
    assert periph_sim("run", "small.toml").status == 0


def test_a_long_run_is_not_repeated_to_count_its_assumptions(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assumed, "LATEST", 0.004)
    result = periph_sim("run", "small.toml")
    assert "full: " in result.out and "it assumes" not in result.out
    assert FULL in periph_sim("worst", "small.toml", "full").out


def test_ctrl_c_in_the_second_run_keeps_the_table_of_the_first(
    periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(1, 1)

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(assumed, "advance", stopped)
    result = periph_sim("run", "small.toml")
    assert "small: FAIL" in result.out and "full: " in result.out and "it assumes" not in result.out
    assert result.status not in (0, 1)
