"""Registers in the notation of firmware: attributes that make bus accesses.

i2c.I2CSTR.AAS                reads the register and returns the field
i2c.I2CMDR.IRS = 0            reads the register, changes the field, and writes the register
i2c.I2CDXR.all = 0x5A         makes one write
gpio.GPADAT.GPIO28 = 1        reads and writes the upper 16 bits, since bit fields of TI's headers are in 16-bit words
timer.PRD.all = 30_000_000    makes one 32-bit write of PRD and PRDH, as `all` of TI's headers
timer.PRD.half.MSW            makes a 16-bit read of PRDH
i2c.I2CSTR.when(XRDY=1)       makes no access; returns the condition XRDY == 1 for a wait

A `Port` represents one register of one unit. Each register has its own subclass of `Port`, which is made once in a
process. In this subclass, each field of the register is an attribute of the type `PortField`, and so is `all`.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping
from operator import index
from typing import final

from ...core.phrases import did_you_mean
from ...core.registers import Field, Register
from ...f28335.memory.memory_map import BOTH, HIGH, LOW, WORDS_MASK, ModuleRange
from ...form.c_types import BigInt, Text
from ..operand import Operand
from ..source_location import SourceLocation
from ..user_code import Misuse
from .cpu import Cpu

EQUAL, UNEQUAL, BELOW, ABOVE = range(4)  # how a condition compares bits with a value


@final
class Condition:
    """A comparison of bits of a register with a value. `holds` makes the read of one pass of a wait."""

    def __init__(
        self,
        cpu: Cpu,
        operand: Operand,
        mask: int,
        value: int,
        test: int = EQUAL,
        where: SourceLocation | None = None,
    ) -> None:
        """mask, value: the bits to compare, and their value, at their positions in the register.

        where: the statement with the condition; None if it is not known.
        """
        self._cpu = cpu
        self._operand = operand
        self._mask = mask
        self._value = value
        self._test = test
        self._where = where

    def holds(self) -> bool:
        """Read the register, which takes the cycles of a read, and return True if the condition is true."""
        bits, test = self._cpu.read(self._operand, self._where) & self._mask, self._test
        if test == EQUAL:
            return bits == self._value
        if test == UNEQUAL:
            return bits != self._value
        return bits < self._value if test == BELOW else bits > self._value

    def __call__(self) -> bool:
        return self.holds()

    def __bool__(self) -> bool:
        raise Misuse(f"a condition on {self._operand} has no value by itself; give it to dsp.spin, or call it")


class Port:
    """One register of one module of a unit. Its attributes are descriptors of the type `PortField`.

    where: the name of the register, "I2C-A.I2CSTR". fields: the names of its fields. Subclasses set both.
    """

    __slots__ = ("_cpu", "_fields", "_half", "_operands", "_place")
    where = ""
    fields: tuple[str, ...] = ()

    def __init__(self, cpu: Cpu, place: ModuleRange, fields: dict[str, PortField]) -> None:
        self._cpu = cpu
        self._place = place
        self._fields = fields
        self._half: Port | None = None
        self._operands: list[Operand | None] = [None] * len(fields)  # index: `PortField.number`; made at first access

    def __setattr__(self, name: str, value: int) -> None:
        if name in STATE:
            object.__setattr__(self, name, value)  # the compiled class sets these attributes without this method
        else:
            self._assign(name, value)

    def _assign(self, name: Text, value: BigInt) -> None:
        field: PortField | None = self._fields.get(name)
        if field is None:
            if name not in self.fields:
                raise no_such_name(self.where, name, self.fields)
            raise AttributeError(f"{self.where}.{name} cannot be assigned to; it has names of its own, which can")
        field.assign(self, value)

    def when(self, *, mask: object = None, value: object = None, **wanted: object) -> Condition:
        """Return the condition that a field has a value, when(XRDY=1), or that register & mask == value.

        Raise AttributeError for an unknown field, and Misuse for any other wrong arguments.
        """
        if len(wanted) + (mask is not None or value is not None) != 1 or (mask is None) != (value is None):
            raise Misuse(f"{self.where}.when needs one field and its number, when(NAME=1), or a mask= and a value=")
        name = next(iter(wanted), "all")
        if name not in self._fields:
            raise no_such_name(self.where, name, self.fields)
        field = self._fields[name]
        return field.condition(self, wanted[name]) if wanted else field.masked(self, mask, value)

    def comparison(self, name: Text, number: BigInt, test: int, where: SourceLocation | None) -> Condition | None:
        """Return the condition that compares a named field with a number, as `PortField.comparison` does.

        Return None also if the register has no such field.
        """
        found = self._fields.get(name)
        return None if found is None else found.comparison(self, number, test, where)

    def _inner(self, made: type[Port], fields: dict[str, PortField]) -> Port:  # core: python
        """Return the port for the two halves of the register. The port is made at the first call."""
        if self._half is None:
            self._half = made(self._cpu, self._place, fields)
        return self._half


STATE = frozenset(Port.__slots__)


@final
class PortField:
    """A named attribute of a port: a field, or whole words of the register.

    number: the index of this name among the names of the port. mask: the bits of the register that this name selects.
    """

    def __init__(self, number: int, register: Register, words: int, field: Field | None, where: str) -> None:
        """words: the words that an access transfers: LOW, HIGH or BOTH. where: the full name for messages."""
        self.number = number
        self._register = register
        self._words = words
        self._field = field
        self.mask: int = WORDS_MASK[words] if field is None else field.mask
        self._lsb: int = field.lsb if field is not None else 16 if words == HIGH else 0
        self._most: BigInt = self.mask >> self._lsb
        self._where = where

    def __get__(self, port: Port, owner: object) -> int:
        return self._read(port)

    def _read(self, port: Port) -> int:
        operand: Operand = port._operands[self.number] or self._operand(port)
        return (port._cpu.read(operand) & self.mask) >> self._lsb

    def assign(self, port: Port, value: BigInt) -> None:
        if type(value) is not int or not 0 <= value <= self._most:
            value = self._fitting(value)
        operand: Operand = port._operands[self.number] or self._operand(port)
        if self._field is None:
            port._cpu.write(operand, value << self._lsb)
        else:
            port._cpu.modify(operand, value)

    def condition(self, port: Port, number: object) -> Condition:
        """Return the condition that this field has a value. Raise Misuse if the field cannot have the value."""
        value = self._whole(f"{self._where} == {number!r} never holds", number, self._most) << self._lsb
        return Condition(port._cpu, port._operands[self.number] or self._operand(port), self.mask, value)

    def comparison(self, port: Port, number: BigInt, test: int, where: SourceLocation | None) -> Condition | None:
        """Return the condition that compares this field with a number.

        Return None if a read needs more than a call of `Chip.see` (`Operand.looks` is False), if the record of a read
        needs a statement but `where` is None, or if the number does not fit the field. test: EQUAL, UNEQUAL, BELOW or
        ABOVE. where: the statement in the firmware.
        """
        operand: Operand = port._operands[self.number] or self._operand(port)
        if not operand.placed:
            where = None
        elif where is None:
            return None
        if not operand.looks or not 0 <= number <= self._most:
            return None
        return Condition(port._cpu, operand, self.mask, number << self._lsb, test, where)

    def masked(self, port: Port, mask: object, value: object) -> Condition:
        """Return the condition that register & mask == value. Raise Misuse if it can never hold, or if `mask` is 0."""
        where = f"{self._where}.when(mask={mask!r}, value={value!r})"
        bits = self._whole(f"{where}: the mask does not fit", mask, self._most)
        wanted = self._whole(f"{where}: the value does not fit", value, self._most)
        if not bits:
            raise Misuse(f"{where} tests no bit; expected a mask of 1 to {self._most:#x}")
        if wanted & ~bits:
            raise Misuse(f"{where} never holds: {wanted & ~bits:#x} is outside of the mask {bits:#x}")
        return Condition(port._cpu, port._operands[self.number] or self._operand(port), bits, wanted)

    def _whole(self, what: Text, value: object, most: BigInt) -> BigInt:
        """Return a value as an int. Raise Misuse if it is no integer from 0 to `most`. what: the error, as text."""
        try:
            number = index(value)  # type: ignore[arg-type]
        except TypeError:
            number = -1
        if not 0 <= number <= most:
            raise Misuse(f"{what}; expected a whole number from 0 to {most:#x}")
        return number

    def _operand(self, port: Port) -> Operand:
        operand = port._cpu.bus.operand(port._place, self._register, self._words, self._field)
        port._operands[self.number] = operand
        return operand

    def _fitting(self, value: object) -> BigInt:
        """Return a value of any integer type as an int. Raise Misuse if it is no integer or does not fit the field."""
        most = self._most
        try:
            number = index(value)  # type: ignore[arg-type]
        except TypeError:
            raise Misuse(f"{self._where} = {value!r}: expected a whole number from 0 to {most:#x}") from None
        if not 0 <= number <= most:
            raise Misuse(f"{self._where} = {number:#x}: expected 0 to {most:#x}; cut it as C would, with & {most:#x}")
        return number


def no_such_name(where: str, name: str, names: tuple[str, ...]) -> AttributeError:
    return AttributeError(f"{where} has no field {name!r}; {did_you_mean(name, names)}")


class RegisterPort(Port):  # core: python
    """One register of one module. Field names are attributes; `all` is the whole register."""

    __slots__ = ()

    def __getattr__(self, name: str) -> int:
        """Raise AttributeError: no such field exists."""
        raise no_such_name(self.where, name, self.fields)


Ports = tuple[Register, type[RegisterPort], dict[str, PortField]]

_made: dict[str, Ports] = {}  # maps the full name of a register to the class and fields that its ports in all units use


def register_port(cpu: Cpu, place: ModuleRange, register: Register) -> RegisterPort:  # core: python
    """Return the object through which firmware accesses a register (see `Port`)."""
    where = f"{place.name}.{register.name}"
    found = _made.get(where)
    if found is None or found[0] is not register:
        found = _made[where] = _ports_of(where, register)
    _, made, fields = found
    return made(cpu, place, fields)


def _ports_of(where: str, register: Register) -> Ports:
    words_of = {f.name: (LOW if f.mask & 0xFFFF else 0) | (HIGH if f.mask >> 16 else 0) for f in register.fields}
    named = [(f.name, words_of[f.name], f) for f in register.fields]
    fields = _fields(where, register, [*named, ("all", BOTH if register.width == 32 or register.upper else LOW, None)])
    names = tuple(f.name for f in register.fields)
    if not register.upper:
        return register, _class(where, names, fields), fields
    half = _fields(f"{where}.half", register, [("LSW", LOW, None), ("MSW", HIGH, None)])
    halves = _class(f"{where}.half", tuple(half), half)
    inner = property(lambda port: port._inner(halves, half))
    return register, _class(where, (*names, "half"), {**fields, "half": inner}), fields


def _fields(where: str, register: Register, named: list[tuple[str, int, Field | None]]) -> dict[str, PortField]:
    return {
        name: PortField(number, register, words, f, where if name == "all" else f"{where}.{name}")
        for number, (name, words, f) in enumerate(named)
    }


def _class(where: str, names: tuple[str, ...], ports: Mapping[str, object]) -> type[RegisterPort]:
    return type(where, (RegisterPort,), {"__slots__": (), "where": where, "fields": names, **ports})


@final
class ModulePort:
    """The registers of one module by name. A port is made at its first use, since firmware uses few registers."""

    __dict__: dict[str, RegisterPort]

    def __init__(self, cpu: Cpu, place: ModuleRange) -> None:
        self._cpu = cpu
        self._place = place
        self._made: dict[str, RegisterPort] = {}

    def __getattr__(self, name: str) -> RegisterPort:
        """Make the port at its first use; later it is a plain attribute."""
        registers = self._place.socket.chip.MAP
        if name not in registers:
            near = did_you_mean(name, [r.name for r in registers])
            raise AttributeError(f"{self._place.name} has no register {name!r}; {near}")
        port = self._made[name] = vars(self)[name] = register_port(self._cpu, self._place, registers[name])
        return port

    def __setattr__(self, name: str, value: object) -> None:
        """Raise AttributeError, except for private names: registers are written through their fields or `all`."""
        if name.startswith("_"):
            object.__setattr__(self, name, value)
            return
        self[name]  # raises AttributeError for an unknown name
        raise AttributeError(f"{self._place.name}.{name} is a register; write {name}.all = ... or a field of it")

    def __getitem__(self, name: str) -> RegisterPort:
        return self._made[name] if name in self._made else self.__getattr__(name)
