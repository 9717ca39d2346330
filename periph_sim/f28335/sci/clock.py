"""The SCI's sample clock: conversion between SYSCLKOUT cycles and numbers of SCICLK ticks.

    SYSCLKOUT --/divider--> LSPCLK --/(BRR + 1)--> SCICLK: tick n, n + 1, n + 2 ...

Receiver and transmitter count time in ticks. If the rate changes or the clock stops, only the cycles of later ticks
change. Ticks coincide with LSPCLK edges, which are in each cycle n with n % divider == phase. Receiver and transmitter
each have a clock. The two clocks are equal, with two exceptions: the transmitter's clock can be restarted, and after a
debugger halt one clock may run on until its frame is complete while the other is stopped.

Chosen: the divider runs whenever the module has a clock, unless a debugger halt stops it; SW RESET does not affect it.
A change of LSPCLK keeps the number of LSPCLK edges left to the next tick.

Source: TI SPRUFZ5A sections 1.2.7 and 2.4; SPRUFB0D section 5.1.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State


@final
class SciClock:
    """Clock of the receiver or of the transmitter, initially stopped. period: cycles of one SCICLK."""

    STATE = State(
        "running divider phase brr period _tick _left", cycles="_cycle", results="_tick", grids={"_cycle": "period"}
    )

    def __init__(self) -> None:
        self.running = False
        self.divider = 4  # period of LSPCLK in SYSCLKOUT cycles
        self.phase = 0
        self.brr = 0
        self.period = 8
        self._tick = 0  # number of the tick that is at cycle `_cycle`
        self._cycle = NEVER  # cycle of tick `_tick`
        # While stopped: number of LSPCLK edges from the next start to tick `_tick`, including the edge of this tick.
        self._left = 2

    def passed(self, now: int) -> int:
        """Return the last tick at or before `now`."""
        ahead = now - self._cycle
        return self._tick - 1 if ahead < 0 else self._tick + ahead // self.period

    def from_cycle(self, cycle: int) -> int:
        """Return the first tick at or after `cycle`. For a cycle before that of tick `_tick`, return `_tick`."""
        ahead = cycle - self._cycle
        return self._tick if ahead <= 0 else self._tick - (-ahead // self.period)

    def at(self, tick: int) -> int:
        """Return the cycle of a future tick; NEVER while the clock is stopped, or for a tick that no run reaches."""
        if tick >= NEVER or not self.running:
            return NEVER
        cycle = self._cycle + (tick - self._tick) * self.period
        return cycle if cycle < NEVER else NEVER

    def lspclk_after(self, now: int) -> int:
        """Return the cycle of the first LSPCLK edge after `now`."""
        return now + self.divider - (now - self.phase) % self.divider

    def set_brr(self, now: int, brr: int, at_once: bool) -> None:
        """Set the baud divider. It takes effect at the next tick or, if `at_once` is True, at the next LSPCLK edge."""
        self._rebase(now)
        self.brr = brr
        steps = brr + 1 if brr else 2
        self.period = steps * self.divider
        if at_once:
            if self.running:
                self._cycle = self.lspclk_after(now) + self.period
            else:
                self._left = steps

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set the period of LSPCLK to `divider` cycles, with an edge in each cycle n with n % divider == phase."""
        was_running = self.running
        self.stop(now)
        self.divider = divider
        self.phase = phase % divider
        self.period = (self.brr + 1 if self.brr else 2) * divider
        if was_running:
            self.start(now)

    def stop(self, now: int) -> None:
        if self.running:
            self._rebase(now)
            self._left = 1 + (self._cycle - self.lspclk_after(now)) // self.divider
            self._cycle = NEVER
            self.running = False

    def start(self, now: int) -> None:
        if not self.running:
            self._cycle = self.lspclk_after(now) + (self._left - 1) * self.divider
            self.running = True

    def restart(self, now: int) -> None:
        """Move the next tick to the next LSPCLK edge."""
        self._rebase(now)
        if self.running:
            self._cycle = self.lspclk_after(now)
        else:
            self._left = 1

    def reset(self, now: int) -> None:
        """Stop the clock, and set the baud divider to 0. LSPCLK does not change."""
        self.stop(now)
        self.brr = 0
        self.period = 2 * self.divider
        self._left = 2

    def _rebase(self, now: int) -> None:
        """Set `_tick` and `_cycle` to the first tick after `now`, if they are not after `now` already."""
        if now >= self._cycle:
            past = (now - self._cycle) // self.period + 1
            self._tick += past
            self._cycle += past * self.period
