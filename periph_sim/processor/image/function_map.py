"""Functions and source lines of an image by address."""

from __future__ import annotations

from bisect import bisect_right

from ..image_files.debug_info import DebugInfo, SourceLine
from ..image_files.inspection import Function, functions_of
from ..image_files.model import Image


class FunctionMap:
    """functions: in the order of their run addresses."""

    def __init__(self, image: Image) -> None:
        self._debug = DebugInfo(image)
        self.functions = tuple(sorted(functions_of(image, self._debug), key=lambda function: function.address))
        self._starts = [function.address for function in self.functions]

    def at(self, address: int) -> Function | None:
        """Return the function that contains an address; None if there is none."""
        before = bisect_right(self._starts, address) - 1
        if before >= 0 and address < self.functions[before].address + self.functions[before].size:
            return self.functions[before]
        return None

    def name_at(self, address: int) -> str:
        """Return the name of the function at an address; the address itself if there is none."""
        inside = self.at(address)
        return inside.name if inside else f"{address:#08x}"

    def named(self, name: str) -> Function | None:
        """Return the function of a name; the first one by address if several have it."""
        return next((function for function in self.functions if function.name == name), None)

    def line_at(self, address: int) -> SourceLine | None:
        """Return the source line of an instruction; None if unknown."""
        return self._debug.line_at(address)

    @property
    def has_lines(self) -> bool:
        """True if the image has source lines."""
        return bool(self._debug.lines)
