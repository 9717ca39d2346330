"""Registers as firmware writes them: attributes go in, bus cycles come out.

i2c.I2CSTR.AAS                read the register, cut the field out
i2c.I2CMDR.IRS = 0            read the register, put the field in, write it
i2c.I2CDXR.all = 0x5A         one write
gpio.GPADAT.GPIO28 = 1        read and write of the upper 16 bits: bit fields are 16-bit words in TI's headers
timer.PRD.all = 30_000_000    one 32-bit write of PRD and PRDH, the `all` of TI's header
timer.PRD.half.MSW            16-bit read of PRDH
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import index

from ...core.registers import Field, Register
from ...core.suggest import did_you_mean
from ...f28335.system.memory_map import BOTH, HIGH, LOW, ModuleRange
from ..error_origin import Misuse
from .cpu import Cpu


class RegisterPort:
    """One register of one module. Field names read and write; `all` is the whole register.

    Each register has a class of its own, made by `register_port`, with a property for each field.
    """

    __slots__ = ()
    where = ""  # "I2C-A.I2CSTR"
    fields: tuple[str, ...] = ()

    def __getattr__(self, name: str) -> int:
        """Only for names that are not there."""
        raise AttributeError(f"{self.where} has no field {name!r}; {did_you_mean(name, self.fields)}")

    def __setattr__(self, name: str, value: int) -> None:
        try:
            object.__setattr__(self, name, value)
        except AttributeError:
            if name not in self.fields and name != "all":
                self.__getattr__(name)
            raise


def register_port(cpu: Cpu, place: ModuleRange, register: Register) -> RegisterPort:
    """The port of one register."""
    where = f"{place.name}.{register.name}"
    names = tuple(f.name for f in register.fields)
    ports: dict[str, object] = {f.name: _field_port(cpu, place, register, f) for f in register.fields}
    ports["all"] = _words_port(cpu, place, register, BOTH if register.width == 32 or register.upper else LOW)
    if register.upper:
        halves = {"LSW": _words_port(cpu, place, register, LOW), "MSW": _words_port(cpu, place, register, HIGH)}
        half = _port(f"{where}.half", ("LSW", "MSW"), halves)
        ports["half"] = property(lambda port: half)
        names = (*names, "half")
    return _port(where, names, ports)


def _port(where: str, names: tuple[str, ...], ports: Mapping[str, object]) -> RegisterPort:
    made = type(where, (RegisterPort,), {"__slots__": (), "where": where, "fields": names, **ports})
    port = made()
    assert isinstance(port, RegisterPort)
    return port


def _words_port(cpu: Cpu, place: ModuleRange, register: Register, words: int) -> property:
    read, write, shift = cpu.accesses.read, cpu.accesses.write, 16 if words == HIGH else 0
    operand = cpu.processor.bus.operand(place, register, words)

    def value(port: RegisterPort) -> int:
        return read(operand) >> shift

    most = 0xFFFF_FFFF if words == BOTH else 0xFFFF

    def assign(port: RegisterPort, value: int) -> None:
        if type(value) is not int or not 0 <= value <= most:
            value = _fitting(value, most, port.where)
        write(operand, value << shift)

    return property(value, assign)


def _field_port(cpu: Cpu, place: ModuleRange, register: Register, f: Field) -> property:
    read, modify, mask, lsb = cpu.accesses.read, cpu.accesses.modify, f.mask, f.lsb
    most = mask >> lsb
    words = (LOW if mask & 0xFFFF else 0) | (HIGH if mask >> 16 else 0)
    operand = cpu.processor.bus.operand(place, register, words, f)

    def value(port: RegisterPort) -> int:
        return (read(operand) & mask) >> lsb

    def assign(port: RegisterPort, number: int) -> None:
        if type(number) is not int or not 0 <= number <= most:
            number = _fitting(number, most, f"{port.where}.{f.name}")
        modify(operand, number)

    return property(value, assign)


def _fitting(value: object, most: int, where: str) -> int:
    """The value as a number of Python's, whatever whole number it is. Misuse if it is none, or does not fit."""
    try:
        number = index(value)  # type: ignore[arg-type]
    except TypeError:
        raise Misuse(f"{where} = {value!r}: expected a whole number from 0 to {most:#x}") from None
    if not 0 <= number <= most:
        raise Misuse(f"{where} = {number:#x}: expected 0 to {most:#x}; cut it as C would, with & {most:#x}")
    return number


class ModulePort:
    """One module's registers by name. A port is made as it is first named: firmware uses a few of a hundred."""

    def __init__(self, cpu: Cpu, place: ModuleRange) -> None:
        self._cpu = cpu
        self._place = place
        self._registers = {r.name: r for r in place.socket.chip.MAP}
        self._made: dict[str, RegisterPort] = {}

    def __getattr__(self, name: str) -> RegisterPort:
        """Only for names that are not there yet: from then on it is a plain attribute."""
        registers: dict[str, Register] = self.__dict__["_registers"]
        if name not in registers:
            raise AttributeError(f"{self._place.name} has no register {name!r}; {did_you_mean(name, registers)}")
        port = self._made[name] = self.__dict__[name] = register_port(self._cpu, self._place, registers[name])
        return port

    def __setattr__(self, name: str, value: object) -> None:
        """Registers are written through their fields or `all`; a module has nothing else to assign to."""
        if name.startswith("_"):
            object.__setattr__(self, name, value)
            return
        self[name]  # a name that is not there is told so
        raise AttributeError(f"{self._place.name}.{name} is a register; write {name}.all = ... or a field of it")

    def __getitem__(self, name: str) -> RegisterPort:
        return self._made[name] if name in self._made else self.__getattr__(name)
