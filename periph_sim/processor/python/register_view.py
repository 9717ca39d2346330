"""Registers in the notation of firmware: attributes that make bus accesses.

i2c.I2CSTR.AAS                read the register, cut the field out
i2c.I2CMDR.IRS = 0            read the register, put the field in, write it
i2c.I2CDXR.all = 0x5A         one write
gpio.GPADAT.GPIO28 = 1        read and write of the upper 16 bits: bit fields are 16-bit words in TI's headers
timer.PRD.all = 30_000_000    one 32-bit write of PRD and PRDH, the `all` of TI's header
timer.PRD.half.MSW            16-bit read of PRDH
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from ...core.registers import Field, Register
from ...core.suggest import did_you_mean
from ...f28335.memory.memory_map import BOTH, HIGH, LOW, ModuleRange
from .cpu import Cpu
from .port_fields import Port, PortField, Registers, no_such_name


class RegisterPort(Port):  # core: python
    """One register of one module. Field names are attributes; `all` is the whole register."""

    __slots__ = ()

    def __getattr__(self, name: str) -> int:
        """Raise AttributeError: no such field exists."""
        raise no_such_name(self.where, name, self.fields)


Ports = tuple[Register, type[RegisterPort], dict[str, PortField]]

_made: dict[str, Ports] = {}  # shared data of the ports of a register, by its full name


def register_port(cpu: Cpu, place: ModuleRange, register: Register) -> RegisterPort:  # core: python
    """Return the port of one register."""
    where = f"{place.name}.{register.name}"
    found = _made.get(where)
    if found is None or found[0] is not register:
        found = _made[where] = _ports_of(where, register)
    _, made, fields = found
    return made(cpu.accesses, cpu.processor.bus, place, fields)


def _ports_of(where: str, register: Register) -> Ports:
    named: list[tuple[str, int, Field | None]] = []
    for f in register.fields:
        named.append((f.name, (LOW if f.mask & 0xFFFF else 0) | (HIGH if f.mask >> 16 else 0), f))
    named.append(("all", BOTH if register.width == 32 or register.upper else LOW, None))
    fields = _fields(where, register, named)
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
class ModulePort(Registers):
    """One module's registers by name. A port is made at its first use: firmware uses a few of a hundred."""

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
        """Raise AttributeError: registers are written through their fields or `all`."""
        if name.startswith("_"):
            object.__setattr__(self, name, value)
            return
        self[name]  # raises for an unknown name
        raise AttributeError(f"{self._place.name}.{name} is a register; write {name}.all = ... or a field of it")

    def __getitem__(self, name: str) -> RegisterPort:
        return self._made[name] if name in self._made else self.__getattr__(name)
