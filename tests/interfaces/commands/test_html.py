"""`--html` of run and check: one complete file or none, whatever the verdicts."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import CASE, Run
from tests.interfaces.reports.covered_desk import put_case


def test_run_writes_a_report_beside_its_table(periph_sim: Run, desk: Path) -> None:
    plain = periph_sim("run", "small.toml")
    result = periph_sim("run", "small.toml", "--html", "out.html")
    assert (result.status, result.out, result.err) == (plain.status, plain.out, plain.err)
    text = Path("out.html").read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>") and "rounds in time" in text
    assert [file.name for file in desk.iterdir() if file.suffix == ".html"] == ["out.html"]


def test_a_report_shows_the_changed_case_and_the_shorter_run(periph_sim: Run, desk: Path) -> None:
    change = "budget.rounds in time.max=6 ns"
    assert periph_sim("run", "small.toml", "--seconds", "0.02", "--set", change, "--html", "out.html").status == 1
    text = Path("out.html").read_text(encoding="utf-8")
    assert f"<code>{change}</code>" in text and "0.02 s" in text


def test_one_run_writes_a_recording_and_a_report(periph_sim: Run, desk: Path) -> None:
    periph_sim("run", "small.toml", "--record", "out.psr", "--html", "out.html", "--json")
    assert Path("out.psr").stat().st_size and Path("out.html").stat().st_size


def test_the_report_of_a_run_has_the_worst_values_of_a_coverage_file_that_matches(periph_sim: Run, covered: Path):
    line = "cases/coverage/small.json: 2 budgets held at 31 of 1,500,000 phases"
    assert line in periph_sim("run", "cases/small.toml", "--html", "out.html").out
    text = Path("out.html").read_text(encoding="utf-8")
    assert line in text and "<dt>worst at 31 of 1,500,000 phases</dt>" in text
    periph_sim("run", "cases/small.toml", "--html", "out.html", "--set", "seed=2")
    assert "coverage/small.json" not in Path("out.html").read_text(encoding="utf-8")
    put_case(Path("cases"), comment="# a comment\n")
    periph_sim("run", "cases/small.toml", "--html", "out.html")
    text = Path("out.html").read_text(encoding="utf-8")
    assert "coverage/small.json is out of date: firmware.py has changed</p>" in text and "<dt>worst at" not in text


def test_check_writes_one_report_of_all_cases(periph_sim: Run, desk: Path) -> None:
    Path("timing").mkdir()
    for name in ("one", "two"):
        text = CASE.format(firmware=(desk / "still.py").as_posix()).replace("small", name)
        Path("timing", f"{name}.toml").write_text(text, encoding="utf-8")
    result = periph_sim("check", "--jobs", "1", "--html", "out.html")
    assert result.status == 1  # nothing was measured, and there are no baselines
    text = Path("out.html").read_text(encoding="utf-8")
    assert text.count("<article") == 2 and "it has no baseline" in text
    assert "0 of 2 as they should be" in text


@pytest.mark.parametrize("jobs", [(), ("--jobs", "1"), ("--jobs", "2")])
@pytest.mark.parametrize("others", [0, 1])
def test_the_report_of_check_names_the_cases_that_cannot_be_run(
    periph_sim: Run, desk: Path, jobs: tuple[str, ...], others: int
) -> None:
    """This holds even if no case can be run, so that the report has no timelines."""
    assert periph_sim("check", "--update-baseline", "small.toml").status == 0
    for name in ("one", "two"):
        text = CASE.format(firmware="<b>.py").replace("small", name)
        Path(f"{name}.toml").write_text(text, encoding="utf-8")
    result = periph_sim("check", *jobs, "--html", "out.html", "one.toml", "two.toml", *["small.toml"] * others)
    assert result.status == 2 and result.out.count("Error: ") == 2
    text = Path("out.html").read_text(encoding="utf-8")
    assert f'<span class="chip bad">{others} of {2 + others} as they should be</span></h1>' in text
    assert text.count("<article") == others and text.count('<details class="table"') == others
    for name in ("one", "two"):
        assert f"<li>{name} cannot be run: {name}.toml, line 5: unit.dsp.firmware: there is no firmware file" in text
    assert "&#39;&lt;b&gt;.py&#39;" in text and "<b>" not in text


@pytest.mark.parametrize("command", ["run", "check"])
def test_an_output_that_cannot_be_written_is_an_error_before_the_run(periph_sim: Run, desk: Path, command: str) -> None:
    assert periph_sim.refused(command, "small.toml", "--html", "no/such/out.html") == (
        "no/such/out.html, its place: found no such file or directory, expected a place that can be written to; "
        "give another path"
    )


def test_a_case_that_cannot_be_run_leaves_the_old_report(periph_sim: Run, desk: Path) -> None:
    Path("out.html").write_text("old", encoding="utf-8")
    periph_sim.refused("run", "small.toml", "--set", "unit.dsp.firmware=nobody.py", "--html", "out.html")
    assert Path("out.html").read_text(encoding="utf-8") == "old"
    assert sorted(file.name for file in desk.iterdir() if "html" in file.name) == ["out.html"]


def test_two_outputs_into_one_file_are_refused_before_the_run(periph_sim: Run, desk: Path):
    for command in (("run", "--record", "./a.psr"), ("check", "--junit", "a.psr")):
        assert f"{command[1]} and --html both name a.psr; give each its own file" in periph_sim.refused(
            *command, "--html", "a.psr", "small.toml"
        )
    assert not (desk / "a.psr").exists()
