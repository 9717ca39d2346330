"""`[tool.periph-sim]` of a pyproject.toml: where it applies, its keys, and mistakes in it."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import asdict

from periph_sim.scene.case.model import BadCase
from periph_sim.scene.project import Project, baseline_path, project_of
from tests.scene.small import sentence_of

TABLE = "[tool.periph-sim]\n"


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "timing" / "deep").mkdir(parents=True)
    return tmp_path


def write_pyproject(folder: Path, text: str) -> None:
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")


def test_without_a_table_the_cases_are_in_timing_or_the_folder_itself(repository: Path):
    assert project_of(Path()).cases() == [Path("timing")]
    assert project_of(Path("timing")).cases() == [Path("timing")]
    assert baseline_path(Path("timing/a.toml")) == Path("timing/baselines/a.json")


@pytest.mark.parametrize(
    "text",
    [
        "[project]\nname = 'periph-sim-user'\n",
        "[tool.other]\nunit = 1\n",
        "tool = 3  # periph-sim\n",
        "no TOML [ periph-sim",
        "",
    ],
)
def test_a_pyproject_without_the_table_is_ignored(repository: Path, text: str):
    write_pyproject(repository, TABLE + "jobs = 3\n")
    write_pyproject(repository / "timing", text)
    assert project_of(Path("timing/deep")).settings.jobs == 3


def test_a_pyproject_that_is_not_utf_8_is_ignored(repository: Path):
    (repository / "pyproject.toml").write_bytes(b"# periph-sim \xff\n")
    assert project_of(Path()) == Project(repository)


def test_the_nearest_table_applies_and_its_paths_are_relative_to_its_folder(
    repository: Path, monkeypatch: pytest.MonkeyPatch
):
    write_pyproject(repository, TABLE + 'cases = ["timing"]\nguaranteed = true\ntolerance = 2\njobs = 1\n')
    write_pyproject(repository / "timing", TABLE + 'cases = ["deep"]\n')
    assert project_of(Path("timing/deep")).cases() == [Path("timing/deep")]
    assert not project_of(Path("timing")).settings.guaranteed
    assert asdict(project_of(Path()).settings) == {
        "cases": ["timing"],
        "baselines": None,
        "guaranteed": True,
        "jobs": 1,
        "tolerance": 2,
        "plugins": [],
    }
    monkeypatch.chdir("timing/deep")
    assert project_of(Path()).cases() == [Path()]


def test_files_installed_in_an_environment_do_not_belong_to_the_project_around_it(repository: Path):
    site = repository / "env" / "lib" / "examples"
    site.mkdir(parents=True)
    write_pyproject(repository, TABLE + "guaranteed = true\n")
    assert project_of(site).settings.guaranteed
    (repository / "env" / "pyvenv.cfg").touch()
    assert not project_of(site).settings.guaranteed


def test_baselines_of_a_projects_cases_are_in_its_folder_and_others_are_beside_their_cases(repository: Path):
    (repository / "line.toml").touch()
    write_pyproject(repository, TABLE + 'cases = ["timing", "line.toml"]\nbaselines = "ci/figures"\n')
    assert baseline_path(Path("timing/a.toml")) == Path("ci/figures/a.json")
    assert baseline_path(Path("timing/deep/a.toml")) == Path("ci/figures/deep/a.json")
    assert baseline_path(Path("line.toml")) == Path("ci/figures/line.json")
    assert baseline_path(Path("other.toml")) == Path("baselines/other.json")


@pytest.mark.parametrize("cases", ['["a", "b"]', '["b/line.toml", "a"]', '["a/line.toml", "b/line.toml"]'])
def test_two_cases_never_share_a_baseline(repository: Path, cases: str):
    """Cases a/line.toml and b/line.toml would share base/line.json. In nested folders a/deep/line.toml has its own."""
    files = [repository / name for name in ("a/line.toml", "b/line.toml", "a/deep/line.toml", "b/other.toml")]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        file.write_text("[unit.dsp]\n")
    write_pyproject(repository, f'{TABLE}cases = {cases}\nbaselines = "base"\n')
    for one, other in (("a", "b"), ("b", "a")):
        sentence = f"{one}/line.toml and {other}/line.toml would both have base/line.json; rename one of them"
        with pytest.raises(BadCase, match=f"^pyproject.toml, line 3: baselines: {sentence}, or leave baselines out$"):
            baseline_path(Path(f"{one}/line.toml"))
    write_pyproject(repository, f'{TABLE}cases = ["a", "a/deep", "b/other.toml"]\nbaselines = "base"\n')
    assert baseline_path(Path("a/line.toml")) == Path("base/line.json")
    assert baseline_path(Path("a/deep/line.toml")) == Path("base/deep/line.json")
    (repository / "b" / "line.toml").write_text("[tool]\n")  # not a case
    write_pyproject(repository, f'{TABLE}cases = ["a", "b"]\nbaselines = "base"\n')
    assert baseline_path(Path("a/line.toml")) == Path("base/line.json")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("jbos = 2\n", "line 2: there is no key 'tool.periph-sim.jbos'; did you mean jobs?"),
        ("\njobs = 0\n", "line 3: tool.periph-sim.jobs: expected 1 or more, but it is 0"),
        (
            'guaranteed = "yes"\n',
            "line 2: tool.periph-sim.guaranteed: expected true or false, but it is 'yes'",
        ),
        ('cases = "timing"\n', "line 2: tool.periph-sim.cases: expected a list, as in ['timing'], but it is 'timing'"),
        ("jobs = \n", "it is not TOML: Invalid value (at line 2, column 8)"),
    ],
)
def test_a_mistake_is_reported_with_file_line_and_key(repository: Path, text: str, sentence: str):
    write_pyproject(repository, TABLE + text)
    assert sentence_of(BadCase, lambda: project_of(Path())) in (
        f"pyproject.toml, {sentence}",
        f"pyproject.toml: {sentence}",
    )


def test_a_missing_folder_of_cases_is_reported(repository: Path):
    write_pyproject(repository, "# ours\n" + TABLE + 'cases = ["timng"]\n')
    with pytest.raises(
        BadCase, match=r"^pyproject.toml, line 3: cases: there is no folder or file .*did you mean timing"
    ):
        project_of(Path()).cases()
