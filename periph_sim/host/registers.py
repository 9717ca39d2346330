"""Registers as firmware writes them: attributes go in, bus cycles come out.

i2c.I2CSTR.AAS            read the register, cut the field out
i2c.I2CMDR.IRS = 0        read the whole register, put the field in, write it
i2c.I2CDXR.all = 0x5A     one write
"""

from __future__ import annotations

from ..core.nearest import near
from ..core.registers import Field, Register
from ..f28335.memory import Place
from .cpu import Cpu


class RegisterPort:
    """One register of one module. Field names read and write; `all` is the whole register."""

    __slots__ = ("_cpu", "_fields", "_place", "_register")
    _cpu: Cpu
    _fields: dict[str, Field]
    _place: Place
    _register: Register

    def __init__(self, cpu: Cpu, place: Place, register: Register) -> None:
        object.__setattr__(self, "_cpu", cpu)
        object.__setattr__(self, "_place", place)
        object.__setattr__(self, "_register", register)
        object.__setattr__(self, "_fields", {f.name: f for f in register.fields})

    def __getattr__(self, name: str) -> int:
        if name == "all":
            return self._cpu.read(self._place, self._register)
        f = self._field(name)
        return f.of(self._cpu.read(self._place, self._register, name))

    def __setattr__(self, name: str, value: int) -> None:
        if name == "all":
            self._cpu.write(self._place, self._register, value)
        else:
            self._cpu.modify(self._place, self._register, self._field(name).name, value)

    def _field(self, name: str) -> Field:
        found = self._fields.get(name)
        if found is None:
            where = f"{self._place.name}.{self._register.name}"
            raise AttributeError(f"{where} has no field {name!r}; {near(name, self._fields)}")
        return found


class ModulePort:
    """One module's registers by name."""

    def __init__(self, cpu: Cpu, place: Place) -> None:
        self._name = place.name
        self._ports = {r.name: RegisterPort(cpu, place, r) for r in place.socket.chip.MAP}
        self.__dict__.update(self._ports)  # plain attributes: no look-up of ours for each access

    def __getattr__(self, name: str) -> RegisterPort:
        """Only for names that are not there."""
        ports: dict[str, RegisterPort] = self.__dict__["_ports"]
        if name not in ports:
            raise AttributeError(f"{self._name} has no register {name!r}; {near(name, ports)}")
        return ports[name]

    def __getitem__(self, name: str) -> RegisterPort:
        return self.__getattr__(name)
