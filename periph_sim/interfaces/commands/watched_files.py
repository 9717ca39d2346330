"""The files of a case, and the times of their last changes."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

from ...core.input_files import note_inputs_of, read_regular
from ...scene.case.origin import named_files, texts_in
from ..reports.baselines.files import path_for

Stamps = dict[Path, tuple[int, int]]


def stamps(case: Path) -> Stamps:
    """Return the time of the last change and the size of each file of a case that exists."""
    found: Stamps = {}
    for file in {*files_of(case)}:
        try:
            status = file.stat()
        except (OSError, ValueError):
            continue
        found[file] = (status.st_mtime_ns, status.st_size)
    return found


def note_inputs(cases: Iterable[Path], but_baselines: bool = False) -> None:
    """Register the files of these cases as inputs of the command, which must not write to them.

    Commands call this if worker processes read the files, since this process then does not notice it.
    """
    for case in cases:
        note_inputs_of(file for file in files_of(case) if not (but_baselines and file == path_for(case)))


def files_of(case: Path) -> Iterator[Path]:
    """Yield the case, its baseline, and the files that its texts name."""
    yield case
    yield path_for(case)
    try:
        tree = tomllib.loads(read_regular(case).decode("utf-8"))
    except (OSError, ValueError):
        return
    yield from named_files(case.parent, texts_in(tree))
