"""The keys of [device.NAME] with model = "registers", and their checks."""

from __future__ import annotations

from collections.abc import Set
from typing import Annotated, Literal

from msgspec import Meta, field

from ...core.table import Duration, Table

Bits = Annotated[int, Meta(ge=0, le=0xFFFF)]
Pointer = Annotated[int, Meta(ge=0, le=0xFFFF)]
Mask = bool | Bits  # True means all bits


class Sets(Table, frozen=True, kw_only=True):
    """Bits that every update sets in another register, such as a data-ready flag."""

    register_name: str = field(name="register")
    bits: Bits


class Interrupt(Table, frozen=True, kw_only=True):
    """A pin that is active while any of these bits of a register is set.

    wire: a name in `pins`
    register: register that has these bits
    bits: the pin is active while any of these is set
    active: `"low"` or `"high"`
    """

    wire: str
    register_name: str = field(name="register")
    bits: Bits = 0xFFFF
    active: Literal["low", "high"] = "low"


class RegisterTable(Table, frozen=True, kw_only=True):
    """A register of the device. Keys that name bits take a mask, `0x80`, or `true` for all bits.

    name: name of the register, also used by `sets` and `interrupt`
    at: pointer of the first byte
    width: 8 or 16 bits
    reset: value at start and after power loss
    read_only: bits that writes do not change
    write_1_clears: bits cleared by writing 1
    read_clears: bits cleared by reading
    updates: values by time: `[["5 ms", 0x12], ["7 ms", 0x34]]`, or a `.csv` file with rows `5 ms,0x12`
    every: period of `values` or `step`
    first: time of the first update; one period if omitted
    values: values of successive updates; the register keeps the last one
    step: number added at each update; the sum wraps around
    sets: bits of another register set by each update: `{ register = "STATUS", bits = 0x01 }`
    """

    name: str
    at: Pointer
    width: Literal[8, 16] = 8
    reset: Bits = 0
    read_only: Mask = False
    write_1_clears: Mask = False
    read_clears: Mask = False
    updates: tuple[tuple[Duration, Bits], ...] | str = ()
    every: Duration | None = None
    first: Duration | None = None
    values: tuple[Bits, ...] = ()
    step: int = 0
    sets: Sets | None = None

    @property
    def full(self) -> int:
        """Mask of all bits of the register."""
        return (1 << self.width) - 1

    def mask(self, bits: Mask) -> int:
        """Return bits as a number; True means all bits of the register."""
        return self.full if bits is True else int(bits)

    def check_together(self, given: Set[str]) -> None:
        limited = {name: getattr(self, name) for name in ("reset", "read_only", "write_1_clears", "read_clears")}
        for name, value in limited.items():
            if value > self.full:
                raise ValueError(
                    f"{name} of {self.name} is {value:#x}, but a register of {self.width} bits ends at {self.full:#x}"
                )
        fed = [*self.values, *(() if isinstance(self.updates, str) else (value for _, value in self.updates))]
        for value in fed:
            if value > self.full:
                raise ValueError(f"{self.name} has the value {value:#x}, but {self.width} bits end at {self.full:#x}")
        if self.mask(self.read_only) & self.mask(self.write_1_clears):
            raise ValueError(
                f"bits of {self.name} are both read_only and write_1_clears; a written 1 clears or does not"
            )
        if (self.every is not None) != (bool(self.values) or bool(self.step)):
            raise ValueError(f"{self.name}: 'every' needs 'values' or 'step', which define the new value")
        if bool(self.values) + bool(self.step) + bool(self.updates) > 1:
            raise ValueError(f"{self.name} has more than one of 'updates', 'values' and 'step'; keep one")
        if self.first is not None and self.every is None:
            raise ValueError(f"{self.name}: 'first' needs 'every'; give 'every', or remove 'first'")
        if self.every == 0:
            raise ValueError(f"{self.name}: 'every' must be longer than 0")


class Settings(Table, frozen=True, kw_only=True):
    """Registers behind a pointer. A write begins with the pointer; a read continues from it.

    register: registers, `[[device.NAME.register]]`
    pointer_bytes: 1 or 2, high byte first
    pointer_counts: `"bytes"`: a 16-bit register takes two pointer values; `"registers"`: one
    byte_order: byte order of 16-bit registers: `"big"` or `"little"`
    auto_increment: the pointer advances by itself
    wrap: `"pointer"`: the pointer goes from 0xFF (0xFFFF) to 0; `"map"`: from the last register to the first
    unmapped: value read where no register is
    interrupt: interrupt pin, `[device.NAME.interrupt]`
    """

    registers: Annotated[tuple[RegisterTable, ...], Meta(min_length=1)] = field(name="register")
    pointer_bytes: Literal[1, 2] = 1
    pointer_counts: Literal["bytes", "registers"] = "bytes"
    byte_order: Literal["big", "little"] = "big"
    auto_increment: bool = True
    wrap: Literal["pointer", "map"] = "pointer"
    unmapped: Annotated[int, Meta(ge=0, le=0xFF)] = 0
    interrupt: Interrupt | None = None
