"""An F28335 as the master of bytes that pass at once: it is about to let SCL go; where it stands before and behind.

    out SCL  __|~~|__|~~|_ ... _|~~|_          cycles: `release` + n (low + high)
    wire     ___|~~|__|~~|_ ... _|~~|_         later by the delay from output to pin
               ^ asked here      ^ goes on here: the module wakes to let go for the eighth bit

See `bus.i2c.whole_bytes`; what the module is as a slave, `i2c_slave_bytes`.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..bus.i2c.bit_times import CycleTimes
from ..bus.i2c.edge_play import BITS, FALL, FOLLOW, RISE, EdgePlay
from ..bus.i2c.whole_bytes import ONES, ByteParty, WholeBytes
from ..core.chip import NEVER, OUTPUTS
from ..core.kernel import CHIP, Kernel
from ..core.socket import Release, Socket
from ..core.time import Clock
from ..core.wire import Wire
from ..f28335.i2c.clock import FALL as BIT_ENDS
from ..f28335.i2c.clock import NO_STEP
from ..f28335.i2c.clock import RELEASE as LETS_GO
from ..f28335.i2c.master import I2cMaster
from ..f28335.i2c.master_receiver import NO_BYTE, TAKE
from ..f28335.i2c.module import I2c
from ..f28335.i2c.register_map import MDR_DLB, MDR_FDF, SCL
from ..f28335.i2c.slave_transmitter import ADDRESS, IGNORE, OFF

SCL_INDEX, SDA_INDEX = 0, 1  # among the module's outputs
WHOLE = BITS + 1


@final
class MasterPlay(EdgePlay):
    """Moves the module's outputs as the module would, in cycles."""

    __slots__ = ("_clock", "_cycle", "_socket")

    def __init__(self, kernel: Kernel, scl: Wire, sda: Wire, socket: Socket, clock: Clock) -> None:
        EdgePlay.__init__(self, kernel, scl, sda, 0, 0)
        self._next = kernel.event(self, CHIP)
        self._socket = socket
        self._clock = clock
        self._cycle = 0

    def begin_in_cycles(self, byte: int, release: int, low: int, high: int, hold: int) -> None:
        """As `begin`: SCL was let go in cycle `release`."""
        self._byte, self._bit = byte, 0
        self._low, self._high, self._hold = low, high, hold
        self._cycle = release
        self._next_at(release + high, FALL)

    def act(self, tag: int) -> None:
        cycle, socket = self._cycle, self._socket
        if tag == RISE:
            socket.move(cycle, SCL_INDEX, 1)
            self._next_at(cycle + self._high, FALL)
            return
        rise = cycle + self._low
        if tag == FALL:
            socket.move(cycle, SCL_INDEX, 0)
            self._bit += 1
            around = self._byte >> (BITS - self._bit) & 3
            if around == 1 or around == 2:
                self._next_at(cycle + self._hold, FOLLOW)
                return
        else:
            socket.move(cycle, SDA_INDEX, self._byte >> (BITS - self._bit) & 1)
            rise -= self._hold
        if self._bit < BITS:
            self._next_at(rise, RISE)

    def _next_at(self, cycle: int, tag: int) -> None:
        self._cycle = cycle
        self._kernel.renew(self._next, self._clock.tick(cycle), tag)


