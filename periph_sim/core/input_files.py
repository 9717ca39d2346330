"""Input files that users name: opening them without blocking, and not replacing them with an output.

A command remembers the files that it reads. Its outputs call `is_input` before they replace a file.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from .phrases import nearest

NOTED = "periph_sim.input"  # name of the audit event for an input file, even if only a compiler reads the file
TEMPORARY = "periph_sim_compiled_"  # how the names of temporary folders begin; files in these folders are no inputs
MOST = 1 << 24  # maximum size, in bytes, of a file that is read as a whole

_read: set[tuple[int, int]] | None = None  # device and inode of each file; None while no command runs


@contextmanager
def inputs_of_one_command() -> Iterator[None]:
    """Remember the files that are noted in this block. The files are forgotten when the outermost block ends."""
    global _read
    outermost = _read is None
    if outermost:
        _read = set()
    try:
        yield
    finally:
        if outermost:
            _read = None


def similar_file(path: Path) -> str:
    """Return a phrase that suggests existing paths similar to the missing `path`; "" if there is none to suggest."""
    try:
        near = _similar_paths(path)
    except (OSError, ValueError):
        near = []
    return f"did you mean {' or '.join(map(str, near))}?" if near else ""


def _similar_paths(path: Path) -> list[Path]:
    """Return the existing paths that resemble `path`.

    If the folder of `path` exists, these are files in it with a similar name. Otherwise they are files with the same
    name in a similar folder.
    """
    if path.exists() or path == path.parent:
        return []
    if not path.parent.exists():
        return [folder / path.name for folder in _similar_paths(path.parent) if (folder / path.name).exists()]
    # Two names with the same suffix must also resemble each other without the suffix. A broken link is in the listing
    # although `path` does not exist, so `path` itself is excluded.
    return [
        path.parent / name
        for name in nearest(path.name, os.listdir(path.parent))
        if name != path.name and (Path(name).suffix != path.suffix or nearest(path.stem, [Path(name).stem]))
    ]


def open_regular(path: Path, most: int | None = None) -> BinaryIO:
    """Open a file for reading.

    Raise OSError if it cannot be opened, if it is no regular file (a device or a pipe might never end), or if it has
    more than `most` bytes.
    """
    try:
        status = os.stat(path)
    except ValueError:
        raise _refused(path, "Not a file name") from None
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        raise _refused(path, "Not a regular file")
    if most is not None and status.st_size > most:
        raise _refused(path, f"Longer than {most} bytes")
    return path.open("rb")


def open_input(path: Path, most: int | None = None) -> BinaryIO:
    """Open a file as `open_regular` does, and note it as input of the command that runs."""
    return open_regular(note_input(path), most)


def read_regular(path: Path, most: int = MOST) -> bytes:
    """Return the bytes of a file. Raise OSError as `open_regular` does."""
    with open_regular(path, most) as file:
        data = file.read(most + 1)
    if len(data) > most:  # the file has grown, or the system does not know the file's size, as in /proc
        raise _refused(path, f"Longer than {most} bytes")
    return data


def read_input(path: Path, most: int = MOST) -> bytes:
    """Return the bytes of a file as `read_regular` does, and note it as input of the command that runs."""
    return read_regular(note_input(path), most)


def note_input(path: Path) -> Path:
    """Remember a file as input of the command that runs, and return its path. If no command runs, only return it."""
    note_inputs_of((path,))
    return path


def note_inputs_of(paths: Iterable[Path]) -> None:
    """Remember these files as inputs of the command that runs. Files that do not exist are ignored.

    Each path is also announced to Python's audit hooks, as the event NOTED. If no command runs, nothing is done.
    """
    if _read is None:
        return
    for path in paths:
        sys.audit(NOTED, str(path))
        identity = _identity(path)
        if identity is not None:
            _read.add(identity)


def is_input(path: Path) -> bool:
    """Return True if the command that runs has read this file, or if Python has imported it, under any name or link."""
    identity = _identity(path)
    if identity is None:
        return False
    return identity in (_read or ()) or any(_identity(file) == identity for file in _imported())


def is_same_file(path: Path, other: Path) -> bool:
    """Return True if both paths refer to the same existing file."""
    identity = _identity(path)
    return identity is not None and identity == _identity(other)


def _imported() -> Iterator[str]:
    for module in tuple(sys.modules.values()):
        file = getattr(module, "__dict__", {}).get("__file__")
        if isinstance(file, str):
            yield file


def _identity(path: Path | str) -> tuple[int, int] | None:
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino


def _refused(path: Path, why: str) -> OSError:
    return OSError(errno.EINVAL, why, str(path))
