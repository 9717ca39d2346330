"""What docs/fidelity.md says that code of images costs: of public ones where they are there, of ours always."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest

from tests.docs.pages import ROOT
from tests.processor.image_files.code_costs import PROGRAMS, costs

ROW = re.compile(r"^\| [^|]* \[(\S+)\] \| ((?:pass|enter|leave) \S+) \| (\d+) \|$", re.MULTILINE)


def shown() -> Mapping[str, dict[str, int]]:
    """The page's figures by program."""
    found: dict[str, dict[str, int]] = {}
    for program, what, cycles in ROW.findall((ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")):
        found.setdefault(program, {})[what] = int(cycles)
    return found


@pytest.mark.parametrize("program", sorted(shown()))
def test_the_pages_figures_are_measured(program: str):
    measured = costs(program)
    assert {what: measured.get(what) for what in shown()[program]} == shown()[program]


def test_every_program_that_can_be_measured_is_on_the_page():
    assert set(shown()) == set(PROGRAMS)
