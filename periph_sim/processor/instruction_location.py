"""Location in an image as text: function, source line and address, "_serve (imu_hil.asm:77, 0x009051)".

Recordings keep the text alone; `parsed` returns its parts. Without debug data it is "_serve+0x11 (0x009051)".
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
    """file: name without folder; "" without debug data, `line` is then 0."""

    function: str
    file: str
    line: int
    pc: int


def instruction_location(function: str, begins: int, path: str, line: int, pc: int) -> InstructionLocation:
    """Return the location of an instruction. function: "" if unknown. begins: its first address."""
    path = path.replace("\\", "/")  # the compiler may have run on Windows
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
    """Return the parts of a recorded location; None if it is not an instruction's, or the function is unknown."""
    found = TEXT.fullmatch(text)
    if found is None:
        return None
    return Parts(found["function"], found["file"] or "", int(found["line"] or 0), int(found["pc"], 16))


def statement(text: str) -> str:
    """Return the part of a location that all instructions of a source line share; any other location unchanged."""
    if not text.endswith(")"):
        return text
    found = parsed(text)
    return text if found is None or not found.line else f"{found.function} ({found.file}:{found.line})"
