"""A place in an image as text: function, source line and address go in; "_serve (imu_hil.asm:77, 0x009051)" comes out.

Recordings keep the text alone; `parsed` gives its parts back. Without debug data it is "_serve+0x11 (0x009051)".
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from .source_location import SourceLocation

TEXT = re.compile(r"(?P<function>.+) \((?:(?P<file>[^()]+):(?P<line>\d+), )?(?P<pc>0x[0-9a-f]{6})\)")


class InstructionLocation(SourceLocation):
    """path, line: "" and 0 without debug data."""

    __slots__ = ()

    def for_people(self) -> str:
        return str(self)


class Parts(NamedTuple):
    """file: its name alone; "" without debug data, `line` then is 0."""

    function: str
    file: str
    line: int
    pc: int


def instruction_location(function: str, begins: int, path: str, line: int, pc: int) -> InstructionLocation:
    """The place of an instruction. function: "" where nobody knows it. begins: where it does."""
    path = path.replace("\\", "/")  # of a compiler that ran on Windows
    if path:
        where = f"{Path(path).name}:{line}, {pc:#08x}"
        text = f"{function} ({where})" if function else where
    elif function:
        text = f"{function}+{pc - begins:#x} ({pc:#08x})"
    else:
        text = f"{pc:#08x}"
    found = InstructionLocation(text)
    found.path, found.line = path, line
    return found


def parsed(text: str) -> Parts | None:
    """What a recorded place says; None if it is no instruction's, or its function is not known."""
    found = TEXT.fullmatch(text)
    if found is None:
        return None
    return Parts(found["function"], found["file"] or "", int(found["line"] or 0), int(found["pc"], 16))


def statement(text: str) -> str:
    """What of a place all instructions of a source line have in common; of any other place all of it."""
    if not text.endswith(")"):
        return text
    found = parsed(text)
    return text if found is None or not found.line else f"{found.function} ({found.file}:{found.line})"
