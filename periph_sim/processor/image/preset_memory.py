"""Initial values of variables that a case sets by symbol.

They are stored when the image is loaded, and again when `main` is entered, since C start-up code sets initialised
variables before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from msgspec import Struct

from ...core.state import State
from ..image_files.variables import Variable
from .call_stack import CallListener

MAIN = ("main", "_main")


class Preset(Struct, frozen=True):
    """bits: the words of the variable in memory, low one first."""

    variable: Variable
    bits: int


class PresetMemory(CallListener):
    STATE = State()

    __slots__ = ("_presets", "_put")

    def __init__(self, presets: Iterable[Preset], put: Callable[[int, int], None]) -> None:
        self._presets = tuple(presets)
        self._put = put

    def put(self) -> None:
        """Store all values, word by word."""
        for preset in self._presets:
            for word in range(preset.variable.words):
                self._put(preset.variable.address + word, preset.bits >> 16 * word & 0xFFFF)

    def called(self, name: str, tick: int) -> None:
        if name in MAIN:
            self.put()

    def returned(self, name: str, tick: int) -> None:
        pass
