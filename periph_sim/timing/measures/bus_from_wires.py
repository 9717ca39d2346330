"""Bytes on an I2C bus, derived from the levels of its wires and the parties that pull them.

    SCL, SDA, parties that pull them --> START, address, ACK, first bit of each byte, STOP; release of SCL by others

Only the wires are read, so it does not matter whether the master is a simulated controller or a unit. All changes
within one tick form one sample. START and STOP are changes of SDA while SCL is high before and after them.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

# core: compiled

from __future__ import annotations

from ...bus.i2c.bit_skip import SKIPPED_BITS, BitParty, BitTimes
from ...core.time import NO_TIME
from ...core.wire import Wire
from ...traces.decode.i2c_stream import BITS, FALL, KINDS, RISE, START, STOP, I2cStream

SCL, SDA = 0, 1  # numbers of the two wires


class BusFromWires(BitParty):
    """Decoder of the bytes on the wires. In names, "ours" means the unit `unit`, and "others" all other parties.

    unit: the name of a unit; "" for none.
    stream: the bytes of the transfer in progress.

    Subclasses override the event handlers at the end of the class.
    """

    def __init__(self, unit: str) -> None:
        self.stream = I2cStream()
        self.ours = False  # True if the unit has acknowledged the address
        self.phase_at = NO_TIME  # the tick of the START or repeated START of the present phase; NO_TIME after a STOP
        # `others_held_until` is the tick in the last low phase of SCL since which no party except the unit has held SCL
        # low. While any other party holds SCL low, `others_held_until` is NO_TIME.
        self.others_held_until = NO_TIME
        self._unit: str = f"{unit}."
        self._scl_pulling = self._sda_pulling = 0  # masks of the parties that pull the wire low: bit i is party i
        self._scl_ours = self._sda_ours = 0  # masks of the parties that belong to the unit
        self._parties = 0  # number of parties on both wires when the masks of the unit were computed
        self._tick = NO_TIME
        self._settled = True

    def attach(self, scl: Wire, sda: Wire) -> None:
        """Subscribe to these wires."""
        self._scl_wire, self._sda_wire = scl, sda
        scl.watch_pulls(self, SCL)
        sda.watch_pulls(self, SDA)

    def pulled(self, line: int, now: int, pulling: int) -> None:
        if now != self._tick:
            self.settle()
            self._tick = now
        self._settled = False
        if line == SCL:
            self._scl_pulling = pulling
        else:
            self._sda_pulling = pulling

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self.settle()
        if self.phase_at != NO_TIME:
            for number in range(SKIPPED_BITS):
                at = times.rise(number)
                self.held(at, at)
                if not number:
                    self._first_bit(at, at)
        self.stream.skip(shown)
        self._sda_pulling = self._sda_wire.pulling
        self.others_held_until = NO_TIME

    def settle_before(self, tick: int) -> None:
        """Evaluate the changes of the tick in progress, if this tick is before `tick`."""
        if self._tick != tick:
            self.settle()

    def settle(self) -> None:
        """Evaluate the changes of the tick in progress. Call this after the last of these changes."""
        if self._settled:
            return
        self._settled = True
        now = self._tick
        scl, sda = 0 if self._scl_pulling else 1, 0 if self._sda_pulling else 1
        event: int = self.stream.sample(scl | sda << 1) & KINDS
        if event == START:
            if self.phase_at == NO_TIME:
                self.started(now)
            self.phase_at, self.ours = now, False
        elif event == STOP:
            self.stopped(now)
            self.phase_at = NO_TIME
        elif event == RISE:
            self._rises(now)
        elif not scl:
            if self._held_by_others():
                self.others_held_until = NO_TIME
            elif event == FALL or self.others_held_until == NO_TIME:
                self.others_held_until = now

    def held_by_us_alone(self) -> bool:
        """Return True if SCL is low and only the unit holds it."""
        return self._scl_pulling != 0 and not self._held_by_others()

    def _held_by_others(self) -> bool:
        if not self._scl_pulling:
            return False
        self._know_parties()
        return self._scl_pulling & ~self._scl_ours != 0

    def _know_parties(self) -> None:
        """Update the masks of the unit's parties if further parties were attached to the wires since the last call."""
        scl, sda = self._scl_wire, self._sda_wire
        if scl.attached + sda.attached != self._parties:
            self._parties = scl.attached + sda.attached
            self._scl_ours, self._sda_ours = scl.mask_of_parties(self._unit), sda.mask_of_parties(self._unit)

    def _rises(self, now: int) -> None:
        if self.phase_at == NO_TIME:
            return
        let_go = now if self.others_held_until == NO_TIME else self.others_held_until
        stream = self.stream
        self.held(let_go, now)
        if stream.bits == 1:
            self._first_bit(let_go, now)
        elif stream.bits == BITS and stream.index < 0:
            self._know_parties()
            self.ours = self._sda_pulling & self._sda_ours != 0

    def _first_bit(self, let_go: int, rose: int) -> None:
        if self.stream.index >= 0 and self.stream.acked:
            self.first_bit(let_go, rose)

    # Events, handled by subclasses ---------------------------------------------------------------------------

    def started(self, now: int) -> None:
        """Handle a START that is not a repeated START."""

    def stopped(self, now: int) -> None:
        """Handle a STOP."""

    def held(self, let_go: int, rose: int) -> None:
        """Handle the rise of SCL at the tick `rose`.

        let_go: the tick, at most `rose`, since which no party except the unit has held SCL low.
        """

    def first_bit(self, let_go: int, rose: int) -> None:
        """Handle the rise of SCL after an acknowledged byte: first bit of a data byte, repeated START or STOP."""
