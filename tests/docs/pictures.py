"""Pictures of the pages that commands draw: each mark on a page describes one Picture.

<!-- drawn by: periph-sim worst CASE BUDGET --svg . -> BUDGET.svg -->
![what it shows](pictures/NAME.svg)

A picture without a mark is drawn by a command that runs for minutes, and the page shows that command.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.docs.pages import PAGES, written

MARK = re.compile(r"^<!-- drawn by: (.+) -> (\S+) -->\n!\[[^\]]*\]\((\S+)\)$", re.MULTILINE)


class Picture(NamedTuple):
    """The page that shows a picture, the command that writes `drawn` to its folder, and the file of the repository."""

    page: Path
    command: str
    drawn: str
    file: Path


def pictures() -> Iterator[Picture]:
    for page in PAGES:
        for command, drawn, shown in MARK.findall(page.read_text(encoding="utf-8")):
            yield Picture(page, command, drawn, (page.parent / shown).resolve())


def draw(picture: Picture, folder: Path) -> str:
    """Return the text of the picture that the command draws now. Raise ValueError with its output if it draws none."""
    return written(picture.page, picture.command, picture.drawn, folder)
