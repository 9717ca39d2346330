"""Registers as data: one table, as in the manual, defines reset values, access effects, decoding and docs.

A field has four independent properties: the CPU's access rights, the effect of a read, the effect of a write, and the
priority when hardware and software act in the same cycle. The chip stores the values of its registers. This module
computes the effects of accesses on these values.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import cached_property
from typing import NamedTuple

from msgspec import Struct

from .phrases import did_you_mean


class RegisterMapError(Exception):
    """Error: the description of a register contradicts itself."""


class CpuAccess(Enum):
    """Access rights of the CPU to a field."""

    RW = "read and write"
    R = "read only"
    W = "write only, reads 0"


class OnRead(Enum):
    """Effect of a CPU read on the stored field."""

    KEEP = "nothing"
    CLEAR = "clears it"


class OnWrite(Enum):
    """Effect of a CPU write on the stored field."""

    STORE = "takes the value"
    ONE_CLEARS = "1 clears, 0 leaves"
    ONE_SETS = "1 sets, 0 leaves"
    STROBE = "1 fires an action, nothing is stored"
    NOTHING = "ignored"


class Tie(Enum):
    """The side that has priority if hardware sets a field in the same cycle in which the CPU writes it."""

    SOFTWARE = "software"
    HARDWARE = "hardware"


class Yields(Enum):
    """Kind of value that a read of a register yields."""

    STATE = "the state set by hardware or software; each change that firmware can see is an event"
    DATA = "a word that passes through it; each word is an event, even if it equals the previous one"
    TIME = "a free-running count; its changes are not events"


# The manual's abbreviations for a field's access rights, with the effects of a read and of a write.
ACCESS: dict[str, tuple[CpuAccess, OnRead, OnWrite]] = {
    "R/W": (CpuAccess.RW, OnRead.KEEP, OnWrite.STORE),
    "R": (CpuAccess.R, OnRead.KEEP, OnWrite.NOTHING),
    "R/W1C": (CpuAccess.RW, OnRead.KEEP, OnWrite.ONE_CLEARS),
    "R/S": (CpuAccess.RW, OnRead.KEEP, OnWrite.ONE_SETS),
    "RC": (CpuAccess.R, OnRead.CLEAR, OnWrite.NOTHING),
    "W1": (CpuAccess.W, OnRead.KEEP, OnWrite.STROBE),
    "W": (CpuAccess.W, OnRead.KEEP, OnWrite.STORE),
}


class Field(Struct, frozen=True, dict=True):
    name: str
    msb: int
    lsb: int
    access: str
    reset: int
    tie: Tie
    doc: str

    @property
    def cpu(self) -> CpuAccess:
        return ACCESS[self.access][0]

    @property
    def on_read(self) -> OnRead:
        return ACCESS[self.access][1]

    @property
    def on_write(self) -> OnWrite:
        return ACCESS[self.access][2]

    @cached_property
    def mask(self) -> int:
        return ((1 << (self.msb - self.lsb + 1)) - 1) << self.lsb

    @property
    def bits(self) -> str:
        """The bits as printed in the manual: "7" or "12:8"."""
        return f"{self.msb}" if self.msb == self.lsb else f"{self.msb}:{self.lsb}"

    def extract(self, value: int) -> int:
        """Return the value that this field has in a register value."""
        return (value & self.mask) >> self.lsb

    def put(self, value: int, number: int) -> int:
        """Return `value` with this field set to `number`; bits that do not fit are cut off, as in C."""
        return value & ~self.mask | number << self.lsb & self.mask


def field(
    name: str, bits: str, access: str = "R/W", reset: int = 0, doc: str = "", *, tie: Tie = Tie.SOFTWARE
) -> Field:
    """Return a field. bits: its bits as printed in the manual ("7", "12:8"). access: a key of ACCESS."""
    msb, _, lsb = bits.partition(":")
    if access not in ACCESS:
        raise RegisterMapError(f"{name}: access {access!r} is none of {', '.join(ACCESS)}")
    return Field(name, int(msb), int(lsb or msb), access, reset, tie, doc)


class NamedByte(NamedTuple):
    """The name and the meaning of a byte of a transfer.

    register: for a data byte, the name of the register or the memory address. For an address byte, the name of the
        device. For a byte that selects a register, "pointer". For a byte without a name, "".
    meaning: for a data byte, the fields of the register, the measured quantity, a remark such as "reserved", or "" if
        the name says everything. For the last byte of a pointer, the name of the selected register. Otherwise "".
    """

    register: str
    meaning: str = ""


class Register(Struct, frozen=True, dict=True):
    """A register of a module. offset: the distance from the module's base in 16-bit words.

    source: the document and section that describe the register.
    """

    name: str
    offset: int
    source: str
    fields: tuple[Field, ...]
    protected: bool = False  # True if writes need EALLOW
    width: int = 16
    yields: Yields = Yields.STATE
    read_acts: bool = False  # True if a read has an effect beyond its fields: it takes a word from a FIFO, for example
    data: str = ""  # the name of the field that contains the data word, if `yields` is DATA
    # The name of the register with bits 31:16, if C headers join it and this register (bits 15:0) to a 32-bit register.
    upper: str = ""

    def __post_init__(self) -> None:
        if (self.yields is Yields.DATA) != bool(self.data):
            raise RegisterMapError(f"{self.name} yields {self.yields.name}, and its data field is {self.data!r}")
        seen = 0
        for f in self.fields:
            if f.mask >> self.width:
                raise RegisterMapError(f"{self.name}.{f.name} [{f.bits}] does not fit {self.width} bits")
            if f.mask & seen:
                raise RegisterMapError(f"{self.name}.{f.name} [{f.bits}] overlaps a field above it")
            if f.reset << f.lsb & ~f.mask:
                raise RegisterMapError(f"{self.name}.{f.name} resets to {f.reset:#x}, wider than [{f.bits}]")
            seen |= f.mask

    def __getitem__(self, name: str) -> Field:
        found = self._by_name.get(name)
        if found is None:
            raise KeyError(f"{self.name} has no field {name!r}; {did_you_mean(name, self._by_name)}")
        return found

    def __contains__(self, name: str) -> bool:
        return name in self._by_name

    @cached_property
    def _by_name(self) -> dict[str, Field]:
        return {f.name: f for f in self.fields}

    @cached_property
    def named_fields(self) -> tuple[tuple[str, int, int], ...]:
        """The full name of each field, such as "I2CSTR.XRDY", with its mask and its lowest bit."""
        return tuple((f"{self.name}.{f.name}", f.mask, f.lsb) for f in self.fields)

    def mask(self, on_write: OnWrite) -> int:
        """Return the mask of all fields on which a write has this effect."""
        return sum(f.mask for f in self.fields if f.on_write is on_write)

    @cached_property
    def reads_are_harmless(self) -> bool:
        """True if a CPU read changes neither this register nor anything else."""
        return not self.read_acts and all(f.on_read is OnRead.KEEP for f in self.fields)

    @cached_property
    def reads_take(self) -> bool:
        """True if a read removes the data word that it returns, or clears a field of this register."""
        word = self.yields is Yields.DATA and self.read_acts
        return word or any(f.on_read is OnRead.CLEAR for f in self.fields)

    @cached_property
    def reset(self) -> int:
        return sum(f.reset << f.lsb for f in self.fields)

    @cached_property
    def _masks(self) -> tuple[int, int, int, int, int]:
        hard = sum(f.mask for f in self.fields if f.tie is Tie.HARDWARE)
        return (
            self.mask(OnWrite.STORE),
            self.mask(OnWrite.ONE_CLEARS),
            self.mask(OnWrite.ONE_SETS),
            self.mask(OnWrite.STROBE),
            hard,
        )

    @cached_property
    def _read_masks(self) -> tuple[int, int]:
        shown = sum(f.mask for f in self.fields if f.cpu is not CpuAccess.W)
        cleared = sum(f.mask for f in self.fields if f.on_read is OnRead.CLEAR)
        return shown, ~cleared

    def read(self, stored: int) -> tuple[int, int]:
        """Return the value that the CPU reads, and the stored value after the read. Bits without a field read 0."""
        shown, kept = self._read_masks
        return stored & shown, stored & kept

    def write(self, stored: int, written: int, set_now: int = 0) -> tuple[int, int]:
        """Return the stored value after a write, and the mask of the STROBE bits that were written as 1.

        set_now: bits that hardware sets in this cycle; they stay set in fields whose tie is HARDWARE.
        """
        store, clears, sets, strobe, hard = self._masks
        new = (stored & ~store | written & store) & ~(written & clears) | written & sets
        return new | set_now & hard, written & strobe

    def decode(self, value: int) -> str:
        """Return text such as "I2CMDR=0x0420 (MST=0x1 IRS=0x1)": name, value, and the fields that are not 0."""
        return f"{self.name}={value:#06x} ({self.fields_in(value) or 'all zero'})"

    def fields_in(self, value: int) -> str:
        """Return the fields of a value of this register as text; fields that are 0 are left out."""
        return " ".join(f"{f.name}={f.extract(value):#x}" for f in self.fields if f.extract(value))

    def named(self, value: int) -> NamedByte:
        """Return the name of this register and the meaning of its value `value`.

        The meaning is the fields that are not 0, as text; "" if there are none or the register has only one field.
        """
        return NamedByte(self.name, self.fields_in(value) if len(self.fields) > 1 else "")


Bits = tuple[tuple[str, str], ...]  # names of fields with their bits: ("Measure", "3")


def byte_register(offset: int, name: str, access: str, reset: int, source: str, fields: Bits = ()) -> Register:
    """Return a register of eight bits. Without `fields`, the register has one field, which has the register's name."""
    parts = [field(n, bits, access) for n, bits in fields or ((name, "7:0"),)]
    parts = [field(f.name, f.bits, access, f.extract(reset)) for f in parts]
    return Register(name, offset, source, tuple(parts), width=8)


class RegisterMap(Struct, frozen=True, dict=True):
    """All registers of one kind of module. source: the document of the register tables."""

    name: str
    source: str
    registers: tuple[Register, ...]

    def __post_init__(self) -> None:
        if len(self._by_offset) != len(self.registers) or len(self._by_name) != len(self.registers):
            raise RegisterMapError(f"{self.name}: two registers share a name or an offset")

    @cached_property
    def _by_offset(self) -> dict[int, Register]:
        return {r.offset: r for r in self.registers}

    @cached_property
    def _by_name(self) -> dict[str, Register]:
        return {r.name: r for r in self.registers}

    def at(self, offset: int) -> Register | None:
        """Return the register at this word offset; None if there is none."""
        return self._by_offset.get(offset)

    def __getitem__(self, name: str) -> Register:
        found = self._by_name.get(name)
        if found is None:
            raise KeyError(f"{self.name} has no register {name!r}; {did_you_mean(name, self._by_name)}")
        return found

    def __contains__(self, name: str) -> bool:
        return name in self._by_name

    def __iter__(self) -> Iterator[Register]:
        return iter(self.registers)
