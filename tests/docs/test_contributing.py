"""Paths and names in CONTRIBUTING.md exist; the citation and the workflow are complete."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.docs.pages import ROOT

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PATHS = sorted(set(re.findall(r"`([\w.]+/[\w./]*|[\w]+\.toml)`", TEXT)))
NAMED = re.findall(r"`(\w+)`\s+(?:in|of)\s+`([\w./]+\.py)`", TEXT)  # a name that is defined in a file


@pytest.mark.parametrize("path", PATHS)
def test_each_path_exists(path: str) -> None:
    assert (ROOT / path).is_dir() if path.endswith("/") else (ROOT / path).is_file()


@pytest.mark.parametrize(("name", "path"), NAMED)
def test_each_name_is_defined_in_its_file(name: str, path: str) -> None:
    assert re.search(rf"^(class )?{name}\b", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)


ROWS = re.findall(r"^\| (an?(?:other)? .*?) \| (.*?) \| (.*?) \| (.*?) \|$", TEXT, re.MULTILINE)


def test_each_kind_of_addition_names_a_place_an_example_and_a_test() -> None:
    assert len(ROWS) == 13
    for _, place, _, test in ROWS:
        assert re.search(r"`[\w./]+`", place) and re.fullmatch(r"`tests/[\w/]+/test_\w+\.py`", test)
    assert len(PATHS) > 50 and len(NAMED) >= 6


@pytest.mark.parametrize(("added", "place", "copy", "test"), ROWS, ids=[row[0] for row in ROWS])
def test_the_example_is_in_that_place_and_its_test_is_about_it(added: str, place: str, copy: str, test: str) -> None:
    folders = re.findall(r"`([\w./]+)`", place)
    files = re.findall(r"`([\w.]+/[\w./]+)`", copy)
    assert all(file.startswith(tuple(folders)) for file in files)
    tested = (ROOT / test.strip("`")).read_text(encoding="utf-8")
    assert all(Path(file).stem.partition("_")[0] in tested for file in files)


def test_the_citation_names_the_dissertation() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    for line in ("type: thesis", "family-names: Ribeiro", "given-names: Gabriel Silva", "year: 2014", "license: MIT"):
        assert re.search(rf"^[ -]*{line}$", text, re.MULTILINE), line


def test_the_workflow_runs_the_targets_of_the_makefile() -> None:
    text = (ROOT / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8")
    targets = re.findall(r"run: make (\w+)", text)
    assert targets == ["test", "coverage", "wheel"]
    for target in targets:
        assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
