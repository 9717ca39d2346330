"""Bytes on an I2C bus, derived from the levels of its wires and the parties that pull them.

    SCL, SDA, who pulls --> START, address, ACK, first bit of each byte, STOP; when the others had let go of SCL

Only the wires are read, so any controller is treated alike. All changes within one tick form one
sample: START and STOP are a change of SDA while SCL was high before and stays so.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

# core: compiled

from __future__ import annotations

from ...bus.i2c.bit_skip import BitParty
from ...bus.i2c.bit_times import SKIPPED_BITS, BitTimes
from ...core.time import NO_TIME
from ...core.wire import Wire

SCL, SDA = 0, 1  # which wire it is that is pulled
BITS = 9  # of a byte, its ACK included


class BusFromWires(BitParty):
    """unit: the one whose pins are called ours, "" for none. Subclasses override the events at the end of the class."""

    _unit: str

    def __init__(self, unit: str) -> None:
        self.address = 0
        self.read = False
        self.ours = False  # the address was acknowledged by the unit
        self.index = -1  # -1: the address, else the number of the data byte
        self.phase_at = NO_TIME  # START or repeated START of the phase under way; NO_TIME after a STOP
        self.others_held_until = NO_TIME  # when the others let go of SCL in the low time under way, or the last one
        self._unit = f"{unit}."
        self._scl = self._sda = 1
        self._scl_pulling = self._sda_pulling = 0  # the parties that pull it: bit i is party i
        self._scl_ours = self._sda_ours = 0  # those of the known parties that belong to the unit
        self._parties = 0  # number of parties of both wires that are known
        self._tick = NO_TIME
        self._scl_before = self._sda_before = 1  # levels as the tick under way began
        self._settled = True
        self._acked = False  # the byte before
        self._bits = 0
        self._in = 0

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
            self._scl, self._scl_pulling = 0 if pulling else 1, pulling
        else:
            self._sda, self._sda_pulling = 0 if pulling else 1, pulling

    def edge(self, tick: int, levels: int) -> None:
        for line, wire, known in ((SCL, self._scl_wire, self._scl_pulling), (SDA, self._sda_wire, self._sda_pulling)):
            if wire.pulling != known:
                self.pulled(line, tick, wire.pulling)

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self.settle()
        if self.phase_at != NO_TIME:
            for number in range(SKIPPED_BITS):
                at = times.rise(number)
                self.held(at, at)
                if not number and self.index >= 0 and self._acked:
                    self.first_bit(at, at)
            self._bits, self._in = SKIPPED_BITS, shown >> 1
        self._sda = self._sda_before = shown & 1
        self._sda_pulling = self._sda_wire.pulling
        self.others_held_until = NO_TIME

    def settle_before(self, tick: int) -> None:
        """Evaluate the tick under way if it is before this one."""
        if self._tick != tick:
            self.settle()

    def settle(self) -> None:
        """Evaluate the tick under way: no more changes come in it."""
        if self._settled:
            return
        self._settled = True
        scl, sda, now = self._scl, self._sda, self._tick
        scl_before, sda_before = self._scl_before, self._sda_before
        self._scl_before, self._sda_before = scl, sda
        if scl and scl_before:
            if sda != sda_before:
                self._condition(now, sda)
        elif scl:
            self._rises(now)
        else:
            if scl_before:
                self._falls(now)
            if self._held_by_others():
                self.others_held_until = NO_TIME
            elif self.others_held_until == NO_TIME:
                self.others_held_until = now

    def held_by_us_alone(self) -> bool:
        """Return True if SCL is low and only the unit holds it."""
        return not self._scl and not self._held_by_others()

    def _held_by_others(self) -> bool:
        if not self._scl_pulling:
            return False
        if self._scl_wire.attached + self._sda_wire.attached != self._parties:
            self._know_parties()
        return self._scl_pulling & ~self._scl_ours != 0

    def _know_parties(self) -> None:
        """Update the masks of the unit's parties; parties may be attached at any time and are never removed."""
        self._parties = self._scl_wire.attached + self._sda_wire.attached
        self._scl_ours, self._sda_ours = (
            self._scl_wire.mask_of_parties(self._unit),
            self._sda_wire.mask_of_parties(self._unit),
        )

    def _condition(self, now: int, sda: int) -> None:
        if sda:
            self.stopped(now)
            self.phase_at = NO_TIME
        else:
            if self.phase_at == NO_TIME:
                self.started(now)
            self.phase_at, self.index, self._bits, self._in, self.ours = now, -1, 0, 0, False

    def _rises(self, now: int) -> None:
        if self.phase_at == NO_TIME:
            return
        let_go = now if self.others_held_until == NO_TIME else self.others_held_until
        self.held(let_go, now)
        if self._bits == 0 and self.index >= 0 and self._acked:
            self.first_bit(let_go, now)
        self._bits += 1
        self._in = self._in << 1 | self._sda
        if self._bits == BITS:
            self._acked = not self._sda
        if self._bits == BITS and self.index < 0:
            self.address, self.read = self._in >> 2 & 0x7F, bool(self._in >> 1 & 1)
            if self._scl_wire.attached + self._sda_wire.attached != self._parties:
                self._know_parties()
            self.ours = self._sda_pulling & self._sda_ours != 0

    def _falls(self, now: int) -> None:
        self.others_held_until = NO_TIME
        if self._bits == BITS:
            self.index += 1
            self._bits = self._in = 0

    # Events ---------------------------------------------------------------------------

    def started(self, now: int) -> None:
        """Handle a START that is not a repeated one."""

    def stopped(self, now: int) -> None:
        """Handle a STOP."""

    def held(self, let_go: int, rose: int) -> None:
        """Handle a rise of SCL. let_go: when the others released it, at `rose` or before."""

    def first_bit(self, let_go: int, rose: int) -> None:
        """Handle the rise of SCL for the first bit of data byte `index`, after an acknowledged byte, or for a STOP."""
