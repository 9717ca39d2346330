"""The pictures of the pages, drawn as their marks say: a page goes in, a Picture each comes out.

<!-- drawn by: periph-sim worst CASE BUDGET --svg . -> BUDGET.svg -->
![what it shows](pictures/NAME.svg)

A picture without a mark is drawn by a command that runs for minutes, and stands on the page beside that command.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.docs.pages import PAGES, written

MARK = re.compile(r"^<!-- drawn by: (.+) -> (\S+) -->\n!\[[^\]]*\]\((\S+)\)$", re.MULTILINE)


class Picture(NamedTuple):
    """page: that shows it. command: that writes `drawn` into its folder. file: of the repository."""

    page: Path
    command: str
    drawn: str
    file: Path


def pictures() -> Iterator[Picture]:
    for page in PAGES:
        for command, drawn, shown in MARK.findall(page.read_text(encoding="utf-8")):
            yield Picture(page, command, drawn, (page.parent / shown).resolve())


def draw(picture: Picture, folder: Path) -> str:
    """The picture's text as the command draws it now. ValueError with its output if it draws nothing."""
    return written(picture.page, picture.command, picture.drawn, folder)
