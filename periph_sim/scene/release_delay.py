"""Delay of an I2C-A from a write of I2CDXR that SCL is held for to the release of SCL, with the present settings.

Copy to I2CXSR unless BCM does that at the write, SDA set up before SCL, pin output: in cycles of the module clock and
of SYSCLKOUT; the tick of the write goes in, ticks come out.
"""

# core: compiled

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.socket import Socket
from ..core.time import Clock
from ..f28335.i2c.options import I2cOptions
from ..f28335.i2c.register_map import I2C_MAP
from ..f28335.system_options import SystemOptions

I2CPSC, I2CEMDR = I2C_MAP["I2CPSC"].offset, I2C_MAP["I2CEMDR"].offset
IPSC, BCM = I2C_MAP["I2CPSC"]["IPSC"].mask, I2C_MAP["I2CEMDR"]["BCM"].mask
IPSC_PLACE = I2C_MAP["I2CPSC"]["IPSC"].lsb


class ReleaseDelay:
    def __init__(self, kernel: Kernel, clock: Clock, socket: Socket, i2c: I2cOptions, system: SystemOptions) -> None:
        self._kernel = kernel
        self._clock = clock
        self._socket = socket
        self._setup: int = i2c.sda_setup_before_scl_release.unrecorded()
        self._pin: int = system.gpio_out_delay.unrecorded()
        self._touched: frozenset[str] = frozenset()  # what the chip had touched before the last look at it
        self._writes = -1  # of the chip, when it was looked at last,
        self._cycles = 0  # and the result of that

    def ticks(self, written: int) -> int:
        """Return the time from a write at tick `written`: cycles of a clock that is off are not all of one length."""
        clock = self._clock
        if self._socket.chip.writes != self._writes:
            self._look(clock.cycle_at(self._kernel.now))
        cycle = clock.cycle_at(written)
        return clock.tick(cycle + self._cycles) - clock.tick(cycle)

    def _look(self, now: int) -> None:
        """At both registers, which only a write changes."""
        chip = self._socket.chip
        self._writes = chip.writes
        touched = chip.touched
        if len(touched) != len(self._touched):
            self._touched = frozenset(touched)
        prescaler, emdr = chip.peek(now, I2CPSC), chip.peek(now, I2CEMDR)
        if len(touched) != len(self._touched):
            touched.intersection_update(self._touched)  # looking is not depending on them
        module = ((prescaler & IPSC) >> IPSC_PLACE) + 1
        copy = 0 if emdr & BCM else module
        self._cycles = copy + max(1, self._setup * module) + self._pin
