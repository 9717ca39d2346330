"""Discovery of case files below a folder: they are recognized by their tables, whether they are valid or not."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.scene.case.discover import cases_below, is_case


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("a.toml", '[unit.dsp]\nfirmware = "x"\n', True),
        ("a.toml", 'name = "x"\n[[budget]]\n', True),
        ("a.toml", "\t[ controller ]\n", True),
        ("a.toml", "[unit", True),  # broken, which `check` is to report
        ("a.toml", '[project]\nname = "x"\n[tool.unit]\n', False),
        ("a.toml", "[units]\n", False),
        ("a.toml", "# [unit.dsp]\n", False),
        ("a.txt", "[unit.dsp]\n", False),
    ],
)
def test_a_case_is_recognized_by_its_tables(name: str, text: str, found: bool, tmp_path: Path):
    (tmp_path / name).write_text(text)
    assert is_case(tmp_path / name) is found


def test_a_folder_and_a_missing_file_are_not_cases(tmp_path: Path):
    (tmp_path / "folder.toml").mkdir()
    assert not is_case(tmp_path / "folder.toml") and not is_case(tmp_path / "none.toml")


def test_hidden_and_installed_folders_are_not_searched(tmp_path: Path):
    """Cases are listed by name, those of a folder before those of its subfolders."""
    for place in ("b", "a", "sub/c", "sub/deep/d", "also/e", ".git/f", "node_modules/g", "sub/__pycache__/h", "env/i"):
        file = tmp_path / f"{place}.toml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("[unit.dsp]\n")
    (tmp_path / "env" / "pyvenv.cfg").touch()
    (tmp_path / "pyproject.toml").write_text("[project]\n")
    found = [file.relative_to(tmp_path).with_suffix("").as_posix() for file in cases_below(tmp_path)]
    assert found == ["a", "b", "also/e", "sub/c", "sub/deep/d"]
