"""Counts the bytes on an I2C bus, addresses included: edges go in, a number comes out.

For scenes in which no agent is the controller and so nobody else counts.
"""

from __future__ import annotations

from ..core.wire import Wire

PULSES = 9  # eight bits and the acknowledge


class I2cCounter:
    """bytes: whole ones, each with its acknowledge; what is cut off by a START or STOP does not count."""

    def __init__(self, scl: Wire, sda: Wire) -> None:
        self.bytes = 0
        self._scl = scl
        self._active = False
        self._pulses = 0
        scl.watch(self._scl_changed)
        sda.watch(self._sda_changed)

    def _scl_changed(self, now: int, level: int) -> None:
        if not self._active:
            return
        if level:
            self._pulses += 1
        elif self._pulses == PULSES:
            self.bytes += 1
            self._pulses = 0

    def _sda_changed(self, now: int, level: int) -> None:
        if self._scl.level:  # START or STOP
            self._active = not level
            self._pulses = 0
