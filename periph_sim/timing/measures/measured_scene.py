"""Questions that a measure may ask a scene, in addition to the records that it subscribes to."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ...core.wire import Wire
    from ...devices.watchers import WireWatcher
    from .expectations import Expected, Reply, WatchedWire


class Delay(Protocol):
    def ticks(self, written: int) -> int:
        """Return the delay of a write at this tick, with the present settings."""


class MeasuredScene(Protocol):
    """The questions that a scene answers."""

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        """Subscribe `reply`. Return the expected reply, and a function that returns why it was never requested."""

    def watcher(self, measure: WatchedWire) -> WireWatcher:
        """Return the watcher of the wire that the measure is named for, which gives its findings to the measure."""

    def rounds_at_start(self) -> Callable[[], bool]:
        """Return a function that says, at a START that is no repeated one, whether it begins a round."""

    def began(self) -> int:
        """Return the tick at which the run begins."""

    def wire(self, name: str) -> Wire: ...

    def level_of(self, wire: str) -> int:
        """Return the level of a wire now."""

    def value_of(self, place: str, name: str) -> int:
        """Return what a field holds now: of "dsp.I2C-A" that of "I2CSTR.XRDY"."""

    def ticks_per_second(self) -> int: ...

    def clock_history(self, unit: str) -> list[tuple[int, Fraction]]:
        """Return a unit's SYSCLKOUT in Hz from each tick on, up to now; of the first unit where none is named."""

    def i2c_release_delay(self, unit: str) -> Delay:
        """Return the delay from a write of I2CDXR that SCL is held for to its release."""
