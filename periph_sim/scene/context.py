"""What every party of a scene is built with: its case, time and wires."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from msgspec import Struct

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.time import Timebase
from ..core.wire import Wire
from .case.fidelity import BusLevels
from .case.model import Case
from .case.wiring import Wiring


class SceneContext(Struct, frozen=True):
    """wire: the wire of a name, made when it is asked for first. wiring: the names of the wires on each unit's pins.

    start: the tick at which the run begins. levels: how each bus is simulated.
    """

    case: Case
    kernel: Kernel
    recorder: Recorder
    timebase: Timebase
    wire: Callable[[str], Wire]
    wiring: Wiring
    start: int
    levels: BusLevels

    def ticks(self, length: Fraction, ppm: Fraction = Fraction(0)) -> int:
        """Return a length in seconds, counted by a clock that is off by `ppm`, in ticks to the nearest.

        TimeError if it is too long for the ticks of this scene.
        """
        count, parts = self._ticks(length, ppm)
        return self.timebase.fitting((2 * count + parts) // (2 * parts))

    def exact_ticks(self, length: Fraction, ppm: Fraction) -> Fraction:
        """Return the same without rounding."""
        exact = Fraction(*self._ticks(length, ppm))
        self.timebase.fitting(int(exact))
        return exact

    def _ticks(self, length: Fraction, ppm: Fraction) -> tuple[int, int]:
        """The same as a count of parts of a tick, and how many of these a tick has."""
        clock = 1_000_000 * ppm.denominator
        return length.numerator * self.timebase.per_second * clock, length.denominator * (clock + ppm.numerator)
