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
    """One register of one module. Field names read and write; `all` is the whole register.

    Each register has a class of its own, made by `register_port`, with a property for each field.
    """

    __slots__ = ()
    where = ""  # "I2C-A.I2CSTR"
    fields: tuple[str, ...] = ()

    def __getattr__(self, name: str) -> int:
        """Only for names that are not there."""
        raise AttributeError(f"{self.where} has no field {name!r}; {near(name, self.fields)}")

    def __setattr__(self, name: str, value: int) -> None:
        try:
            object.__setattr__(self, name, value)
        except AttributeError:
            if name not in self.fields and name != "all":
                self.__getattr__(name)
            raise


def register_port(cpu: Cpu, place: Place, register: Register) -> RegisterPort:
    """The port of one register."""
    where = f"{place.name}.{register.name}"
    names = tuple(f.name for f in register.fields)
    ports: dict[str, object] = {f.name: _field_port(cpu, place, register, f) for f in register.fields}
    ports["all"] = property(lambda port: cpu.read(place, register), lambda port, v: cpu.write(place, register, v))
    made = type(where, (RegisterPort,), {"__slots__": (), "where": where, "fields": names, **ports})
    port = made()
    assert isinstance(port, RegisterPort)
    return port


def _field_port(cpu: Cpu, place: Place, register: Register, f: Field) -> property:
    read, modify, mask, lsb = cpu.read, cpu.modify, f.mask, f.lsb

    def value(port: RegisterPort) -> int:
        return (read(place, register, f) & mask) >> lsb

    def assign(port: RegisterPort, number: int) -> None:
        modify(place, register, f, number)

    return property(value, assign)


class ModulePort:
    """One module's registers by name."""

    def __init__(self, cpu: Cpu, place: Place) -> None:
        self._name = place.name
        self._ports = {r.name: register_port(cpu, place, r) for r in place.socket.chip.MAP}
        self.__dict__.update(self._ports)  # plain attributes: no look-up of ours for each access

    def __getattr__(self, name: str) -> RegisterPort:
        """Only for names that are not there."""
        ports: dict[str, RegisterPort] = self.__dict__["_ports"]
        if name not in ports:
            raise AttributeError(f"{self._name} has no register {name!r}; {near(name, ports)}")
        return ports[name]

    def __setattr__(self, name: str, value: object) -> None:
        """Registers are written through their fields or `all`; a module has nothing else to assign to."""
        if name.startswith("_"):
            object.__setattr__(self, name, value)
            return
        self.__getattr__(name)  # a name that is not there is told so
        raise AttributeError(f"{self._name}.{name} is a register; write {name}.all = ... or a field of it")

    def __getitem__(self, name: str) -> RegisterPort:
        return self.__getattr__(name)
