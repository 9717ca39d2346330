"""CONTRIBUTING.md, the change log and the citation: what they name is there."""

from __future__ import annotations

import re

import pytest

from tests.docs.pages import ROOT

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PATHS = sorted(set(re.findall(r"`([\w.]+/[\w./]*|[\w]+\.toml)`", TEXT)))
NAMED = re.findall(r"`(\w+)`\s+(?:in|of)\s+`([\w./]+\.py)`", TEXT)  # a name of a file


@pytest.mark.parametrize("path", PATHS)
def test_each_path_is_there(path: str) -> None:
    assert (ROOT / path).is_dir() if path.endswith("/") else (ROOT / path).is_file()


@pytest.mark.parametrize(("name", "path"), NAMED)
def test_each_name_is_defined_in_its_file(name: str, path: str) -> None:
    assert re.search(rf"^(class )?{name}\b", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)


def test_each_kind_of_extension_names_a_test_to_copy() -> None:
    sections = [part for part in TEXT.split("\n## ") if re.match("A ", part)]
    assert len(sections) == 10
    assert [part.partition("\n")[0] for part in sections if not re.search(r"`tests/[\w/]+/test_\w+\.py`", part)] == []
    assert len(PATHS) > 30 and len(NAMED) >= 6


def test_the_citation_names_the_dissertation() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    for line in ("type: thesis", "family-names: Ribeiro", "given-names: Gabriel Silva", "year: 2014", "license: MIT"):
        assert re.search(rf"^[ -]*{line}$", text, re.MULTILINE), line


def test_the_workflow_runs_what_a_developer_runs() -> None:
    text = (ROOT / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8")
    targets = re.findall(r"run: make (\w+)", text)
    assert targets == ["test", "coverage", "wheel"]
    for target in targets:
        assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
