"""What every party of a scene is built with: its case, time and wires."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache

from msgspec import Struct

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.time import Timebase, round_ratio
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
        """Seconds, counted by a clock that is off, in ticks to the nearest."""
        return round_ratio(self.exact_ticks(length, ppm), "nearest")

    def exact_ticks(self, length: Fraction, ppm: Fraction) -> Fraction:
        """The same without rounding."""
        return _exact_ticks(length, ppm, self.timebase.per_second)


@lru_cache(maxsize=1024)  # scenes of one case have the same lengths again and again
def _exact_ticks(length: Fraction, ppm: Fraction, per_second: int) -> Fraction:
    return length * per_second / (1 + ppm / 1_000_000)
