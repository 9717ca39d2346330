"""The noise filter of SCL and SDA: levels at the pins, cycle by cycle, go in; levels that lasted come out.

    pins     SCL ~~~\\_____________      SDA ~~~~~~\\_/~~~~~~
    levels   SCL ~~~~~~~~\\________      SDA ~~~~~~~~~~~~~~~      width = 5 cycles

A level counts once it has lasted for the filter's width; a shorter pulse was never there. Edges of both lines that
come in one cycle leave in one cycle, as one change. What the filter is made of, TI does not say: options
`noise_filter_cycles` and `unequal_arrival`.
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
    """levels: behind the filter, SCL and SDA as bits. due: the cycle of their next change, or NEVER.

    unequal_arrival: edges of the two lines less than a module clock apart leave as one change, with the later one.
    """

    STATE = State("levels", cycles="due _scl_due _sda_due _cycle _scl_was _sda_was")

    def __init__(self, unequal_arrival: BoolOption, touched: set[str]) -> None:
        self.levels = SCL | SDA
        self.due = NEVER
        self.unequal_arrival = unequal_arrival
        self._touched = touched
        self._scl_due = self._sda_due = NEVER
        self._cycle = -1  # of the last sample,
        self._scl_was = self._sda_was = NEVER  # and the dues before it

    def sample(self, now: int, pins: int, width: int, module_clock: int) -> None:
        """The levels at the pins in cycle `now`, in place of earlier ones of the same cycle. Times in cycles."""
        if now != self._cycle:
            self._cycle, self._scl_was, self._sda_was = now, self._scl_due, self._sda_due
        moved = pins ^ self.levels
        scl = sda = NEVER
        if moved & SCL:
            scl = self._scl_was if self._scl_was < NEVER else now + width
        if moved & SDA:
            sda = self._sda_was if self._sda_was < NEVER else now + width
        self._scl_due, self._sda_due = scl, sda
        self.due = scl if scl < sda else sda
        if scl < NEVER and sda < NEVER and scl != sda and -module_clock < scl - sda < module_clock:
            self._arrive_apart(max(scl, sda))

    def _arrive_apart(self, later: int) -> None:
        """Edges of both lines are on their way, less than a module clock apart."""
        if self.unequal_arrival.assume(self._touched):
            self.due = self._scl_due = self._sda_due = later

    def take(self, now: int) -> int:
        """The levels from cycle `now` on, in which a change was due."""
        if self._scl_due <= now:
            self.levels ^= SCL
            self._scl_due = NEVER
        if self._sda_due <= now:
            self.levels ^= SDA
            self._sda_due = NEVER
        self.due = self._scl_due if self._scl_due < self._sda_due else self._sda_due
        return self.levels

    def scl_moves(self) -> bool:
        """An edge of SCL is on its way."""
        return self._scl_due < NEVER

    def sign_due(self, silent: int) -> int:
        """The cycle of the first change on its way by which anything can be told, or NEVER.

        Nothing can by so many edges of SCL, and by those of SDA as SCL is low; with -1, by none.
        """
        scl, sda = self._scl_due, self._sda_due
        if silent < 0:
            return self.due
        first = NEVER if silent else scl
        high = bool(self.levels & SCL) != (scl < sda)  # SCL, as SDA moves
        return min(first, sda) if high and scl != sda else first

    def settle(self, pins: int) -> None:
        """The lines have been at these levels for long."""
        self.levels = pins
        self._scl_due = self._sda_due = self.due = NEVER
