"""docs/fidelity.md names tests: each file and function must be there. Its table of scenes says what was measured."""

from __future__ import annotations

import re

import pytest

from periph_sim.reports.trade.text_report import number
from tests.docs.pages import ROOT
from tests.reports.trade.test_scenes import BYTE, NAMES

PAGE = (ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")


def test_every_test_file_that_the_page_names_is_there():
    named = re.findall(r"`(tests/[\w/.]+)`", PAGE)
    assert len(named) > 10
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_every_test_that_the_page_names_is_there():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    files = {path.name for path in (ROOT / "tests").rglob("test_*.py")}
    named = [name for name in re.findall(r"`(test_\w+(?:\.py)?)`", PAGE) if name not in files]
    assert len(named) >= 2
    assert [name for name in named if f"def {name}(" not in sources] == []


SCENES = dict(re.findall(r"^\| (\w+) \| (exact|refused|infinite|[\d.]+) \|", PAGE, re.MULTILINE))


def test_the_page_has_every_scene_of_timing_trade():
    assert sorted(SCENES) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_the_page_says_of_a_scene_what_its_test_measures(name: str):
    """`test_what_byte_makes_of_it` holds these figures to what is measured."""
    measured = BYTE[name]
    if isinstance(measured, str):
        assert SCENES[name] == "refused"
    else:
        assert SCENES[name] == (number(measured) if measured else "exact")


def test_each_file_that_the_page_names_as_a_case_is_there():
    named = re.findall(r"`(timing/[\w/]+\.toml)`", PAGE)
    assert named and [path for path in named if not (ROOT / path).exists()] == []
