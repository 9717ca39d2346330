"""Origins of the values in a case (file and line, or a `--set`), and the files that these values name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from msgspec import Struct

from ...core.phrases import shorten

SHOWN = 120  # maximum number of characters of a change in a message
Place = tuple[str | int, ...]  # the keys and list indices that lead from the top of a case to a value


class Source(Struct, frozen=True):
    """The file of a case, and the changes that were applied to it.

    path: the path of the file; if the case has no file, because its tables were given by a program, a label for them.
    text: the text of the file as it was read.
    changes: the `key=value` texts that were applied, each with the place that it changed.
    values: all strings that are values in the case, after the changes. Some of these strings name files.
    is_label: True if `path` is a label.
    """

    path: Path
    text: str
    changes: tuple[tuple[str, Place], ...] = ()
    values: tuple[str, ...] = ()
    is_label: bool = False

    @property
    def folder(self) -> Path:
        """The folder of the file; the current folder if there is no file."""
        return Path() if self.is_label else self.path.parent

    def where(self, place: Place) -> str:
        """Return, for messages, where the value at this place was written: the file and line, or the `--set`."""
        inside = ""
        for change, changed in reversed(self.changes):
            if place[: len(changed)] == changed:
                return f"{self.path}, --set {shorten(repr(change), SHOWN)}"
            if changed[: len(place)] == place:
                inside = f" with --set {shorten(repr(change), SHOWN)}"
        line = line_of(self.text, place)
        return f"{self.path}, line {line}{inside}" if line else f"{self.path}{inside}"


def key_of(place: Place, tree: object) -> str:
    """Return a place in the form that `--set` uses, such as "budget.response.max".

    tree: the tree of the case. A list entry is identified by the value of its key `name` in this tree. If the entry has
        no name, or another entry has the same name, it is identified by its index.
    """
    parts = []
    for part in place:
        entries = tree
        tree = _child(tree, part)
        name = _child(tree, "name")
        alike = [_child(entry, "name") for entry in entries] if isinstance(entries, list | tuple) else []
        parts.append(name if isinstance(name, str) and alike.count(name) == 1 else str(part))
    return ".".join(parts)


def _child(tree: object, part: str | int) -> object:
    if isinstance(tree, dict):
        return tree.get(part)
    if isinstance(tree, list | tuple) and isinstance(part, int) and part < len(tree):
        return tree[part]
    return None


def line_of(text: str, place: Place) -> int:
    """Return the number of the line with a key.

    If there is none, return the line of the last header of the key's table, or of a table that contains this table.
    Return 0 if the text has neither line.

    text: the text of a TOML file. place: the keys that lead to the key.
    """
    names = [str(part) for part in place if isinstance(part, str)]
    entry = next((part for part in place if isinstance(part, int)), 0)
    best = 0
    header: list[str] = []
    seen: dict[str, int] = {}
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if line.startswith("["):
            title = line.partition("#")[0].strip().strip("[]").strip()
            header = [part.strip().strip("\"'") for part in title.split(".")]
            if line.startswith("[["):
                seen[title] = seen.get(title, -1) + 1
                if seen[title] != entry:
                    header = ["\0"]
            if header[: len(names)] == names:
                return number
            if header == names[: len(header)]:
                best = number
        elif "=" in line and not line.startswith("#"):
            keys = header + [part.strip().strip("\"'") for part in line.partition("=")[0].split(".")]
            if keys == names[: len(keys)]:
                return number
    return best


# BESIDE maps the suffix of a source file to a pattern of the files in the same folder that it may import or include.
BESIDE = {".py": "*.py", ".asm": "*.inc", ".c": "*.h"}
LONGEST = 200  # a text with at least this number of characters is assumed not to be the path of a file


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
    """Yield the files that texts may name, as paths in `folder`, and the files that these files may import or include.

    Every short text is treated as a file name, so the files that a text may name need not exist.
    """
    for text in texts:
        if len(text) >= LONGEST or "\0" in text:
            continue
        file = folder / text
        yield file
        if file.suffix in BESIDE:
            yield from file.parent.glob(BESIDE[file.suffix])
        elif file.is_dir():  # the text may name a folder with C headers
            yield from file.glob("*.h")
