"""Reading of TOML files: the text of a file, and the tree of tables in a text. Mistakes raise BadCase."""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from pathlib import Path
from shlex import quote
from typing import Any, cast

from ...core.input_files import read_input, similar_file
from ...core.phrases import shorten
from .model import BadCase
from .origin import SHOWN

_PLACE = re.compile(r" \(at (?:line (\d+), column \d+|end of document)\)")
_OPENS = re.compile(r"([^=\[]+=\s*)?[\[{](?!\[)")  # matches the start of a line that begins a list or an inline table
_TABLE = re.compile(r"\[[\w.\s-]+\]\s*(#.*)?$")  # matches the header of a table
BACKSLASH = r"write \\ for a backslash, as in C:\\data"
_NO_POINT = r"[\s.]*[\s,;:/.][\s.]*"
# _HEADER matches a header of several parts. The parts may be separated by blanks, commas, semicolons, colons or slashes
# instead of points.
_HEADER = re.compile(rf"(\[+)([\w-]+(?:{_NO_POINT}[\w-]+)+)(\]+)")
_NO_EQUALS = re.compile(r"([\w.-]+)(?:\s*:\s*|\s+(?![=:])|(?=[\[{\"']))([^=\s].*)")  # a key and a value without =
_PROGRAMS = {".out": "image", ".asm": "image", ".c": "c"}  # maps a suffix to the argument KIND of `periph-sim new`
QUOTES = "'\""
_TOO_LONG = re.compile(r"[0-9_]{4300}")  # matches an integer that is too long for Python


def read(path: Path, what: str) -> tuple[str, dict[str, Any]]:
    """Return the text of a TOML file, and its tree of tables. Raise BadCase if the file cannot be read or parsed.

    what: the kind of file, for messages.
    """
    text = text_of(path, what)
    return text, tree_of(path, text)


def text_of(path: Path, what: str) -> str:
    """Return the text of a TOML file. what: the kind of file, for messages. Raise BadCase if it cannot be read."""
    program = _PROGRAMS.get(path.suffix.lower())
    if program is not None and what == "case" and path.is_file():
        shown = quote(str(path if program == "image" else path.parent))
        raise BadCase(f"{path}: is a program; write its case first: periph-sim new {program} {shown}")
    try:
        data = read_input(path)
    except IsADirectoryError:
        raise BadCase(
            f"{path}: is a folder; give a {what} file, or run all its cases: periph-sim check {path}"
        ) from None
    except OSError as error:
        hint = similar_file(path) or f"give the path of a {what} file"
        raise BadCase(f"{path}: cannot be read ({error.strerror}); {hint}") from None
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
        raise BadCase(f"{path}{_not_toml(text, str(error))}") from None
    except ValueError:
        found = _TOO_LONG.search(text)
        line = 0 if found is None else text.count("\n", 0, found.start()) + 1
        raise BadCase(f"{path}, line {line}: an integer is too long; it must fit 64 bits") from None
    except RecursionError:
        raise BadCase(f"{path}: its tables or lists are nested too deeply; a case has at most five levels") from None


def _not_toml(text: str, error: str) -> str:
    """Return, for messages, the line of a mistake in TOML, what is wrong there, and the fix.

    error: the message of tomllib.
    """
    lines = [line.strip() for line in text.splitlines()] or [""]
    found = _PLACE.search(error)
    number = min(int(found[1] or len(lines)), len(lines)) if found else len(lines)
    what = _PLACE.sub("", error)
    if what.startswith("Cannot"):
        return _given_twice(lines, number)
    if what.startswith("Unclosed"):  # tomllib may name the line of a later header; the list begins above it
        opens = (n for n in range(number, 0, -1) if _OPENS.match(lines[n - 1]) and not _TABLE.match(lines[n - 1]))
        number = next(opens, number)
    if what.startswith("Unescaped"):
        return f", line {number}: it is not TOML: {what} in `{shorten(lines[number - 1], SHOWN)}`; {BACKSLASH}"
    line = lines[number - 1]
    return f", line {number}: it is not TOML: {what} in `{shorten(line, SHOWN)}`; {_fix(line)}"


def _fix(line: str) -> str:
    """Return a phrase that says how to correct a line that is not TOML."""
    if line.startswith("["):
        header = _HEADER.match(line)
        if header:
            return f"write {header[1]}{'.'.join(re.split(_NO_POINT, header[2]))}{header[3]}"
        return "write a header as [table], or as [[table]] for one of several"
    no_equals = _NO_EQUALS.match(line)
    if no_equals:
        line = f"{no_equals[1]} = {no_equals[2]}"
        try:
            tomllib.loads(line)
        except tomllib.TOMLDecodeError:
            return _fix(line)
        return f"write {line}"
    if _OPENS.match(line):
        return "write texts in quotes, a comma between entries, and close the list or table"
    key, equals, value = (part.strip() for part in line.partition("="))
    value = value.partition(" #")[0].strip(" =")
    if not equals:
        return f"write {key} = ..." if re.fullmatch(r"[\w.-]+", key) else "write KEY = VALUE, with texts in quotes"
    if value.lower() in ("true", "false"):
        return f"write {key} = {value.lower()}"
    if re.fullmatch(r"[-+]?0\d+", value):
        return f"write {key} = {int(value)}"
    if re.match(r"[-+]?\d\w*$", value):
        return "write a number, as 12 or 0x0c; texts are in quotes"
    if re.fullmatch(r"[A-Za-z]\w*", value):
        return f'write a number, as 12 or 0x0c, or a text in quotes: {key} = "{value}"'
    return f'write texts, and numbers with a unit, in quotes: {key} = "{value.strip(QUOTES)}"'


def _given_twice(lines: list[str], number: int) -> str:
    """Return the message for a key or table in line `number` that an earlier line has already defined."""
    line = lines[number - 1].partition(" #")[0].strip()
    name = line.partition("=")[0].strip("[] ")
    for n, above in reversed(list(enumerate(lines[: number - 1], 1))):
        if above.startswith("[") and not line.startswith("["):
            break
        if above.partition(" #")[0].strip() == f"[{name}]" != line:
            return f", line {n}: [{name}] is one of several tables, as line {number} says; write [[{name}]]"
        if above.startswith(f"[[{name}]]"):
            return f", line {number}: {line} is one of several tables, as line {n} says; write [[{name}]]"
        if above.partition("=")[0].strip("[] ") == name:
            return f", line {number}: {name} is given already in line {n}; remove one of them"
    return f", line {number}: {name} is given already; remove one of them"


@lru_cache(maxsize=16)
def _tables(text: str) -> dict[str, Any]:
    """Return the tree of tables in a TOML text, from a cache. A caller that changes the tree must copy it first."""
    return tomllib.loads(text)


def copied(value: Any, texts: dict[str, str] | None = None) -> Any:
    """Return a copy of a value in which all tables and lists are copies, so that they may be changed.

    texts: a dictionary from texts to the texts that replace them in the copy.
    """
    if isinstance(value, dict):
        return {key: copied(inner, texts) for key, inner in value.items()}
    if isinstance(value, list):
        return [copied(inner, texts) for inner in value]
    return texts.get(value, value) if texts is not None and isinstance(value, str) else value
