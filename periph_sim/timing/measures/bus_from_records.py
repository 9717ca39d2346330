"""What happens on an I2C bus, read off records of its wires: edges and who holds a low line go in, bytes come out.

    EDGE, HOLD of SCL and SDA --> START, address, ACK, first bit of each byte, STOP; when the others had let go of SCL

No agent and no firmware is asked, so that whoever is the controller is heard alike. All that is recorded of one tick is
one sample: START and STOP are a change of SDA while SCL was high before and stays so.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from ...core.records import Kind, Record
from ...core.time import NO_TIME

SCL, SDA = "SCL", "SDA"
KINDS = frozenset({Kind.EDGE, Kind.HOLD})
SUBJECTS = {Kind.EDGE: {SCL, SDA}, Kind.HOLD: {SCL, SDA}}
BITS = 9  # of a byte, its ACK included


class BusFromRecords:
    """unit: whose pins are ours, "" for none. Subclasses say what they do with what they hear."""

    def __init__(self, unit: str) -> None:
        self.address = 0
        self.read = False
        self.ours = False  # the address was acknowledged by the unit
        self.index = -1  # -1: the address, else the number of the data byte
        self.phase_at = NO_TIME  # START or repeated START of the phase under way; NO_TIME behind a STOP
        self.others_held_until = NO_TIME  # when the others let go of SCL in the low time under way, or the last one
        self._unit = f"{unit}."
        self._scl = self._sda = 1
        self._scl_holders = self._sda_holders = ""  # as records tell them
        self._tick = NO_TIME
        self._scl_before = self._sda_before = 1  # levels as the tick under way began
        self._settled = True
        self._acked = False  # the byte before
        self._bits = 0
        self._in = 0

    def hear(self, record: Record) -> None:
        """A record of one of the wires, in the order in which they are made."""
        where = record.where
        if where != SCL and where != SDA:
            return
        if record.tick != self._tick:
            self.settle()
            self._tick = record.tick
        self._settled = False
        if where == SCL:
            if record.kind is Kind.EDGE:
                self._scl = record.value
            self._scl_holders = "" if self._scl else record.text
        else:
            if record.kind is Kind.EDGE:
                self._sda = record.value
            self._sda_holders = "" if self._sda else record.text

    def settle_before(self, tick: int) -> None:
        """All of the ticks before this one has been heard."""
        if self._tick != tick:
            self.settle()

    def settle(self) -> None:
        """All of the last tick has been heard."""
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
        """SCL is low and nobody but the unit holds it."""
        return not self._scl and not self._held_by_others()

    def _held_by_others(self) -> bool:
        holders = self._scl_holders
        return holders != "" and any(not who.startswith(self._unit) for who in holders.split(", "))

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
            self.ours = any(who.startswith(self._unit) for who in self._sda_holders.split(", "))

    def _falls(self, now: int) -> None:
        self.others_held_until = NO_TIME
        if self._bits == BITS:
            self.index += 1
            self._bits = self._in = 0

    # What is heard ------------------------------------------------------------------

    def started(self, now: int) -> None:
        """A START that is no repeated one."""

    def stopped(self, now: int) -> None:
        """A STOP."""

    def held(self, let_go: int, rose: int) -> None:
        """SCL rose; the others had let go of it before, or just then."""

    def first_bit(self, let_go: int, rose: int) -> None:
        """SCL rose for the first bit of data byte `index`, as the byte before was acknowledged; or for a STOP."""
