"""An F28335's I2C module as seven bits pass at once: its socket goes in; where it stands before and behind comes out.

See `bus.i2c.whole_bytes`. A slave, or one who is not meant; what it is as the master is in `i2c_master_bytes`.
"""

# core: compiled

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, final

from ..bus.i2c.edge_play import BITS, SdaFollows
from ..bus.i2c.whole_bytes import ONES, ByteParty
from ..core.chip import NEVER
from ..core.kernel import CHIP, Kernel
from ..core.socket import Socket
from ..core.time import Clock
from ..core.wire import Wire
from ..f28335.i2c.module import I2c
from ..f28335.i2c.register_map import MDR_DLB, MDR_FDF, SCL, SDA
from ..f28335.i2c.slave_transmitter import LISTENS, TRANSMIT
from .i2c_master_bytes import SDA_INDEX, I2cMasterBytes

if TYPE_CHECKING:
    from ..core.wire import Pin

MARGIN = 2  # cycles: an edge between two cycles is seen with the later one


@final
class I2cSlaveEdges(SdaFollows):
    """Moves the module's SDA as the module would, and tells its socket what it would work under."""

    __slots__ = ("_chip", "_clock", "_cycle", "_socket")

    def __init__(self, kernel: Kernel, socket: Socket, chip: I2c, clock: Clock, sda: Wire) -> None:
        SdaFollows.__init__(self, kernel, sda, 0, 0)
        self._socket = socket
        self._chip = chip
        self._clock = clock
        self._cycle = 0  # in which it answers the fall

    def sampled(self, now: int, levels: int) -> None:
        if self._socket.traces:
            self._socket.given(self._clock.cycle_at(now) + self._chip.filter_width)
        SdaFollows.sampled(self, now, levels)

    def follow(self, now: int, level: int) -> None:
        self._cycle = self._clock.cycle_at(now) + self._chip.filter_width
        self.then(self._clock.tick(self._cycle), level, CHIP)

    def act(self, tag: int) -> None:
        self._socket.move(self._cycle, SDA_INDEX, tag)


class I2cSlaveBytes(ByteParty):
    """socket: of the module. clock: SYSCLKOUT. exact: bytes pass only where what it sees is what edges show."""

    __slots__ = ("_calm", "_calm_for", "_chip", "_clock", "_exact", "_hz", "_mover", "_socket", "_target", "master")

    _hz: Fraction

    def __init__(
        self, kernel: Kernel, socket: Socket, chip: I2c, clock: Clock, scl: Wire, sda: Wire, exact: bool
    ) -> None:
        self.master = I2cMasterBytes(kernel, scl, sda, socket, chip, clock, self)
        self._mover = I2cSlaveEdges(kernel, socket, chip, clock, sda)
        self._exact = exact
        self._socket = socket
        self._chip = chip
        self._target = chip.target
        self._clock = clock
        self._calm = False
        self._calm_for = -1  # sum of what it depends on,
        self._hz = clock.hz  # and this

    def pulls(self, line: int) -> int:
        mask: int = 0
        pin: Pin
        for pin in self._socket.pins[0 if line == SCL else 1]:
            mask |= pin.mask
        return mask

    def act(self, tag: int) -> None:
        self.master.again()

    def byte(self) -> int:
        if self._chip.master.active:
            return self.master.byte()
        return self._chip.state.xsr & ONES if self._target.phase == TRANSMIT else ONES

    def goes_on(self, shown: int) -> bool:
        return self.master.goes_on(shown)

    def follow_at(self, fall: int) -> int:
        if self._chip.master.active:
            return self.master.follow_at(fall)
        return self._clock.tick(self._clock.cycle_at(fall) + self._chip.filter_width + self._socket.out_delay)

    def apart(self, fall: int, moved: int) -> bool:
        """Else it takes them for one (option `unequal_arrival`)."""
        return self._clock.cycle_at(moved) - self._clock.cycle_at(fall) >= self._chip.state.tm

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        chip, target = self._chip, self._target
        lines, state = chip._lines, chip.state
        if chip.master.active:
            if not self.master.asks:
                return False
        elif chip.master.due != NEVER:
            return False
        if chip._suspended or state.mdr & (MDR_DLB | MDR_FDF):
            return False
        if chip._pins & SCL or lines.due != NEVER or lines.levels != chip._pins or self._socket._out != chip.out:
            return False
        if target.phase >= LISTENS:
            if not chip._clocked:
                return False  # it stands still in the middle of a transfer
            if target.bit or target._n != BITS + 1 or target.due != NEVER or target.pulls & SCL:
                return False
            if target.phase == TRANSMIT and not target._shifting:
                return False
        if not self._exact:
            return True
        wanted = each + 2 * low + 3 * high + 5 * hold + 7 * chip.filter_width + 11 * state.tm
        if wanted != self._calm_for or self._clock.hz is not self._hz:
            self._calm_for, self._hz = wanted, self._clock.hz
            self._calm = self._is_calm(low, high, hold, each)
        return self._calm

    def _is_calm(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Each level outlasts the noise filter, and SDA moves apart from SCL, also where this module moves it."""
        width, module_clock = self._chip.filter_width, self._chip.state.tm
        apart = max(width, module_clock) + MARGIN
        low, high, hold = self._cycles(low), self._cycles(high), self._cycles(hold)
        own = width + self._socket.out_delay + MARGIN
        if width <= 0 or (not each and hold < module_clock + MARGIN):
            return False
        return min(high, low - hold, low - own) >= apart

    def _cycles(self, ticks: int) -> int:
        """Whole cycles in so long a time, rounded down."""
        return self._clock.cycle_at(self._clock.tick(0) + ticks) - 1

    def stand(self, shown: int, bit: int, fell: int) -> None:
        chip, target = self._chip, self._target
        levels: int = SDA if shown >> (BITS - bit) & 1 else 0
        chip._pins = chip.master.lines = levels
        chip._lines.settle(levels)
        if target.phase == TRANSMIT:
            target.bit = bit
            target._drive(chip.state.xsr >> (BITS - bit) & 1)
            chip.out = self._socket._out = chip._levels()
        elif target.phase >= LISTENS:
            target.bit = bit
            target._shift = shown >> (BITS + 1 - bit)
        if chip.master.active:
            self.master.stand(shown, bit)

    def meanwhile(self) -> SdaFollows | None:
        sends = self._target.phase == TRANSMIT
        if not sends and not self._socket.traces:
            return None
        self._mover.begin(self.byte() if sends else ONES)
        return self._mover

    def edge(self, tick: int, levels: int) -> None:
        """Its effects are there at once, with the cycle in which they come behind the noise filter."""
        chip, socket = self._chip, self._socket
        cycle = self._clock.cycle_at(tick)
        looks = chip.pins(cycle, levels)
        due = chip._lines.due
        if due < NEVER:
            cycle = due
            looks = max(looks, chip.wake(due))
        if looks:
            socket._out = socket._out & SCL | chip.out & SDA  # SDA is put on the wire by who asks
            socket.publish(cycle, looks)

    def pulls_sda(self) -> bool:
        return not self._chip.out & SDA

    def holds(self) -> bool:
        return not self._chip.out & SCL
