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
    """A pin that is active while any of these bits of a register is set. wire: its name in a unit's `pins`."""

    wire: str
    register_name: str = field(name="register")
    bits: Bits = 0xFFFF
    active: Literal["low", "high"] = "low"


class RegisterTable(Table, frozen=True, kw_only=True):
    """A register of the device.

    at: the pointer of its first byte.
    read_only, write_1_clears, read_clears: the bits with this property, or true for all bits.
    updates: times and values of updates by the device, or the path of a .csv file with them.
    every: instead of `updates`, the period of updates by the device.
    first: the time of the first update of this period; the default is one period.
    values: the values of these updates, one after the other; the last one remains.
    step: instead of `values`, the amount that each of these updates adds.
    sets: bits that each update sets in another register.
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
            raise ValueError(f"{self.name}: every needs values or step, which define the new value")
        if bool(self.values) + bool(self.step) + bool(self.updates) > 1:
            raise ValueError(f"{self.name} has more than one of updates, values and step; keep one")
        if self.first is not None and self.every is None:
            raise ValueError(f"{self.name}: first needs every; give every, or remove first")
        if self.every == 0:
            raise ValueError(f"{self.name}: every must be longer than 0")


class Settings(Table, frozen=True, kw_only=True):
    """The register map of the device.

    pointer_counts: what one step of the pointer is, a byte or a register.
    wrap: where the pointer wraps: at the end of its own range, or at the end of the map.
    unmapped: the byte that is read where there is no register.
    """

    registers: Annotated[tuple[RegisterTable, ...], Meta(min_length=1)] = field(name="register")
    pointer_bytes: Literal[1, 2] = 1
    pointer_counts: Literal["bytes", "registers"] = "bytes"
    byte_order: Literal["big", "little"] = "big"
    auto_increment: bool = True
    wrap: Literal["pointer", "map"] = "pointer"
    unmapped: Annotated[int, Meta(ge=0, le=0xFF)] = 0
    interrupt: Interrupt | None = None
