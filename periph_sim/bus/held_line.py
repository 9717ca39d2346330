"""A line that a party holds low for a number of ticks, or of falls of SCL."""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.sampler import watch
from ..core.state import State
from ..core.wire import Wire


class HeldLine:
    """A party that can hold one line low.

    ticks: the time for which the line is held, if `clocks` is 0.
    clocks: the number of falls of SCL after which the line is released, or 0.
    who: the name of the party on the wire.
    """

    STATE = State("_left")

    def __init__(self, kernel: Kernel, wire: Wire, scl: Wire | None, who: str, ticks: int, clocks: int) -> None:
        """scl: the wire SCL, or None if `clocks` is 0."""
        self._kernel = kernel
        self._pin = wire.attach(who)
        self._ticks, self._clocks = ticks, clocks
        self._left = 0  # clocks until the line is released
        if clocks:
            assert scl is not None
            watch([scl], self._scl_changed)

    def pull(self) -> None:
        self._pin.drive(0)
        self._left = self._clocks
        if not self._clocks:
            self._kernel.call_at(self._kernel.now + self._ticks, self._let_go)

    def _scl_changed(self, now: int, level: int) -> None:
        if self._left and not level:
            self._left -= 1
            if not self._left:
                self._let_go()

    def _let_go(self) -> None:
        self._pin.drive(1)
