"""Which files a case is made of, and when each was last written: a case's path goes in, stamps by path come out."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..core.input_files import note_input
from ..reports.baselines.files import path_for

Stamps = dict[Path, tuple[int, int]]


def stamps(case: Path) -> Stamps:
    """Time and size of each file that is there."""
    found: Stamps = {}
    for file in {*files_of(case)}:
        try:
            status = file.stat()
        except (OSError, ValueError):
            continue
        found[file] = (status.st_mtime_ns, status.st_size)
    return found


def note_inputs(cases: Iterable[Path], but_baselines: bool = False) -> None:
    """Note the files of these cases as inputs, for commands whose other processes read them."""
    for case in cases:
        for file in files_of(case):
            if not (but_baselines and file == path_for(case)):
                note_input(file)


def files_of(case: Path) -> Iterator[Path]:
    """The case, its baseline, and what its texts name: with a `.py` or `.asm` all beside it that it may name."""
    yield case
    yield path_for(case)
    try:
        tree = tomllib.loads(case.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return
    for text in texts_in(tree):
        file = case.parent / text
        if text.endswith(".py"):
            yield from file.parent.glob("*.py")
        elif text.endswith(".asm"):
            yield from (file, *file.parent.glob("*.inc"))
        elif len(text) < 200:
            yield from (file, Path(text))


def texts_in(tree: object) -> Iterator[str]:
    """Every text that is a value in a tree of TOML."""
    if isinstance(tree, dict):
        tree = [*tree.values()]
    if isinstance(tree, list):
        for one in tree:
            yield from texts_in(one)
    elif isinstance(tree, str):
        yield tree
