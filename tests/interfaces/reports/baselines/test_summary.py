"""The summary in Markdown: a row for each budget, and what changed since a commit of a git repository."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from periph_sim.interfaces.reports.baselines.check import check
from periph_sim.interfaces.reports.baselines.ci_output import github, in_repository
from periph_sim.interfaces.reports.baselines.files import BadCheck, Baseline
from periph_sim.interfaces.reports.baselines.outcome import RejectedCase
from periph_sim.interfaces.reports.baselines.summary import baselines_at, summary
from periph_sim.scene.project import baseline_path
from tests.docs.pages import ROOT
from tests.interfaces.reports.baselines.desk import put

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is missing")
WHO = ["-c", "user.name=A", "-c", "user.email=a@example.org"]


def git(folder: Path, *arguments: str) -> None:
    subprocess.run(["git", "-C", str(folder), *WHO, *arguments], check=True, capture_output=True)


@pytest.fixture
def repository(cases: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder of cases in a git repository, whose commit `main` has a baseline of the case `small`."""
    monkeypatch.delenv("GIT_DIR", raising=False)
    git(Path.cwd(), "init", "-q", "-b", "main")
    git(Path.cwd(), "add", ".")
    git(Path.cwd(), "commit", "-qm", "small")
    return cases


def table(text: str, case: str) -> dict[str, list[str]]:
    """Return the cells of a case's rows by budget."""
    rows = text.split(f" {case}\n")[1].split("###")[0].splitlines()
    cells = [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows if row.startswith("| ")]
    return {name: more for name, *more in cells}


def test_each_budget_has_its_value_its_limit_and_its_change(repository: Path):
    put(repository, wait=3000)
    put(repository, "z")
    checks = check([repository], jobs=1)
    before = baselines_at("main", [baseline_path(one.outcome.path) for one in checks])
    text = summary(checks, [RejectedCase(Path("cases/bad.toml"), "line 3: a | b\nc")], ("main", before))
    assert text.startswith("## periph-sim check: 0 of 3 as they should be\n")
    assert table(text, "small") == {
        "budget": ["seen", "limit", "verdict", "since main"],
        "response": ["10.287 us", "60 us", "seen", "+793 cycles"],  # 5.287 us at 150 MHz
        "wrong bytes": ["0", "0", "seen", "unchanged"],
        "model": ["250.000 us", "300 us", "seen", "unchanged"],
    }
    assert {row[-1] for row in table(text, "z").values()} == {"since main", "new"}
    assert "line 3: a \\| b c" in text


def test_changes_have_their_unit_and_the_name_of_their_value(repository: Path):
    case, firmware = repository / "small.toml", repository / "small_firmware.py"
    more = '[[budget]]\nname = "busy"\nmeasure = "cpu load"\nmax = "90 %"\n'
    more += '[[budget]]\nname = "floor"\nmeasure = "period of edge SCL fall"\nmin = "1 us"\n'
    more += '[[budget]]\nname = "most"\nmeasure = "response"\np95 = "60 us"\n'
    case.write_text(case.read_text(encoding="utf-8") + more, encoding="utf-8")
    check([repository], jobs=1, update=True)
    git(Path.cwd(), "commit", "-qam", "more")
    firmware.write_text(firmware.read_text(encoding="utf-8").replace("compute(0)", "compute(30000)"), encoding="utf-8")
    checks = check([repository], jobs=1)
    rows = table(summary(checks, since=("main", baselines_at("main", [baseline_path(case)]))), "small")
    changes = {name: row[-1] for name, row in rows.items()}
    assert changes["busy"] == "+1.8185 %"
    assert changes["floor"] == "unchanged"
    assert changes["most"] == "largest value: +27793 cycles"


def test_without_a_commit_there_is_no_change(repository: Path):
    text = summary(check([repository], jobs=1))
    assert table(text, "small")["response"] == ["5.000 us", "60 us", "seen"]
    assert text.count("✅") == 1


def test_a_state_that_git_does_not_have_is_one_error_message(repository: Path, tmp_path: Path, monkeypatch):
    baseline = repository / "baselines" / "small.json"
    with pytest.raises(BadCheck, match=r"^--since origin/main: the clone .* does not contain this commit; fetch it "):
        baselines_at("origin/main", [baseline])
    with pytest.raises(BadCheck, match=r"^/x\.json: it is in no git clone, so it has no state at main; leave --since"):
        baselines_at("main", [Path("/x.json")])
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(BadCheck, match=r"^--since: git is not installed; install it, or leave --since out$"):
        baselines_at("main", [baseline])


def test_a_broken_baseline_in_the_commit_does_not_prevent_the_check(repository: Path):
    baseline = repository / "baselines" / "small.json"
    good = baseline.read_bytes()
    baseline.write_text("{}")
    git(Path.cwd(), "commit", "-qam", "broken")
    baseline.write_bytes(good)
    text = summary(check([repository], jobs=1), since=("main", baselines_at("main", [baseline])))
    assert table(text, "small")["response"] == ["5.000 us", "60 us", "seen", "no readable baseline"]


def test_a_path_with_two_dots_is_found_in_the_commit(repository: Path, monkeypatch: pytest.MonkeyPatch):
    inner = Path("other/inner").absolute()
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner.parent)
    path = Path("inner/..") / ".." / repository / "baselines" / "small.json"
    assert in_repository(path) == "cases/baselines/small.json"
    assert isinstance(baselines_at("main", [path])[path], Baseline)


def test_annotations_are_relative_to_the_repository(repository: Path, monkeypatch: pytest.MonkeyPatch):
    put(repository, sdir_wait=False)
    monkeypatch.chdir(repository)
    lines = github(check([Path()], jobs=1))
    assert lines and all(line.split("file=")[1].startswith("cases/") for line in lines)


def test_the_action_checks_a_pull_request(repository: Path, tmp_path: Path):
    """The shell steps of action.yml run in a fresh clone, as on a runner."""
    clone, message = tmp_path / "clone", tmp_path / "summary.md"
    git(tmp_path, "clone", "-q", "--depth=1", f"file://{Path.cwd()}", str(clone))
    put(clone / repository, sdir_wait=False)
    (step,) = (
        one for one in yaml.safe_load((ROOT / "action.yml").read_text())["runs"]["steps"] if one.get("name") == "Check"
    )
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    own = {"PATHS": "cases", "BASE": "main", "GITHUB_STEP_SUMMARY": str(message), "PATH": path, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", step["run"]],
        cwd=clone,
        env=os.environ | own,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr
    assert table(message.read_text(), "small")["wrong bytes"] == ["12", "0", "broken", "+12"]
    assert "\n::error file=cases/small.toml,line=" in done.stdout
    assert {one.name for one in clone.glob("periph-sim.*")} == {"periph-sim.xml", "periph-sim.html"}
