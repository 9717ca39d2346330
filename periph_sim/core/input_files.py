"""Files that a command has read: each reader names its file here, so that no output of the same command replaces it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_read: set[tuple[int, int]] | None = None  # device and inode of each file; None while no command runs


@contextmanager
def inputs_of_one_command() -> Iterator[None]:
    """Remember the files that are noted in this block, and forget them at its end. A block inside it shares them."""
    global _read
    outermost = _read is None
    if outermost:
        _read = set()
    try:
        yield
    finally:
        if outermost:
            _read = None


def note_input(path: Path) -> Path:
    """Remember a file as input of the command that runs, and return its path. Without a command nothing is done."""
    if _read is not None and (identity := _identity(path)) is not None:
        _read.add(identity)
    return path


def is_input(path: Path) -> bool:
    """True if the command that runs has read this file, by whatever name or link."""
    return bool(_read) and _identity(path) in (_read or ())


def _identity(path: Path) -> tuple[int, int] | None:
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino
