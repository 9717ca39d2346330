"""No output takes the place of a file that its command reads: one sentence, status 2, and the file stays as it was."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run

SHORT = ("--seconds", "0.001")
CASES = {
    "page over case": ("run", "small.toml", "--html", "small.toml", *SHORT),
    "page over case by a link": ("run", "small.toml", "--html", "link.toml", *SHORT),
    "page over firmware": ("run", "small.toml", "--html", "still.py", *SHORT),
    "page over a module that firmware imports": ("run", "small.toml", "--html", "helper.py", *SHORT),
    "page over a log of another session": ("run", "again.toml", "--html", "live.jsonl", *SHORT),
    "page over a module that is imported later": ("run", "small.toml", "--html", "later.py", *SHORT),
    "JUnit over case": ("check", "small.toml", "--junit", "small.toml"),
    "JUnit over firmware of another process": ("check", "small.toml", "--junit", "still.py", "--jobs", "2"),
    "JUnit over baseline": ("check", "small.toml", "--junit", "baselines/small.json"),
    "page over a case in a folder": ("check", ".", "--html", "small.toml"),
    "rows over case": ("sweep", "small.toml", "--vary", "seed=0,1", "--csv", "small.toml", *SHORT),
    "rows over firmware": ("sweep", "small.toml", "--vary", "seed=0,1", "--csv", "still.py", *SHORT),
    "parameters over samples": ("identify", "rest.csv", "--parameters", "rest.csv"),
}


@pytest.mark.parametrize("arguments", CASES.values(), ids=CASES)
def test_an_output_over_an_input(periph_sim: Run, desk: Path, arguments: tuple[str, ...]):
    (desk / "link.toml").symlink_to("small.toml")
    (desk / "helper.py").touch()
    (desk / "still.py").write_text("from . import helper\n" + (desk / "still.py").read_text())
    (desk / "later.py").touch()
    (desk / "again.toml").write_text(
        (desk / "small.toml").read_text() + '[outside]\nwires = ["RX"]\nlog = "live.jsonl"\n'
    )
    (desk / "baselines").mkdir()
    for name in ("live.jsonl", "baselines/small.json", "rest.csv"):
        (desk / name).write_text("as it was\n")
    before = {file: file.read_bytes() for file in desk.rglob("*") if file.is_file()}
    came = periph_sim(*arguments)
    assert came.status == 2
    (told,) = [line for line in came.err.splitlines() if not line.startswith("the compiled core was built of other")]
    assert "found a file that this command reads, expected a file that is no input" in told
    assert {file: file.read_bytes() for file in desk.rglob("*") if file.is_file()} == before


def test_a_baseline_may_be_renewed(periph_sim: Run, desk: Path):
    for _ in range(2):
        assert periph_sim("check", "small.toml", "--update-baseline", "--junit", "out.xml").status in (0, 1)
    assert (desk / "baselines" / "small.json").is_file()
