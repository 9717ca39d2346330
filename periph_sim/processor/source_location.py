"""A place in the firmware: a frame of a running program, or a routine, goes in; "function:line" and file come out.

Records show it as text. Who has the record of a running scene, and not of a file, can ask for the file, too.
"""

# core: compiled

from __future__ import annotations

import os
import sysconfig
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import final

from .. import __file__ as package_file

PACKAGE = f"{Path(package_file).parent}{os.sep}"  # what a place in the firmware is never in,
COMPILED = "periph_sim/"  # nor in this: so the frames of a traceback name the files of compiled modules
FIRMWARE_ROOMS = (  # but for
    f"{PACKAGE}firmware{os.sep}",  # the start-up code that firmware imports,
    f"{PACKAGE}examples{os.sep}",  # and the shipped programs, which a wheel has here
)
STDLIB = f"{sysconfig.get_path('stdlib')}{os.sep}"  # nor in this, which our own calls go through
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
    """The places that one program was seen at, each made once."""

    def __init__(self) -> None:
        self._known: dict[tuple[CodeType, int], SourceLocation] = {}
        self._places: dict[int, dict[int, SourceLocation] | None] = {}  # by code, by instruction; None: no firmware
        self._codes: list[CodeType] = []  # which those are: their ids last as long as they do

    def of_frame(self, frame: FrameType | None) -> SourceLocation | None:
        """The innermost frame of firmware from this one outwards; None if there is none."""
        while frame is not None:
            code = frame.f_code
            try:
                places = self._places[id(code)]  # a code's own hash takes longer than all else here
            except KeyError:
                places = self._of_code(code)
            if places is not None:
                place = places.get(frame.f_lasti)
                if place is None:
                    place = places[frame.f_lasti] = self._place(code, frame.f_lineno)
                return place
            frame = frame.f_back
        return None

    def _of_code(self, code: CodeType) -> dict[int, SourceLocation] | None:
        """Where a code seen for the first time is to have its places."""
        self._codes.append(code)
        places = self._places[id(code)] = {} if is_firmware(code.co_filename) else None
        return places

    def of_line(self, code: CodeType, line: int) -> SourceLocation | None:
        """A line of a code; None if that is no firmware."""
        return self._place(code, line) if is_firmware(code.co_filename) else None

    def of(self, routine: Callable[[], None]) -> SourceLocation | None:
        """Where a routine begins; None if it is not written in Python."""
        code = getattr(routine, "__code__", None)
        return self._place(code, code.co_firstlineno) if isinstance(code, CodeType) else None

    def _place(self, code: CodeType, line: int) -> SourceLocation:
        place = self._known.get((code, line))
        if place is None:
            place = self._known[code, line] = SourceLocation(f"{code.co_name}:{line}")
            place.path, place.line = code.co_filename, line
        return place


def is_ours(file: str) -> bool:
    """True if this file belongs to the simulation, and not to firmware."""
    return file.startswith((PACKAGE, COMPILED)) and not file.startswith(FIRMWARE_ROOMS)


def is_helper(file: str) -> bool:
    """True for the start-up code that firmware imports, such as `start_i2c`."""
    return file.startswith(FIRMWARE_ROOMS[0])


def is_firmware(file: str) -> bool:
    """True if code of this file is neither ours nor Python's own."""
    if is_ours(file) or file.startswith("<frozen "):
        return False
    return not file.startswith(STDLIB) or file.startswith(INSTALLED)
