"""Reset of a unit's I2C module from outside its firmware: a wire writes I2CMDR.IRS.

wire low:  IRS = 0           wire high:  IRS = 1, if it was so before
"""

from __future__ import annotations

from functools import partial

from ..core.kernel import Kernel
from ..core.sampler import watch
from ..core.state import State
from ..core.wire import Wire
from ..f28335.i2c.register_map import I2C_MAP
from ..processor.dsp import Dsp

I2CMDR = I2C_MAP["I2CMDR"]
IRS = I2CMDR["IRS"].mask


class ModuleReset:
    STATE = State("_was_on")

    def __init__(self, kernel: Kernel, unit: Dsp, wire: Wire) -> None:
        self._kernel = kernel
        self._clock = unit.clock
        self._socket = unit.socket("I2C-A")
        self._was_on: bool  # IRS when the wire fell; the wire is high at first
        watch([wire], self._changed)

    def _changed(self, tick: int, level: int) -> None:
        """Write I2CMDR.IRS in the cycle of this edge."""
        cycle = self._clock.cycle_at(tick)
        self._kernel.call_at(self._clock.tick(cycle), partial(self._write, cycle, level))

    def _write(self, cycle: int, level: int) -> None:
        value = self._socket.peek(cycle, I2CMDR.offset)
        if not level:
            self._was_on = bool(value & IRS)
            self._socket.write(cycle, I2CMDR.offset, value & ~IRS)
        elif self._was_on:
            self._socket.write(cycle, I2CMDR.offset, value | IRS)
