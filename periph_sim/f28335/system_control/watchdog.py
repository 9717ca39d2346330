"""Watchdog, which counts OSCCLK and, when it overflows, requests a reset or drives WDINT low.

    OSCCLK --> /512 --> WDPS --> WDCNTR --overflow--> WDENINT = 0: reset
                                   ^                  WDENINT = 1: WDINT low for 512 OSCCLK
    WDKEY 0x55, 0xAA --------------+                                ^
    WDCR.WDCHK other than 5 ----------------------------------------+

The watchdog is part of `SystemControl`, its owner. `SystemControl` converts between SYSCLKOUT cycles and OSCCLK
positions (`oscclk`), delays WDINTS and WDFLAG, forwards accesses to the watchdog's registers, and requests WAKEINT when
WDINT falls.

Source: SPRUFB0D section 5.4, Tables 26 to 30; SPRZ272N section 3.1.3.

Chosen:
- While the watchdog is disabled, WDCNTR keeps its count. It continues from this count when it is enabled again.
- A wrong WDCHK acts like an overflow, but WDCNTR keeps its count, if the same write leaves the watchdog enabled. The
  other fields of that write take effect as well.
- With wd_bad_key = reset, a wrong key acts at once like a wrong WDCHK, if the watchdog is enabled. The errata also say
  that a correct key after it prevents the reset. This is not modelled.
- The dividers before WDCNTR form one chain, and WDPS selects a tap of it. A new WDPS takes effect at once.
"""

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from ..system_options import SystemOptions
from .oscclk import PARTS
from .register_map import SCSR, WDCR

WDINT_OSCCLKS = 512  # length of the low pulse on XRS or WDINT, in OSCCLK periods (section 5.4)
OVERFLOW = 256
DIVIDER = 512

WDFLAG, WDDIS = WDCR["WDFLAG"].mask, WDCR["WDDIS"].mask
WDCHK, WDPS = WDCR["WDCHK"], WDCR["WDPS"]
WDCHK_RIGHT = 5
WDENINT, WDOVERRIDE = SCSR["WDENINT"].mask, SCSR["WDOVERRIDE"].mask

PRESCALE = (1, 1, 2, 4, 8, 16, 32, 64)


class Watchdog:
    """Watchdog. All times and positions are in parts of an OSCCLK period, which has `oscclk.PARTS` parts.

    touched: the set to which the names of the used options are added.
    """

    STATE = State("wdcr scsr wdint interrupt reset_requested next_due _armed _origin _since _count _low_until")

    def __init__(self, options: SystemOptions, touched: set[str]) -> None:
        self._options = options
        self._touched = touched
        self.reset(0)

    def reset(self, position: int) -> None:
        """Reset by XRS: the watchdog is enabled and counts from 0, and WDFLAG is 0."""
        self.wdcr = WDCR.reset
        self.scsr = SCSR.reset
        self.wdint = 1  # level of WDINT
        self.interrupt = False  # becomes True when WDINT falls; the owner sets it to False
        self.reset_requested = False
        self._armed = False  # True if the last key was 0x55, so that 0xAA clears WDCNTR
        self._origin = position  # a position at which the whole divider chain before WDCNTR was at 0
        self._since = position  # position at which WDCNTR was `_count`
        self._count = 0
        self._low_until = NEVER
        self._schedule()

    @property
    def enabled(self) -> bool:
        return not self.wdcr & WDDIS

    def count(self, position: int) -> int:
        """Return WDCNTR at a position. Call `advance` with this position first."""
        if not self.enabled:
            return self._count
        period = self._period()
        return self._count + (position - self._origin) // period - (self._since - self._origin) // period

    def rounds(self, parts: int) -> int:
        """Return how often WDCNTR can count through all its 256 values within a duration.

        parts: the duration in parts of an OSCCLK period.
        """
        return parts // (OVERFLOW * self._period())

    def advance(self, position: int) -> None:
        """Process all overflows and ends of WDINT pulses up to this position."""
        while self.next_due <= position:
            due = self.next_due
            if due == self._low_until:
                self.wdint = 1
                self._low_until = NEVER
            else:
                self._count = 0
                self._since = due
                self._fire(due)
            self._schedule()

    def write_wdkey(self, position: int, value: int) -> None:
        key = value & 0xFF
        if key == 0xAA and self._armed:
            self._count = 0
            self._since = position
            if self._options.wd_divider.assume(self._touched) == "restarts_on_clear":
                self._origin = position
        self._armed = key == 0x55
        wrong = key not in (0x55, 0xAA) and self.enabled
        if wrong and self._options.wd_bad_key.assume(self._touched) == "reset":
            self._fire(position)
        self._schedule()

    def write_wdcr(self, position: int, value: int) -> None:
        self._count = self.count(position)
        self._since = position
        written, _ = WDCR.write(self.wdcr, value)
        if not self.scsr & WDOVERRIDE:
            written = written & ~WDDIS | self.wdcr & WDDIS
        self.wdcr = written & ~WDCHK.mask
        if self.enabled and WDCHK.extract(value) != WDCHK_RIGHT:
            self._fire(position)
        self._schedule()

    def write_scsr(self, position: int, value: int) -> None:
        """Write SCSR. If this clears WDENINT while WDINT is low, a reset is requested at once."""
        self.scsr, _ = SCSR.write(self.scsr, value)
        if not self.wdint and not self.scsr & WDENINT:
            self._fire(position)
        self._schedule()

    def _fire(self, position: int) -> None:
        if not self.scsr & WDENINT:
            self.reset_requested = True
            return
        self.interrupt = self.interrupt or self.wdint == 1  # only a falling edge of WDINT requests the interrupt
        self.wdint = 0
        self._low_until = position + WDINT_OSCCLKS * PARTS

    def _period(self) -> int:
        """Return the duration of one step of WDCNTR, in parts of an OSCCLK period."""
        return PARTS * DIVIDER * PRESCALE[WDPS.extract(self.wdcr)]

    def _schedule(self) -> None:
        overflow = NEVER
        if self.enabled:
            period = self._period()
            steps = (self._since - self._origin) // period + OVERFLOW - self._count
            overflow = self._origin + steps * period
        self.next_due = min(overflow, self._low_until)
