"""Conversion between SYSCLKOUT cycles and times that are counted in OSCCLK periods, while their ratio may change.

    retune  :  sets the ratio of OSCCLK to SYSCLKOUT from a cycle on
    at      :  SYSCLKOUT cycle  -->  OSCCLK position
    cycle_at:  OSCCLK position  -->  SYSCLKOUT cycle

The watchdog and the PLL's lock counter run on OSCCLK, but every input of a chip has a SYSCLKOUT cycle. An OSCCLK
position is the time since cycle 0, counted in parts of an OSCCLK period. The parts are so small that a SYSCLKOUT cycle
is a whole number of parts for every ratio of the PLL. So positions are exact. Only the cycle at which the effect of an
event becomes visible is rounded up.
"""

from __future__ import annotations

from ...core.state import State

PARTS = 2520  # parts of one OSCCLK period: the least common multiple of the PLL's ratios, 1 to 10


class OscClock:
    """Converter between cycles and positions. It starts at cycle 0 with SYSCLKOUT = OSCCLK/4, as after a reset."""

    STATE = State("_position _step", cycles="_cycle")

    def __init__(self) -> None:
        self._cycle = 0  # cycle of the last change of the ratio
        self._position = 0
        self._step = 4 * PARTS  # parts per SYSCLKOUT cycle

    def at(self, cycle: int) -> int:
        """Return the time at which a cycle begins, as an OSCCLK position: in 1 / PARTS of an OSCCLK period.

        cycle: a SYSCLKOUT cycle at or after the last `retune`.
        """
        return self._position + (cycle - self._cycle) * self._step

    def cycle_at(self, position: int) -> int:
        """Return the first cycle that begins at or after a position, if the ratio does not change before it."""
        return self._cycle - (self._position - position) // self._step

    def retune(self, cycle: int, numerator: int, denominator: int) -> None:
        """Set SYSCLKOUT = OSCCLK * numerator / denominator from `cycle` on. numerator: 1 to 10, as in PLLCR."""
        self._position = self.at(cycle)
        self._cycle = cycle
        self._step = PARTS * denominator // numerator
