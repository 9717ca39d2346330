"""Search for the case files in a folder and its sub-folders.

The folder may be a whole repository that also contains a pyproject.toml and a virtual environment. A TOML file is a
case if it has a table that only cases have. Files are not parsed, so `check` also finds a case with invalid TOML and
reports the mistake.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from ...core.input_files import read_regular

MARKER = re.compile(rb"^[ \t]*\[{1,2}[ \t]*(unit|budget|controller)\b", re.MULTILINE)
NOT_SEARCHED = frozenset({"node_modules", "__pycache__", "site-packages"})


def is_case(path: Path) -> bool:
    """Return True for a `.toml` file with a header of a table that only cases have: unit, budget or controller."""
    try:
        return path.suffix == ".toml" and MARKER.search(read_regular(path)) is not None
    except OSError:
        return False


def is_searched(folder: Path) -> bool:
    """Return True for a folder that may contain cases.

    Return False for a hidden folder, a virtual environment, or a folder of installed or compiled files.
    """
    return not folder.name.startswith(".") and folder.name not in NOT_SEARCHED and not (folder / "pyvenv.cfg").exists()


def cases_below(folder: Path) -> Iterator[Path]:
    """Yield the case files of a folder, then those of its sub-folders for which `is_searched` is True.

    Files and sub-folders are in order of name.
    """
    for above, folders, files in os.walk(folder):
        here = Path(above)
        folders[:] = sorted(name for name in folders if is_searched(here / name))
        yield from (here / name for name in sorted(files) if is_case(here / name))
