"""OSCCLK counted from a clock that is derived from it and changes: SYSCLKOUT cycles in, OSCCLK positions out.

    retune  -->  cycles per OSCCLK, from now on
    at      :  SYSCLKOUT cycle  -->  OSCCLK position
    cycle_at:  OSCCLK position  -->  SYSCLKOUT cycle

The watchdog and the PLL's lock counter run on OSCCLK while every input of a chip comes
with a SYSCLKOUT cycle. A position is counted in parts of an OSCCLK period so small that
each SYSCLKOUT the PLL can make is a whole number of them: nothing is ever rounded
but the answer to "in which cycle does this become visible".
"""

from __future__ import annotations

from ...core.state import State

PARTS = 2520  # of one OSCCLK period; the least number that 1 to 10, the PLL's ratios, all divide


class OscClock:
    """Starts at cycle 0 with SYSCLKOUT = OSCCLK/4, as after a reset."""

    STATE = State("numerator denominator _position _step", cycles="_cycle")

    def __init__(self) -> None:
        self.numerator = 1  # SYSCLKOUT = OSCCLK * numerator / denominator
        self.denominator = 4
        self._cycle = 0  # of the last retuning
        self._position = 0
        self._step = 4 * PARTS  # parts a SYSCLKOUT cycle

    def at(self, cycle: int) -> int:
        """The OSCCLK position, in parts, at which this cycle begins. Not for cycles before the last retuning."""
        return self._position + (cycle - self._cycle) * self._step

    def cycle_at(self, position: int) -> int:
        """The first cycle that begins at this position or later, if the ratio stays as it is."""
        return self._cycle - (self._position - position) // self._step

    def retune(self, cycle: int, numerator: int, denominator: int) -> None:
        """From this cycle on SYSCLKOUT = OSCCLK * numerator / denominator. ValueError if no PLL setting makes that."""
        if numerator < 1 or PARTS * denominator % numerator:
            raise ValueError(f"SYSCLKOUT = OSCCLK * {numerator}/{denominator} is none of the PLL's ratios")
        self._position = self.at(cycle)
        self._cycle = cycle
        self.numerator = numerator
        self.denominator = denominator
        self._step = PARTS * denominator // numerator
