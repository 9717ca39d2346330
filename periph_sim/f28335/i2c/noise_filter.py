"""The noise filter of SCL and SDA, which removes pulses shorter than its width.

    pins     SCL ~~~\\_____________      SDA ~~~~~~\\_/~~~~~~
    levels   SCL ~~~~~~~~\\________      SDA ~~~~~~~~~~~~~~~      width = 5 cycles

A level passes once it has lasted for the filter's width; a shorter pulse has no effect. Edges of both lines that arrive
in one cycle leave in one cycle, as one change. TI does not document how the filter works. So its width and its
treatment of nearly simultaneous edges are options: `noise_filter_cycles` and `unequal_arrival`.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.options import BoolOption
from ...core.state import State
from .register_map import SCL, SDA


@final
class I2cNoiseFilter:
    """Filter of both lines.

    levels: mask of the levels after the filter, with the bits SCL and SDA.
    due: the cycle of the next change of `levels` that can have an effect, or NEVER. A change of SDA while SCL is low
        has no effect; it is applied with the next sample or change of SCL.
    unequal_arrival: an option. If it is True, edges of the two lines that are less than a module clock apart leave the
        filter together, at the time of the later edge.
    """

    STATE = State("levels", cycles="due _scl_due _sda_due _cycle _scl_was _sda_was", expires="_cycle")

    def __init__(self, unequal_arrival: BoolOption, touched: set[str]) -> None:
        self.levels = SCL | SDA
        self.due = NEVER
        self.unequal_arrival = unequal_arrival
        self._touched = touched
        self._scl_due = self._sda_due = NEVER
        self._cycle = -1  # cycle of the last call of `sample`
        # Values of `_scl_due` and `_sda_due` before the first call of `sample` in the cycle `_cycle`.
        self._scl_was = self._sda_was = NEVER

    def sample(self, now: int, pins: int, width: int, module_clock: int) -> None:
        """Set the levels at the pins from cycle `now` on. If there are several calls in one cycle, the last one counts.

        width: the filter's width in cycles.
        module_clock: the period of the module clock in cycles.
        """
        if now != self._cycle:
            if self._sda_due <= now and not self.levels & SCL:
                self.levels ^= SDA
                self._sda_due = NEVER
            self._cycle, self._scl_was, self._sda_was = now, self._scl_due, self._sda_due
        moved = pins ^ self.levels
        scl = sda = NEVER
        if moved & SCL:
            scl = self._scl_was if self._scl_was < NEVER else now + width
        if moved & SDA:
            sda = self._sda_was if self._sda_was < NEVER else now + width
        self._scl_due, self._sda_due = scl, sda
        self._set_due()
        apart = scl < NEVER and sda < NEVER and scl != sda and -module_clock < scl - sda < module_clock
        if apart and self.unequal_arrival.assume(self._touched):
            self.due = self._scl_due = self._sda_due = max(scl, sda)

    def apply_due(self, now: int) -> int:
        """Apply the changes due in cycle `now` and return the levels from then on."""
        if self._scl_due <= now:
            self.levels ^= SCL
            self._scl_due = NEVER
        if self._sda_due <= now:
            self.levels ^= SDA
            self._sda_due = NEVER
        self._set_due()
        return self.levels

    def _set_due(self) -> None:
        scl, sda = self._scl_due, self._sda_due
        self.due = scl if scl < sda or not self.levels & SCL else sda

    def scl_moves(self) -> bool:
        """Return True if an edge of SCL is in the filter: it has come in and has not left yet."""
        return self._scl_due < NEVER

    def visible_due(self, silent: int) -> int:
        """Return the cycle at which the first edge that has an effect leaves the filter; NEVER if there is none in it.

        silent: how many of the next SCL edges have no effect; -1 if any of them may have one. Edges of SDA while SCL is
        low have no effect.
        """
        scl, sda = self._scl_due, self._sda_due
        if silent < 0:
            return self.due
        first = NEVER if silent else scl
        high = bool(self.levels & SCL) != (scl < sda)  # level of SCL when SDA changes
        return min(first, sda) if high and scl != sda else first

    def settle(self, pins: int) -> None:
        """Set both filtered levels to those at the pins, as if the lines had been stable for a long time."""
        self.levels = pins
        self._scl_due = self._sda_due = self.due = NEVER
