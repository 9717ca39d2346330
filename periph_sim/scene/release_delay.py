"""Delay between a write of I2CDXR and the release of SCL, for an I2C-A that holds SCL low until this write.

The delay has three parts: the copy from I2CDXR to I2CXSR, which takes no time if BCM = 1; the set-up time of SDA before
SCL; and the delay of the pin. The parts are counted in cycles of the module clock or of SYSCLKOUT.
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
        self._touched: frozenset[str] = frozenset()  # the options that the module had used before the last `_look`
        self._writes = -1  # the value of `Chip.writes` at the last call of `_look`
        self._cycles = 0  # the delay in cycles, computed by the last call of `_look`

    def ticks(self, written: int) -> int:
        """Return the delay in ticks after a write at tick `written`.

        The delay depends on `written` if a cycle is not a whole number of ticks.
        """
        clock = self._clock
        if self._socket.chip.writes != self._writes:
            self._look(clock.cycle_at(self._kernel.now))
        cycle = clock.cycle_at(written)
        return clock.tick(cycle + self._cycles) - clock.tick(cycle)

    def _look(self, now: int) -> None:
        """Read I2CPSC and I2CEMDR, which only writes and resets change, and compute the delay in cycles."""
        chip = self._socket.chip
        self._writes = chip.writes
        touched = chip.touched
        if len(touched) != len(self._touched):
            self._touched = frozenset(touched)
        prescaler, emdr = chip.peek(now, I2CPSC), chip.peek(now, I2CEMDR)
        if len(touched) != len(self._touched):
            touched.intersection_update(self._touched)  # reads by a measure do not count as uses of options
        module = ((prescaler & IPSC) >> IPSC_PLACE) + 1
        copy = 0 if emdr & BCM else module
        self._cycles = copy + max(1, self._setup * module) + self._pin
