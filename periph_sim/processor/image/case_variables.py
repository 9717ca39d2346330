"""Variables of an image that a case names: their initial values, and records of their changes.

Initial values are stored when the image is loaded, and again when `main` is entered, since C start-up code sets
initialised variables before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock
from ...f28335.memory.ram import MEMORY, Ram
from ..image_files.variables import Variable
from .observers import CallListener


class VariableRecords:
    """FLAG records of `UNIT.memory` for each change of a variable.

    addresses: variables by the address of each of their words.
    """

    STATE = State("_values")

    def __init__(
        self,
        variables: Iterable[Variable],
        ram: Ram,
        recorder: Recorder,
        clock: Clock,
        unit: str,
        place: Callable[[], str | None],
    ) -> None:
        """place: returns the place of the instruction that writes."""
        self._place = place
        self.addresses: dict[int, list[Variable]] = {}
        self._ram, self._recorder, self._clock = ram, recorder, clock
        self._where = f"{unit}.{MEMORY}"
        self._values: dict[str, int] = {}
        for variable in variables:
            for address in range(variable.address, variable.address + variable.words):
                self.addresses.setdefault(address, []).append(variable)

    def begin(self) -> None:
        """Read the initial values after the image has been loaded."""
        for variables in self.addresses.values():
            for variable in variables:
                self._values[variable.name] = self._value(variable)

    def value(self, name: str) -> int:
        """Return the value of a variable."""
        return self._values[name]

    def written(self, address: int, cycle: int) -> None:
        """Record the variables in a word at one of `addresses` that have changed."""
        for variable in self.addresses[address]:
            value = self._value(variable)
            if value != self._values[variable.name]:
                self._values[variable.name] = value
                self._recorder.emit(
                    self._clock.tick(cycle), Kind.FLAG, self._where, variable.name, value, self._place() or ""
                )

    def _value(self, variable: Variable) -> int:
        if variable.words == 1:
            return variable.value_of(self._ram.word(variable.address))
        return variable.value_of(self._ram.word32(variable.address & ~1))


MAIN = ("main", "_main")


class PresetMemory(CallListener):
    """Initial values that a case sets for variables. They are stored before the start and again as main begins."""

    STATE = State()

    __slots__ = ("_presets", "_put")

    def __init__(self, presets: Iterable[tuple[Variable, int]], put: Callable[[int, int], None]) -> None:
        self._presets = tuple(presets)
        self._put = put

    def put(self) -> None:
        """Store all values word by word, the low word of each variable first."""
        for variable, bits in self._presets:
            for word in range(variable.words):
                self._put(variable.address + word, bits >> 16 * word & 0xFFFF)

    def called(self, name: str, tick: int) -> None:
        if name in MAIN:
            self.put()

    def returned(self, name: str, tick: int) -> None:
        pass
