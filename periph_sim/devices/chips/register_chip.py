"""Base of chips with 8-bit registers behind a pointer: stored values, reads and writes by a register map, notes.

    RegisterPointer --> begin, read, write --> the chip's own rules --> stored registers, notes
                                                  ^--- samples due since the last call, from a Source

A chip does not depend on the event queue, wires or records. Times are ticks of a Timebase. Each access passes the
present time to the chip, which then takes the samples that are due by this time. So a chip needs no events of its own.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import isfinite
from typing import Any, Literal

from ...core.chip import Note
from ...core.registers import Bits as Bits
from ...core.registers import NamedByte, OnWrite, Register, RegisterMap
from ...core.registers import byte_register as byte_register
from ...core.state import State
from ...core.time import Clock, Timebase

# A Source is a function of a tick that returns x, y and z in the chip's physical unit.
Source = Callable[[int], Sequence[float | Fraction]]


class RegisterChip:
    """Base of the chips that are read and written as registers.

    address: seven bits.
    stored: the stored values by register number.
    notes: the notes since the owner last cleared the list.
    touched: names of the options that have affected a value that was read, or the chip's behaviour on the bus.
    powered: the tick at which the supply was switched on.
    ready: given as a delay in seconds from `powered`; stored as the tick from which the chip acknowledges its address.
    """

    STATE = State("stored", ticks="ready")
    MAP: RegisterMap
    SECTION: str  # section of the data sheet on register access
    ADDRESSES: tuple[int, ...]  # possible addresses, 7 bits each, the usual one first
    OPTIONS: type[Any]  # options for open questions of the data sheet
    DATA: tuple[str, ...] = ()  # the data registers, two for each axis, in the order of their addresses
    BYTE_ORDER: Literal["big", "little"] = "big"  # order of the two registers of an axis
    UNIT = ""  # the physical unit of x, y and z

    def __init_subclass__(cls) -> None:
        """If a subclass defines `catch_up`, the former name of `advance_to`, use it as `advance_to`, and warn."""
        super().__init_subclass__()
        former = vars(cls).get("catch_up")
        if former is not None and "advance_to" not in vars(cls):
            cls.advance_to = former  # type: ignore[method-assign]
            what = f"{cls.__name__}.catch_up is now called advance_to; the next release ignores the old name"
            warnings.warn(what, DeprecationWarning, stacklevel=2)
        cls.catch_up = cls.advance_to  # subclasses written for the last release may call `super().catch_up(now)`

    def __init__(self, timebase: Timebase, source: Source, address: int, powered: int, ready: Fraction) -> None:
        self.address = address
        self.source = source
        self.stored = {register.offset: register.reset for register in self.MAP}
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self.timebase = timebase
        self.ready = self.after(powered, ready)

    # Called by RegisterPointer ------------------------------------------------

    def begin(self, now: int) -> bool:
        """Begin a burst when the chip is addressed at tick `now`. Return True if the chip acknowledges its address."""
        return now >= self.ready

    def read(self, now: int, number: int) -> int:
        """Return the value of the register with this number, and apply the effects of the read.

        A reserved register reads 0, and a note is added.
        """
        self.advance_to(now)
        register = self.MAP.at(number)
        if register is None:
            self.note("duty", f"register {number:#04x} is reserved, but was read; it reads 0 here", self.SECTION)
            return 0
        return self.on_register_read(now, register)

    def write(self, now: int, number: int, value: int) -> None:
        """Write the register with this number, and apply the effects of the write.

        A write of a reserved or read-only register only adds a note.
        """
        self.advance_to(now)
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
        """Return the pointer after an access to the register with this number."""
        return number + 1 & 0xFF

    # Registers and values as text ----------------------------------------------

    def named(self, number: int, value: int, before: int | None) -> NamedByte:
        """Return the name and the meaning of a byte that is written to or was read from a register.

        before: the previous byte of the burst; None if this byte is the first.
        """
        register = self.MAP.at(number)
        if register is None:
            return NamedByte(f"{number:#04x}", "reserved")
        if register.name in self.DATA:
            second = self.DATA.index(register.name) & 1
            if not second or before is None:
                return NamedByte(register.name)
            word = int.from_bytes((before, value), self.BYTE_ORDER, signed=True)
            return NamedByte(register.name, f"{word} = {self.quantity(word)}")
        return register.named(value)

    def quantity(self, word: int) -> str:
        """Format the quantity in a data word, at the present scale, with its unit."""
        return f"{float(word / self.lsb_per_unit):.4g} {self.UNIT}"

    # Implemented by each chip ---------------------------------------------------------

    @property
    def lsb_per_unit(self) -> Fraction:
        """Number of LSB in one physical unit at the present scale."""
        raise NotImplementedError

    def advance_to(self, now: int) -> None:
        """Take the samples that are due up to tick `now`."""

    catch_up = advance_to

    def on_register_read(self, now: int, register: Register) -> int:
        return self.stored[register.offset]

    def on_register_write(self, now: int, register: Register, old: int) -> None:
        """Apply the effects of a write. `stored` already has the new value."""

    # Helpers ------------------------------------------------------------------------

    def note(self, code: str, text: str, source: str) -> None:
        self.notes.append(Note(code, text, source))

    def get(self, name: str, field_name: str = "") -> int:
        """Return the stored value of a register, or of one of its fields."""
        register = self.MAP[name]
        value = self.stored[register.offset]
        return register[field_name].extract(value) if field_name else value

    def put(self, name: str, field_name: str, number: int) -> None:
        """Set a field as the chip does, regardless of the access rights of software."""
        register = self.MAP[name]
        self.stored[register.offset] = register[field_name].put(self.stored[register.offset], number)

    def after(self, tick: int, length: Fraction) -> int:
        """Return the tick that is `length` seconds later than `tick`, rounded up."""
        return tick + self.timebase.ticks(length, "up")

    def beats(self, first: int, rate: Fraction) -> Clock:
        """Return a clock: cycle 0 begins at tick `first`, and cycle n begins n / rate seconds later, rounded down."""
        return Clock(self.timebase, rate, tick0=first)


def nearest(value: float | Fraction) -> int:
    """Return the nearest whole number, with halves rounded to even. Raise ValueError for NaN and infinity."""
    if not isfinite(value):
        raise ValueError(f"a chip's source gave {value}; a sample needs a finite number")
    return round(value)


def clipped(value: int, least: int, most: int) -> int:
    return max(least, min(most, value))
