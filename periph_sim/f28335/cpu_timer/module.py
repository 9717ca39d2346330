"""32-bit CPU timer, which counts SYSCLKOUT cycles down and requests the interrupt TINT.

    SYSCLKOUT --> PSCH:PSC (TDDRH:TDDR + 1) --> TIMH:TIM --zero--> TIF, and with TIE: TINT
                                                  ^   |
                                      PRDH:PRD ---+<--+ the step after zero, or TRB

Cycles are not counted one by one: the count is computed when it is read. `next_wake` is the cycle at which TIF is set
next. If the timer is stopped, or nothing would change then (TIE = 0 and TIF already 1), `next_wake` is NEVER. TIM and
PSC change without a wake-up, so `register_map` marks them as changing with time.

Source: SPRUFB0D section 5.5, Tables 31 to 38.

Chosen:
- With timer_tif_point = on_zero, only a step to zero sets TIF. A load of 0 by TRB or by a CPU write does not. With
  PRD = 0 every step sets TIF, so the period is (PRD + 1)(TDDR + 1) in this case as well.
- With timer_tif_point = on_reload, every step that reloads the count sets TIF, including the first one after reset.
- If the count reaches zero in the cycle of a TCR write, TIF is set first. If the write has TIF = 1, it then clears TIF.
- With its clock off (PCLKCR3) the timer stops, but its registers can still be read and written.
- The timer ignores breakpoints; FREE and SOFT are only stored.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import ANY_CHANGED, NEVER, Chip
from ...core.state import State
from ..system_options import SystemOptions
from .register_map import MAP, PRD, PRDH, TCR, TIM, TIMH, TPR, TPRH

TIF, TIE, TRB, TSS = (TCR[name].mask for name in ("TIF", "TIE", "TRB", "TSS"))
AT_TCR, AT_TIM, AT_TIMH, AT_PRD, AT_PRDH, AT_TPR, AT_TPRH = (r.offset for r in (TCR, TIM, TIMH, PRD, PRDH, TPR, TPRH))


@final
class CpuTimer(Chip):
    """One CPU timer. It runs from reset on, as in hardware."""

    STATE = State("_clocked _tcr _prd _tddr _tim _psc", cycles="_since _event_at")
    MAP = MAP

    def __init__(self, options: SystemOptions) -> None:
        super().__init__()
        self._options = options
        self._on_reload = options.timer_tif_point.unrecorded() == "on_reload"
        self.reset(0)

    def reset(self, now: int) -> None:
        """Reset by XRS: the count becomes 0 and the period 0xFFFF, and the timer runs."""
        self._clocked = True  # the reset value of PCLKCR3 switches the clocks of the timers on
        self._tcr: int = TCR.reset
        self._prd: int = PRDH.reset << 16 | PRD.reset  # PRDH:PRD
        self._tddr = 0  # TDDRH:TDDR
        self._since = now  # cycle at which TIMH:TIM was `_tim` and PSCH:PSC was `_psc`
        self._tim = 0
        self._psc = 0
        self.requests = 0
        self._schedule()

    # Inputs -----------------------------------------------------------------

    def wake(self, now: int) -> int:
        self._sync(now)
        self._schedule()
        return ANY_CHANGED

    def peek(self, now: int, offset: int) -> int:
        """Return the register's value; 0 if there is no register. Reads have no side effects."""
        self._sync(now)
        self._schedule()
        if offset == AT_TCR:
            return self._tcr
        if offset == AT_TIM:
            return self._tim & 0xFFFF
        if offset == AT_TIMH:
            return self._tim >> 16
        if offset == AT_PRD:
            return self._prd & 0xFFFF
        if offset == AT_PRDH:
            return self._prd >> 16
        if offset == AT_TPR:
            return (self._psc & 0xFF) << 8 | self._tddr & 0xFF
        if offset == AT_TPRH:
            return self._psc >> 8 << 8 | self._tddr >> 8
        return 0

    def write(self, now: int, offset: int, value: int) -> None:
        self._sync(now)
        value &= 0xFFFF
        if offset == AT_TCR:
            self._write_tcr(value)
        elif offset == AT_TIM:
            self._tim = self._tim & 0xFFFF0000 | value
        elif offset == AT_TIMH:
            self._tim = self._tim & 0xFFFF | value << 16
        elif offset == AT_PRD:
            self._prd = self._prd & 0xFFFF0000 | value
        elif offset == AT_PRDH:
            self._prd = self._prd & 0xFFFF | value << 16
        elif offset == AT_TPR:
            self._tddr = self._tddr & 0xFF00 | value & 0xFF
        elif offset == AT_TPRH:
            self._tddr = self._tddr & 0xFF | (value & 0xFF) << 8
        self._schedule()

    def gate(self, now: int, on: bool) -> None:
        """Switch the timer's clock on or off at `now` (PCLKCR3.CPUTIMERnENCLK)."""
        self._sync(now)
        self._clocked = on
        self._schedule()

    # Counting ---------------------------------------------------------------

    def _write_tcr(self, value: int) -> None:
        before = self._tcr
        self._tcr, strobes = TCR.write(before, value)
        if strobes & TRB:
            self._tim = self._prd
            self._psc = self._tddr
        if (
            self._tcr & TIE
            and not before & TIE
            and self._tcr & TIF
            and self._options.timer_late_tie.assume(self.touched) == "requests"
        ):
            self.requests |= 1

    def _running(self) -> bool:
        return self._clocked and not self._tcr & TSS

    def _sync(self, now: int) -> None:
        """Advance count, prescaler and TIF to `now`."""
        if now >= self._event_at:
            self._tcr |= TIF
            self._options.timer_tif_point.assume(self.touched)
            if self._tcr & TIE:
                self.requests |= 1
        elapsed = now - self._since
        self._since = now
        if not elapsed or not self._running():
            return
        if elapsed <= self._psc:
            self._psc -= elapsed
            return
        past = elapsed - self._psc - 1
        self._psc = self._tddr - past % (self._tddr + 1)
        steps = past // (self._tddr + 1) + 1
        if steps <= self._tim:
            self._tim -= steps
        else:
            self._tim = self._prd - (steps - self._tim - 1) % (self._prd + 1)

    def _schedule(self) -> None:
        """Compute when TIF is set next, and schedule a wake-up if that is observable."""
        if not self._running():
            self._event_at = self.next_wake = NEVER
            return
        steps = self._tim + 1 if self._on_reload else self._tim or self._prd + 1
        # The next cycle at which the timer sets TIF, even if TIF is already 1.
        self._event_at = self._since + self._psc + 1 + (steps - 1) * (self._tddr + 1)
        visible = self._tcr & TIE or not self._tcr & TIF
        self.next_wake = self._event_at if visible else NEVER
