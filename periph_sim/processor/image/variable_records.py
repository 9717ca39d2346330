"""Variables of an image as they change: writes to memory go in; FLAG records of `UNIT.memory` come out.

Only variables that somebody names are looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock
from ...f28335.system.ram import MEMORY, Ram
from ...image.variables import Variable


class VariableRecords:
    """addresses: of the words that they are in."""

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
        """place: of the instruction that writes."""
        self._place = place
        self.addresses: dict[int, list[Variable]] = {}
        self._ram, self._recorder, self._clock = ram, recorder, clock
        self._where = f"{unit}.{MEMORY}"
        self._values: dict[str, int] = {}
        for variable in variables:
            for address in range(variable.address, variable.address + variable.words):
                self.addresses.setdefault(address, []).append(variable)

    def begin(self) -> None:
        """The image has been loaded: what is there now are the values from which they change."""
        for variables in self.addresses.values():
            for variable in variables:
                self._values[variable.name] = self._value(variable)

    def value(self, name: str) -> int:
        """What a variable holds."""
        return self._values[name]

    def written(self, address: int, cycle: int) -> None:
        """A word at one of `addresses` may have changed."""
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