class I2cMasterBytes(Release):
    """party: the module among the parties of the bus."""

    __slots__ = (
        "_chip",
        "_clock",
        "_fell",
        "_high",
        "_in",
        "_low",
        "_low_from",
        "_master",
        "_party",
        "_play",
        "_release",
        "_rose_at",
        "_sampled",
        "_socket",
        "_times",
        "_under",
        "_whole_bytes",
        "asks",
    )

    _play: MasterPlay | None

    def __init__(
        self, kernel: Kernel, scl: Wire, sda: Wire, socket: Socket, chip: I2c, clock: Clock, party: ByteParty
    ) -> None:
        self._socket = socket
        self._chip = chip
        self._master: I2cMaster = chip.master
        self._clock = clock
        self._party = party
        self._whole_bytes: WholeBytes | None = None
        self._times = CycleTimes(clock)
        self._play = MasterPlay(kernel, scl, sda, socket, clock) if scl.recorded or sda.recorded else None
        self.asks = False  # just now
        self._release = self._low = self._high = 0  # cycles: of the first bit's rise at the output; of SCL there
        self._under = 0  # the record under which that was
        # What the master keeps of the bits and edges before.
        self._in = self._sampled = self._low_from = self._rose_at = 0

    def let_pass(self, whole_bytes: WholeBytes) -> None:
        """From now on it is asked about each byte."""
        self._whole_bytes = whole_bytes
        self._socket.release = self

    def holds_back(self) -> bool:
        """SCL is let go at the pin: the pin does so later where bits pass at once."""
        master, whole_bytes = self._master, self._whole_bytes
        assert whole_bytes is not None
        if not master._waits_for_rise or master._after_high != BIT_ENDS or master._kind == NO_BYTE:
            return False
        if master._bit == BITS:
            whole_bytes.over()
        if master._bit or not self._plain():
            return False
        return self._passes(whole_bytes)

    def _plain(self) -> bool:
        """Nothing but the bits of a byte of eight is going on."""
        chip, master = self._chip, self._master
        if chip.state.mdr & (MDR_DLB | MDR_FDF) or master.frozen or master.halting or master._n != WHOLE:
            return False
        phase = chip.target.phase
        return chip._clocked and master.due == NEVER and phase in (ADDRESS, IGNORE, OFF)

    def _passes(self, whole_bytes: WholeBytes) -> bool:
        master, chip, delay = self._master, self._chip, self._socket.out_delay
        late: int = chip.options.scl_sync_cycles.assume(chip.touched) * chip.state.tm if delay else 0
        release = self._release = master._let_go_at
        self._low, self._high = master.low(), delay + late + master.high()
        self._in, self._sampled = master._in, master._sampled
        self._low_from, self._rose_at = master._low_from, master._rose_at
        self._under = self._socket._recorder.cause
        times = self._times
        times.since, times.low, times.high = release + delay, self._low, self._high
        fell = self._clock.tick(self._low_from + delay)
        ends = self._clock.tick(release + BITS * (self._low + self._high))
        self.asks = True
        passes = whole_bytes.pass_of(self._party, times, fell, ends, self._play)
        self.asks = False
        if not passes:
            return False
        self._socket.publish(release, OUTPUTS)  # it wakes for the eighth bit
        if self._play is None:
            return True
        self._play.begin_in_cycles(self.byte(), release, self._low, self._high, chip.state.tm)
        return False

    def byte(self) -> int:
        """What it puts on SDA."""
        return ONES if self._master._kind == TAKE else self._master._byte

    def goes_on(self, shown: int) -> bool:
        """Else it loses arbitration on the way."""
        return self._master._kind == TAKE or shown == self._master._byte

    def follow_at(self, fall: int) -> int:
        """See `ByteParty`: one module clock behind its fall, and the delay is the same."""
        return self._clock.tick(self._clock.cycle_at(fall) + self._chip.state.tm)

    def stand(self, shown: int, bit: int) -> None:
        """Behind no bit SCL was just let go; behind seven it is about to be."""
        master, chip = self._master, self._chip
        period = self._low + self._high
        master._bit = bit
        master._drive(self.byte() >> (BITS - bit) & 1)
        if bit:
            master.pulls |= SCL
            master._waits_for_rise = False
            master._in, master._sampled = (self._in & 1) << BITS | shown >> 1, shown >> 1 & 1
            master._let_go_at = self._release + (BITS - 1) * period
            master._rose_at = master._let_go_at + self._socket.out_delay
            master._at(self._release + BITS * period, LETS_GO)
            master._low_from = master.due - self._low
        else:
            master.pulls &= ~SCL
            master._waits_for_rise = True
            master._in, master._sampled = self._in, self._sampled
            master._let_go_at, master._rose_at, master._low_from = self._release, self._rose_at, self._low_from
            master._at(NEVER, NO_STEP)
        chip._timer = chip._next_timer()
        chip.out = self._socket._out = chip._levels()
        chip.next_wake = chip._timer

    def again(self) -> None:
        """SCL is let go for the first bit once more."""
        recorder = self._socket._recorder
        outer, recorder.cause = recorder.cause, self._under
        self._socket.reclock()
        self._socket._set_pins(SCL_INDEX, 1)
        recorder.cause = outer
