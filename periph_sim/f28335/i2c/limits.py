"""TI's requirements on the I2C module's settings. Each violation adds a note with the code "duty".

Each limit is checked when it begins to apply. For the module clock and the own address, this is when IRS becomes 1 and
at each later change. For the rate of SCL and the sent address, it is at each START. Times are computed from the
frequency of SYSCLKOUT that the owner sets.

Source: SPRUG03B sections 1.1, 1.4, 5.7, 5.8, 5.9; SPRS439M Table 6-31.
"""

# core: compiled

from __future__ import annotations

from fractions import Fraction
from typing import final

from ...core.state import State
from .register_map import I2C_MAP, MDR_FDF, MDR_IRS, MDR_MST, MDR_XA, STR_BB
from .registers import I2cRegisters

MODULE_CLOCK_MHZ = (7, 12)
SCL_KHZ = (10, 400)
LEAST_LOW_US, LEAST_HIGH_US = Fraction(13, 10), Fraction(6, 10)
BEYOND_7_BITS = 0x380
BYTE_ENABLES = I2C_MAP["I2CIER"]["XRDY"].mask | I2C_MAP["I2CIER"]["RRDY"].mask


@final
class I2cLimits:
    """Checks of the settings. Each adds a note if a limit is violated. sysclk_hz: the frequency of SYSCLKOUT."""

    STATE = State("sysclk_hz _clock_within_tm _clock_within_hz _within")

    def __init__(self, state: I2cRegisters) -> None:
        self.sysclk_hz: Fraction = Fraction(150_000_000)
        self._state = state
        # The last settings that were checked without a violation. Equal settings are not checked again.
        self._clock_within_tm = 0  # I2CPSC + 1 when the module clock was last found to be 7 to 12 MHz
        self._clock_within_hz: Fraction = self.sysclk_hz  # SYSCLKOUT when the module clock was last 7 to 12 MHz
        # (low cycles of SCL, high cycles, frequency of SYSCLKOUT) when the times of SCL were last within their limits.
        self._within = (0, 0, self.sysclk_hz)

    def module_clock(self) -> None:
        tm = self._state.tm
        if tm == self._clock_within_tm and self.sysclk_hz is self._clock_within_hz:
            return
        least, most = MODULE_CLOCK_MHZ
        mhz = self.sysclk_hz / tm / 1_000_000
        if least <= mhz <= most:
            self._clock_within_tm, self._clock_within_hz = tm, self.sysclk_hz
        else:
            self._state.duty(
                f"I2CPSC = {tm - 1} gives a module clock of {_show(mhz)} MHz at SYSCLKOUT = "
                f"{_show(self.sysclk_hz / 1_000_000)} MHz; expected {least} to {most} MHz",
                "SPRUG03B section 1.4",
            )

    def address(self, name: str, value: int) -> None:
        """Add a note if XA = 0 and I2COAR or I2CSAR has bits beyond the 7-bit address. name: "I2COAR" or "I2CSAR"."""
        if value & BEYOND_7_BITS and not self._state.mdr & MDR_XA:
            self._state.duty(
                f"{name} = {value:#05x} has bits 9 to 7 set with XA = 0; expected 0 there", "SPRUG03B §5.8, §5.9"
            )

    def scl(self, low: int, high: int) -> None:
        """Add a note if the rate, low time or high time of SCL is not allowed. low, high: the two times in cycles."""
        given = low, high, self.sysclk_hz
        if given == self._within:
            return
        least, most = SCL_KHZ
        khz = self.sysclk_hz / (low + high) / 1000
        rate_is_right = least <= khz <= most
        if not rate_is_right:
            self._state.duty(
                f"SCL would run at {_show(khz)} kHz; expected {least} to {most} kHz", "SPRUG03B section 1.1"
            )
        low_us, high_us = 1_000_000 * low / self.sysclk_hz, 1_000_000 * high / self.sysclk_hz
        if low_us < LEAST_LOW_US or high_us < LEAST_HIGH_US:
            self._state.duty(
                f"SCL has {_show(low_us)} us low, {_show(high_us)} us high; expected at least "
                f"{_show(LEAST_LOW_US)} us and {_show(LEAST_HIGH_US)} us",
                "SPRS439M Table 6-31",
            )
        elif rate_is_right:
            self._within = given

    def start_commanded(self, bus_busy: bool) -> None:
        """Add a note if STT is set while I2CSTR.BB does not agree with the state of the bus.

        bus_busy: True during a transfer, even one that began while IRS was 0.
        """
        shown = bool(self._state.str & STR_BB)
        if shown != bus_busy:
            self._state.duty(
                f"STT was set with BB = {shown:d}, left from before IRS rose, while "
                f"{'a transfer is in progress' if bus_busy else 'the bus is free'}; "
                "wait after IRS = 1 as long as the longest transfer lasts",
                "SPRUG03B section 5.3",
            )

    def written_while_enabled(self, name: str) -> bool:
        """Return True, and add a note, if a register that must be written with IRS = 0 was written with IRS = 1."""
        if not self._state.mdr & MDR_IRS:
            return False
        self._state.duty(f"{name} was written with IRS = 1; write configuration while IRS = 0", "SPRUG03B section 4")
        return True

    def divisor(self, name: str, value: int) -> None:
        """Add a note if I2CCLKL or I2CCLKH is written with 0, or while IRS = 1. name: "I2CCLKL" or "I2CCLKH"."""
        self.written_while_enabled(name)
        if not value:
            self._state.duty(f"{name} was written 0; expected 1 to 65535", "SPRUG03B Tables 13, 14")

    def fifo_enables(self) -> None:
        """Add a note if I2CIER enables XRDY or RRDY in FIFO mode. Call when I2CIER or the mode has changed."""
        if self._state.fifo and self._state.ier & BYTE_ENABLES:
            self._state.duty("I2CIER enables XRDY or RRDY in FIFO mode; expected 0 there", "SPRUG03B Table 9")

    def loopback(self, begins: bool) -> None:
        """Add notes on a write of I2CMDR with DLB = 1 if other bits contradict it. begins: True if DLB was 0 before."""
        if begins and not self._state.mdr & MDR_MST:
            self._state.duty("DLB was set with MST = 0; loopback needs a master", "SPRUG03B Table 5")
        if self._state.mdr & MDR_FDF:
            self._state.duty("DLB and FDF are both 1; free data format has no loopback", "SPRUG03B §2.5.3")


def _show(value: Fraction) -> str:
    return f"{float(value):.6g}"
