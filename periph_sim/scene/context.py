"""Context in which the parties of a scene are built: case, time and wires."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Literal

from msgspec import Struct

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.time import Timebase, TimeError, round_ratio
from ..core.wire import Wire
from .case.model import Case
from .case.optimizations import ALL
from .case.wiring import Wiring


class CaseTicks(Struct, frozen=True):
    """Converter of the times of a case, which are in seconds, to ticks. start: the tick at which the run begins."""

    case: Case
    timebase: Timebase
    start: int

    def optimizes(self, name: str) -> bool:
        """Return True if the optimization `name` (see `case.optimizations`) is on."""
        return ALL not in self.case.disable and name not in self.case.disable

    def ticks(self, length: Fraction, ppm: Fraction = Fraction(0)) -> int:
        """Return a length in seconds as the nearest number of ticks.

        ppm: the error of the clock that counts the length, in parts per million; positive for a fast clock.

        If the number of ticks is too large, raise BadCase, which names the key of the case with this length. If no key
        has this length, raise TimeError.
        """
        return self._fitting(round_ratio(self._exact(length, ppm), "nearest"), length)

    def starts(self, name: Literal["rounds", "frames"]) -> tuple[int, ...] | None:
        """Return the ticks of the starts in the list `name` of [inputs]; None if [inputs] has no such list."""
        inputs = self.case.inputs
        times = None if inputs is None else getattr(inputs, name)
        return None if times is None else tuple(self.start + self.ticks(time) for time in times)

    def serial_tick(self, at: Fraction, ppm: Fraction) -> int:
        """Return the tick of a time `at` of [serial], delayed by `sends_later` of [inputs]. ppm: as for `ticks`."""
        inputs = self.case.inputs
        return self.start + self.ticks(at, ppm) + (0 if inputs is None else self.ticks(inputs.sends_later))

    def exact_ticks(self, length: Fraction, ppm: Fraction) -> Fraction:
        """Return the exact number of ticks of a length in seconds. ppm: as for `ticks`.

        Raise the same errors as `ticks`.
        """
        exact = self._exact(length, ppm)
        self._fitting(int(exact), length)
        return exact

    def _fitting(self, ticks: int, length: Fraction) -> int:
        try:
            return self.timebase.fitting(ticks)
        except TimeError as error:
            place = next(_places(self.case, length), None)
            if place is None:  # the length is a sum of times, so no key of the case has this value
                raise
            raise self.case.mistake(str(error), *place) from None

    def _exact(self, length: Fraction, ppm: Fraction) -> Fraction:
        return length * self.timebase.per_second / (1 + ppm / 1_000_000)


class SceneContext(CaseTicks, frozen=True):
    """The context that each builder of a scene's parts receives.

    wire: a function that returns the wire with a given name. If there is no such wire yet, it is created.
    wiring: the names of the wires at each unit's pins.
    """

    kernel: Kernel
    recorder: Recorder
    wire: Callable[[str], Wire]
    wiring: Wiring


def _places(table: object, length: Fraction) -> Iterator[tuple[str | int, ...]]:
    """Yield, for each value in the tables of a case that equals `length`, the keys that lead to this value."""
    children: list[tuple[str | int, object]] = []
    if isinstance(table, Struct):
        children = [(name, getattr(table, name)) for name in table.__struct_fields__ if not name.startswith("_")]
    elif isinstance(table, dict):
        children = [*table.items()]
    elif isinstance(table, tuple):
        children = [*enumerate(table)]
    for key, child in children:
        if isinstance(child, Fraction) and child == length:
            yield (key,)
        else:
            yield from ((key, *place) for place in _places(child, length))


class SceneWires(dict[str, Wire]):
    """The wires of a scene by name. `wire` makes a wire at its first use, so a scene has only the wires it needs."""

    def __init__(self, kernel: Kernel, recorder: Recorder) -> None:
        self._kernel = kernel
        self._recorder = recorder

    def wire(self, name: str) -> Wire:
        if name not in self:
            self[name] = self.made(self._kernel, name, self._recorder)
        return self[name]

    def made(self, kernel: Kernel, name: str, recorder: Recorder) -> Wire:
        """Return a new wire. A subclass can return another kind of wire."""
        return Wire(kernel, name, recorder)
