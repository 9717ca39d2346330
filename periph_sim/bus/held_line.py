"""A line that a party holds low: for so many ticks, or until SCL has fallen so often."""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.wire import Wire


class HeldLine:
    """ticks: how long; clocks: falls of SCL instead, where there are any. who: the party's name on the wire."""

    def __init__(self, kernel: Kernel, wire: Wire, scl: Wire | None, who: str, ticks: int, clocks: int) -> None:
        """scl: needed where clocks count."""
        self._kernel = kernel
        self._pin = wire.attach(who)
        self._ticks, self._clocks = ticks, clocks
        self._left = 0  # clocks until the line is let go
        if clocks:
            assert scl is not None
            scl.watch(self._scl_changed)

    def pull(self) -> None:
        self._pin.drive(0)
        self._left = self._clocks
        if not self._clocks:
            self._kernel.at(self._kernel.now + self._ticks, self._let_go)

    def _scl_changed(self, now: int, level: int) -> None:
        if self._left and not level:
            self._left -= 1
            if not self._left:
                self._let_go()

    def _let_go(self) -> None:
        self._pin.drive(1)
