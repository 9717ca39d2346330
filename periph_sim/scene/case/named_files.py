"""Files that the texts of a case name, with those that these files may import or include."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

BESIDE = {".py": "*.py", ".asm": "*.inc", ".c": "*.h"}  # what a source may read from its own folder
LONGEST = 200  # maximum number of characters of a path


def texts_in(tree: object) -> Iterator[str]:
    """Yield every text that is a value in a tree of TOML."""
    if isinstance(tree, dict):
        tree = [*tree.values()]
    if isinstance(tree, list):
        for one in tree:
            yield from texts_in(one)
    elif isinstance(tree, str):
        yield tree


def named_files(folder: Path, texts: Iterable[str]) -> Iterator[Path]:
    """Yield the path that each text would be below `folder`, and the files beside it, or in it, that may be read."""
    for text in texts:
        if len(text) >= LONGEST or "\0" in text:
            continue
        file = folder / text
        yield file
        if file.suffix in BESIDE:
            yield from file.parent.glob(BESIDE[file.suffix])
        elif file.is_dir():  # a folder of headers
            yield from file.glob("*.h")
