"""Reading of TOML files: the text of a file, and the tree of tables in a text. Mistakes raise BadCase."""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

from ...core.input_files import read_input
from .model import BadCase

_TOO_LONG = re.compile(r"[0-9_]{4300}")  # matches an integer that is too long for Python


def read(path: Path, what: str) -> tuple[str, dict[str, Any]]:
    """Return the text of a TOML file, and its tree of tables. Raise BadCase if the file cannot be read or parsed.

    what: the kind of file, for messages.
    """
    text = text_of(path, what)
    return text, tree_of(path, text)


def text_of(path: Path, what: str) -> str:
    """Return the text of a TOML file. what: the kind of file, for messages. Raise BadCase if the file is not UTF-8."""
    try:
        data = read_input(path)
    except IsADirectoryError:
        raise BadCase(
            f"{path}: is a folder; give a {what} file, or run all its cases: periph-sim check {path}"
        ) from None
    except OSError as error:
        raise BadCase(f"{path}: cannot be read ({error.strerror}); give the path of a {what} file") from None
    try:
        return data.decode("utf-8-sig")  # Notepad begins a file with a byte order mark
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        found = f"byte {data[error.start]:#04x}"
        raise BadCase(
            f"{path}, line {line}: {found} is not UTF-8; a {what} file is TOML, which is UTF-8 text"
        ) from None


def tree_of(path: Path, text: str) -> dict[str, Any]:
    """Return the tree of tables in a TOML text. path: the file, for messages. Raise BadCase for invalid TOML."""
    try:
        return cast(dict[str, Any], copied(_tables(text)))
    except tomllib.TOMLDecodeError as error:
        raise BadCase(f"{path}: it is not TOML: {error}") from None
    except ValueError:
        found = _TOO_LONG.search(text)
        line = 0 if found is None else text.count("\n", 0, found.start()) + 1
        raise BadCase(f"{path}, line {line}: an integer is too long; it must fit 64 bits") from None
    except RecursionError:
        raise BadCase(f"{path}: its tables or lists are nested too deeply; a case has at most five levels") from None


@lru_cache(maxsize=16)
def _tables(text: str) -> dict[str, Any]:
    """Return the tree of tables in a TOML text, from a cache. A caller that changes the tree must copy it first."""
    return tomllib.loads(text)


def copied(value: Any) -> Any:
    """Return a copy of a value in which all tables and lists are copies, so that they may be changed."""
    if isinstance(value, dict):
        return {key: copied(inner) for key, inner in value.items()}
    return [copied(inner) for inner in value] if isinstance(value, list) else value
