"""Locations in firmware as text: "function:line" in Python, "_serve (imu_hil.asm:77, 0x009051)" in an image.

Without debug data, a location in an image is "_serve+0x11 (0x009051)". In a running scene, a location also has the path
of the file. In a recording, a location is only the text; `parsed` returns the parts of the text.
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

PACKAGE = f"{Path(package_file).parent}{os.sep}"  # files in this folder belong to the simulation
COMPILED = "periph_sim/"  # file names of compiled modules in tracebacks begin with this text
FIRMWARE_ROOMS = (  # folders in PACKAGE with firmware
    f"{PACKAGE}firmware{os.sep}",  # start-up code that firmware imports
    f"{PACKAGE}examples{os.sep}",  # shipped programs, which an installed package has here
)
STDLIB = f"{Path(os.__file__).parent}{os.sep}"  # files in this folder, except in INSTALLED, are not firmware
INSTALLED = f"{STDLIB}site-packages{os.sep}"  # installed packages in STDLIB, which may be firmware


class SourceLocation(str):
    """A location as text, "function:line". path: the path of the file. line: the number of the line, from 1 on."""

    __slots__ = ("line", "path")

    path: str
    line: int

    def for_people(self) -> str:
        return f"line {self.line} of {Path(self.path).name}"


@final
class SourceLocator:
    """The source locations of one program. Each location is made once."""

    def __init__(self) -> None:
        self._known: dict[tuple[CodeType, int], SourceLocation] = {}
        # Maps the id of a code object to its locations by index of the instruction; None if the code is not firmware.
        self._places: dict[int, dict[int, SourceLocation] | None] = {}
        self._codes: list[CodeType] = []  # the code objects in `_places`; these references keep their ids unique

    def of_frame(self, frame: FrameType | None) -> SourceLocation | None:
        """Return the location of the first firmware frame among this frame and its callers; None if there is none."""
        while frame is not None:
            code = frame.f_code
            try:
                places = self._places[id(code)]  # the id is the key, because hashing a code object is slow
            except KeyError:  # this code object is new
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
        """Return the location of a line of a code object; None if the code is not firmware."""
        return self._place(code, line) if is_firmware(code.co_filename) else None

    def of_routine(self, routine: Callable[[], None]) -> SourceLocation | None:
        """Return the location of the first line of a routine; None if the routine is not written in Python."""
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
    """Return True if this file has start-up code that firmware imports, such as `start_i2c`."""
    return file.startswith(FIRMWARE_ROOMS[0])


def is_firmware(file: str) -> bool:
    """Return True if a file belongs neither to the simulation nor to Python itself."""
    if is_ours(file) or file.startswith("<frozen "):
        return False
    return not file.startswith(STDLIB) or file.startswith(INSTALLED)


TEXT = re.compile(r"(?P<function>.+) \((?:(?P<file>[^()]+):(?P<line>\d+), )?(?P<pc>0x[0-9a-f]{6})\)")


class InstructionLocation(SourceLocation):
    """Location of an instruction of an image. Without debug data, `path` is "" and `line` is 0."""

    __slots__ = ()

    def for_people(self) -> str:
        return str(self)


class Parts(NamedTuple):
    """The parts of the location of an instruction.

    function: the name of the function; without debug data, "NAME+OFFSET".
    file, line: the name of the file without its folder, and the line; "" and 0 without debug data.
    pc: the address of the instruction.
    """

    function: str
    file: str
    line: int
    pc: int


def instruction_location(function: Text, begins: int, path: Text, line: int, pc: int) -> InstructionLocation:
    """Return the location of an instruction.

    function, begins: the name and the first address of its function; the name is "" if it is unknown.
    path, line: the source line; "" and 0 without debug data.
    pc: the address of the instruction.
    """
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
    """Return the parts of the text of an instruction's location.

    Return None for other locations, and if the function is unknown.
    """
    found = TEXT.fullmatch(text)
    if found is None:
        return None
    return Parts(found["function"], found["file"] or "", int(found["line"] or 0), int(found["pc"], 16))


def statement(text: Text) -> Text:
    """Return a location without the address, which differs between the instructions of a source line.

    A location without a source line, or without a function, is returned unchanged.
    """
    if not text.endswith(")"):
        return text
    found = parsed(text)
    return text if found is None or not found.line else f"{found.function} ({found.file}:{found.line})"
