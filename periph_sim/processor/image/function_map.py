"""Which function an address is in: an image goes in; the function of any address comes out, and its source line."""

from __future__ import annotations

from bisect import bisect_right

from ...image.debug_info import DebugInfo, SourceLine
from ...image.inspection import Function, functions_of
from ...image.model import Image


class FunctionMap:
    """functions: by address, where they run."""

    def __init__(self, image: Image) -> None:
        self._debug = DebugInfo(image)
        self.functions = tuple(sorted(functions_of(image, self._debug), key=lambda function: function.address))
        self._starts = [function.address for function in self.functions]

    def at(self, address: int) -> Function | None:
        """The function that an address is in; None where there is none."""
        before = bisect_right(self._starts, address) - 1
        if before >= 0 and address < self.functions[before].address + self.functions[before].size:
            return self.functions[before]
        return None

    def name_at(self, address: int) -> str:
        """Its name; the address itself where there is none."""
        inside = self.at(address)
        return inside.name if inside else f"{address:#08x}"

    def named(self, name: str) -> Function | None:
        """The function of a name; the first one by address where several have it."""
        return next((function for function in self.functions if function.name == name), None)

    def line_at(self, address: int) -> SourceLine | None:
        """The source line of an instruction; None where nothing tells it."""
        return self._debug.line_at(address)

    @property
    def has_lines(self) -> bool:
        """The image tells lines of its source."""
        return bool(self._debug.lines)
