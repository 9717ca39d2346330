"""Functions of an image by name and address, with their source lines."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from .debug_info import DebugInfo, SourceLine
from .model import Image


class Function(NamedTuple):
    """address: run address. size: in words. source: line of its first instruction; None if unknown."""

    name: str
    address: int
    size: int
    section: str
    source: SourceLine | None


class FunctionMap:
    """functions: from debug data, and elsewhere from symbols; by section and address."""

    def __init__(self, image: Image) -> None:
        self.debug = DebugInfo(image)
        self.functions = tuple(_functions(image, self.debug))
        self._by_address = sorted(self.functions, key=lambda function: function.address)
        self._starts = [function.address for function in self._by_address]

    def at(self, address: int) -> Function | None:
        """Return the function that contains an address; None if there is none."""
        before = bisect_right(self._starts, address) - 1
        if before >= 0 and address < self._by_address[before].address + self._by_address[before].size:
            return self._by_address[before]
        return None

    def name_at(self, address: int) -> str:
        """Return the name of the function at an address; the address itself if there is none."""
        inside = self.at(address)
        return inside.name if inside else f"{address:#08x}"

    def named(self, name: str) -> Function | None:
        """Return the function of a name; the first one by address if several have it."""
        return next((function for function in self._by_address if function.name == name), None)


def _functions(image: Image, debug: DebugInfo) -> Iterator[Function]:
    for section in image.code:
        told = {function.address: function for function in debug.functions if section.runs_at(function.address)}
        covered = [range(function.address, function.end) for function in told.values()]
        symbols = {
            symbol.address: symbol.name
            for symbol in sorted(image.symbols, key=lambda symbol: (not symbol.external, symbol.name), reverse=True)
            if symbol.section == section.name and not symbol.label and section.runs_at(symbol.address)
        }
        starts = sorted({*told, *(at for at in symbols if not any(at in where for where in covered))})
        for at, after in pairwise([*starts, section.run + section.size]):
            name = told[at].name if at in told else symbols[at]
            end = min(told[at].end, section.run + section.size) if at in told else after
            yield Function(name, at, end - at, section.name, debug.line_at(at))
