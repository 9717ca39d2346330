"""Bus clear: a controller that finds SDA held low makes up to nine clocks until SDA is released, and then a STOP.

    SCL  ‾‾|___|‾‾‾|___|‾‾‾|___|‾‾‾‾‾‾    a device that lost count in mid-byte releases SDA
    SDA  ______________|‾‾‾|_____|‾‾‾‾    at the latest where it reads a 1 as a NACK
                                STOP

The STOP is also tried if SDA is still low after nine clocks, because an F28335 may then be holding SDA: it took the
fall of SDA for a START, reads the zeros that follow as a general call, and acknowledges in the ninth clock.

Source: UM10204 section 3.1.16.
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.kernel import Kernel
from ...core.state import State
from ...core.wire import Wire

MOST_CLOCKS = 9


class BusClear:
    """Makes bus clears for a controller.

    masks: the controller's masks on the wires SCL and SDA, as in `Wire.pulling`.
    times: the low, high and hold time in ticks, as in `BusTiming`.
    done: called with (clocks, free) after the attempt to make a STOP. clocks: the number of clocks that were made.
        free: True if SDA is high, so that the STOP was made.
    """

    STATE = State("_clocks")

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        masks: tuple[int, int],
        times: tuple[int, int, int],
        done: Callable[[int, bool], None],
    ) -> None:
        self._kernel = kernel
        self._scl, self._sda = scl, sda
        self._scl_mask, self._sda_mask = masks
        self._low, self._high, self._hold = times
        self._done = done
        self._clocks = 0

    def begin(self) -> None:
        """Begin a bus clear. SCL must be high, and the controller must not pull SDA."""
        self._clocks = 0
        self._look()

    def _look(self) -> None:
        """Begin the STOP if SDA is high or MOST_CLOCKS clocks were made; else begin another clock.

        Called at the end of a high phase of SCL. If another party holds SCL low, it is called again later.
        """
        if not self._scl.level:  # another party holds SCL low
            self._kernel.call_at(self._kernel.now + self._high, self._look)
        elif self._sda.level or self._clocks == MOST_CLOCKS:
            self._scl.pull(self._scl_mask, 0)
            self._kernel.call_at(self._kernel.now + self._hold, self._sda_low)
        else:
            self._clocks += 1
            self._scl.pull(self._scl_mask, 0)
            self._kernel.call_at(self._kernel.now + self._low, self._release)

    def _release(self) -> None:
        self._scl.pull(self._scl_mask, 1)
        self._kernel.call_at(self._kernel.now + self._high, self._look)

    def _sda_low(self) -> None:
        self._sda.pull(self._sda_mask, 0)
        self._kernel.call_at(self._kernel.now + self._low - self._hold, self._stop_rises)

    def _stop_rises(self) -> None:
        self._scl.pull(self._scl_mask, 1)
        self._kernel.call_at(self._kernel.now + self._high, self._stop)

    def _stop(self) -> None:
        if not self._scl.level:
            self._kernel.call_at(self._kernel.now + self._high, self._stop)
            return
        self._sda.pull(self._sda_mask, 1)
        self._kernel.call_at(self._kernel.now + self._hold, self._over)

    def _over(self) -> None:
        self._done(self._clocks, self._sda.level == 1)
