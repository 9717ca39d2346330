"""What chips with 8-bit registers behind a pointer have in common: a map goes in; stored values, notes, reads, writes.

    RegisterPointer --> begin, read, write --> the chip's own rules --> stored registers, notes
                                                  ^--- samples that fell due since, taken from a Source

A chip is pure: it knows no kernel, wire or record. Its time is ticks of a Timebase; it is told the time with every
call and then catches up, so a chip that nobody asks costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import isfinite
from typing import Any

from ...core.chip import Note
from ...core.registers import OnWrite, Register, RegisterMap, field
from ...core.time import Clock, Timebase

Source = Callable[[int], Sequence[float | Fraction]]  # tick -> x, y, z in the chip's physical unit
Bits = tuple[tuple[str, str], ...]  # names and places of fields: ("Measure", "3")


def byte_register(offset: int, name: str, access: str, reset: int, source: str, fields: Bits = ()) -> Register:
    """A register of eight bits; without `fields` it is one field that bears its name."""
    parts = [field(n, bits, access) for n, bits in fields or ((name, "7:0"),)]
    parts = [field(f.name, f.bits, access, f.of(reset)) for f in parts]
    return Register(name, offset, source, tuple(parts), width=8)


class RegisterChip:
    """address: seven bits. stored: register number -> value. notes: since the owner last cleared it.

    touched: open questions on whose option something depended that was read, or that the bus saw.
    powered: the tick at which the supply came. ready: seconds after it, then the tick from which on the chip
    acknowledges its address.
    """

    MAP: RegisterMap
    SECTION: str  # of the data sheet on register access
    ADDRESSES: tuple[int, ...]  # 7 bits each, the usual one first
    OPTIONS: type[Any]  # what its data sheet leaves open

    def __init__(self, timebase: Timebase, source: Source, address: int, powered: int, ready: Fraction) -> None:
        self.address = address
        self.source = source
        self.stored = {register.offset: register.reset for register in self.MAP}
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self.timebase = timebase
        self.ready = self.after(powered, ready)

    # What a RegisterPointer asks ------------------------------------------------

    def begin(self, now: int) -> bool:
        """It is addressed: a burst begins. False: it does not acknowledge yet."""
        return now >= self.ready

    def read(self, now: int, number: int) -> int:
        """What a read of this register gives, with all that the read does."""
        self.catch_up(now)
        register = self.MAP.at(number)
        if register is None:
            self.note("duty", f"register {number:#04x} was read, which is reserved; it reads 0 here", self.SECTION)
            return 0
        return self.on_register_read(now, register)

    def write(self, now: int, number: int, value: int) -> None:
        """A write to this register, with all that it does."""
        self.catch_up(now)
        register = self.MAP.at(number)
        if register is None:
            self.note("duty", f"{value:#04x} was written to {number:#04x}, which is reserved", self.SECTION)
        elif not register.mask(OnWrite.STORE):
            self.note("duty", f"{value:#04x} was written to {register.name}, which is read-only", register.source)
        else:
            old = self.stored[number]
            self.stored[number], _ = register.write(old, value)
            self.on_register_write(now, register, old)

    def following(self, number: int) -> int:
        """Where the pointer goes after an access to this register."""
        return number + 1 & 0xFF

    # What a chip fills in ---------------------------------------------------------

    @property
    def lsb_per_unit(self) -> Fraction:
        """LSB of one physical unit at the scale that is set up."""
        raise NotImplementedError

    def catch_up(self, now: int) -> None:
        """Take the samples that fell due up to now."""

    def on_register_read(self, now: int, register: Register) -> int:
        return self.stored[register.offset]

    def on_register_write(self, now: int, register: Register, old: int) -> None:
        """`stored` has the new value already."""

    # Helpers ------------------------------------------------------------------------

    def note(self, code: str, text: str, source: str) -> None:
        self.notes.append(Note(code, text, source))

    def get(self, name: str, field_name: str = "") -> int:
        """The stored value of a register, or of one of its fields."""
        register = self.MAP[name]
        value = self.stored[register.offset]
        return register[field_name].of(value) if field_name else value

    def put(self, name: str, field_name: str, number: int) -> None:
        """Set a field from inside, whatever software may do with it."""
        register = self.MAP[name]
        self.stored[register.offset] = register[field_name].put(self.stored[register.offset], number)

    def after(self, tick: int, length: Fraction) -> int:
        """The tick so many seconds later."""
        return tick + self.timebase.ticks(length, "up")

    def beats(self, first: int, rate: Fraction) -> Clock:
        """A clock whose cycle 0 begins at `first`, and cycle n exactly n / rate later (rounded down to a tick)."""
        return Clock(self.timebase, rate, tick0=first)


def nearest(value: float | Fraction) -> int:
    """The nearest whole number, halves to the even one. ValueError for NaN and infinity."""
    if not isfinite(value):
        raise ValueError(f"a chip's source gave {value}; a sample needs a finite number")
    return round(value)


def clipped(value: int, least: int, most: int) -> int:
    return max(least, min(most, value))
