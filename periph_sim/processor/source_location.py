"""Locations in firmware as text: "function:line" in Python, "_serve (imu_hil.asm:77, 0x009051)" in an image.

A record of a running scene, unlike one from a file, has the path, too. `parsed` returns the parts of an image's
location; without debug data it is "_serve+0x11 (0x009051)".
"""

# core: compiled

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import NamedTuple, final

from .. import __file__ as package_file
from ..form.c_types import Text

PACKAGE = f"{Path(package_file).parent}{os.sep}"  # no location in the firmware is in here,
COMPILED = "periph_sim/"  # nor in here: file names of compiled modules in tracebacks
FIRMWARE_ROOMS = (  # exceptions
    f"{PACKAGE}firmware{os.sep}",  # start-up code that firmware imports
    f"{PACKAGE}examples{os.sep}",  # shipped programs, here in a wheel
)
STDLIB = f"{Path(os.__file__).parent}{os.sep}"  # not firmware either; our own calls pass through it
INSTALLED = f"{STDLIB}site-packages{os.sep}"  # which may hold firmware


class SourceLocation(str):
    """ "function:line". path: of the file. line: counted from 1."""

    __slots__ = ("line", "path")

    path: str
    line: int

    def for_people(self) -> str:
        return f"line {self.line} of {Path(self.path).name}"


@final
class SourceLocator:
    """The source locations of one program, each made once."""

    def __init__(self) -> None:
        self._known: dict[tuple[CodeType, int], SourceLocation] = {}
        self._places: dict[int, dict[int, SourceLocation] | None] = {}  # by code, by instruction; None: not firmware
        self._codes: list[CodeType] = []  # the keys of `_places`, kept so that their ids stay unique

    def of_frame(self, frame: FrameType | None) -> SourceLocation | None:
        """Return the location of the innermost frame of firmware from this one outwards; None if there is none."""
        while frame is not None:
            code = frame.f_code
            try:
                places = self._places[id(code)]  # hashing the code itself would take most of the time here
            except KeyError:  # seen for the first time
                self._codes.append(code)
                places = self._places[id(code)] = {} if is_firmware(code.co_filename) else None
            if places is not None:
                place = places.get(frame.f_lasti)
                if place is None:
                    place = places[frame.f_lasti] = self._place(code, frame.f_lineno)
                return place
            frame = frame.f_back
        return None

    def of_line(self, code: CodeType, line: int) -> SourceLocation | None:
        """Return a line of a code; None if that is not firmware."""
        return self._place(code, line) if is_firmware(code.co_filename) else None

    def of_routine(self, routine: Callable[[], None]) -> SourceLocation | None:
        """Return the first line of a routine; None if it is not written in Python."""
        code = getattr(routine, "__code__", None)
        return self._place(code, code.co_firstlineno) if isinstance(code, CodeType) else None

    def _place(self, code: CodeType, line: int) -> SourceLocation:
        place = self._known.get((code, line))
        if place is None:
            place = self._known[code, line] = SourceLocation(f"{code.co_name}:{line}")
            place.path, place.line = code.co_filename, line
        return place


def is_ours(file: str) -> bool:
    """Return True if this file belongs to the simulation, and not to firmware."""
    return file.startswith((PACKAGE, COMPILED)) and not file.startswith(FIRMWARE_ROOMS)


def is_helper(file: str) -> bool:
    """Return True for the start-up code that firmware imports, such as `start_i2c`."""
    return file.startswith(FIRMWARE_ROOMS[0])


def is_firmware(file: str) -> bool:
    """Return True if code of this file is neither ours nor Python's own."""
    if is_ours(file) or file.startswith("<frozen "):
        return False
    return not file.startswith(STDLIB) or file.startswith(INSTALLED)


TEXT = re.compile(r"(?P<function>.+) \((?:(?P<file>[^()]+):(?P<line>\d+), )?(?P<pc>0x[0-9a-f]{6})\)")


class InstructionLocation(SourceLocation):
    """Location of an instruction of an image. path, line: "" and 0 without debug data."""

    __slots__ = ()

    def for_people(self) -> str:
        return str(self)


class Parts(NamedTuple):
    """The parts of a location. file: the name without the folder; "" without debug data, and `line` is then 0."""

    function: str
    file: str
    line: int
    pc: int


def instruction_location(function: Text, begins: int, path: Text, line: int, pc: int) -> InstructionLocation:
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


def parsed(text: Text) -> Parts | None:
    """Return the parts of a recorded location; None if it is not an instruction's, or the function is unknown."""
    found = TEXT.fullmatch(text)
    if found is None:
        return None
    return Parts(found["function"], found["file"] or "", int(found["line"] or 0), int(found["pc"], 16))


def statement(text: Text) -> Text:
    """Return the part of a location that all instructions of a source line share; any other location unchanged."""
    if not text.endswith(")"):
        return text
    found = parsed(text)
    return text if found is None or not found.line else f"{found.function} ({found.file}:{found.line})"
