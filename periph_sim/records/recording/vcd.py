"""VCD for GTKWave and Surfer: wires, what parties say on them, every field of the SCI and I2C registers, interrupts,
spans of firmware.

Times are written in picoseconds, rounded down from ticks.
"""

from __future__ import annotations

from typing import IO, Literal, cast

from vcd import VCDWriter
from vcd.writer import StringVariable, Variable

from ...core.records import Kind, Record
from ...core.registers import RegisterMap
from ...core.time import Timebase
from ...f28335.i2c.register_map import I2C_MAP
from ...f28335.sci.register_map import SCI_MAP
from ..record_text import on_the_bus

SUFFIX = ".vcd"
MODE: Literal["w"] = "w"
KINDS = (Kind.EDGE, Kind.FLAG, Kind.IRQ, Kind.SPAN, Kind.BUS, Kind.FRAME)
SAID = {Kind.BUS: "I2C", Kind.FRAME: "UART"}  # "0x68 R ACK", "0x55": the last thing said, until the next

PICOSECONDS = 10**12


class VcdFile:
    def __init__(self, file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        self._per_second = timebase.per_second
        no_date = ""  # equal runs give equal files
        self._writer = VCDWriter(file, timescale="1 ps", date=no_date, comment="periph-sim")
        self._wires: dict[str, Variable[int]] = {}
        self._flags: dict[tuple[str, str], Variable[int]] = {}
        self._texts: dict[tuple[str, str], StringVariable] = {}
        self._stacks: dict[tuple[str, str], list[str]] = {}
        for name in ("SCL", "SDA", "RX", "TX"):
            self._wire(name)
        for name in SAID.values():
            self._texts["wires", name] = self._text("wires", name)
        for unit, names in modules.items():
            self._unit(unit, names)

    def _wire(self, name: str) -> None:
        self._wires[name] = self._writer.register_var("wires", name, "wire", size=1, init=1)

    def _unit(self, unit: str, modules: tuple[str, ...]) -> None:
        for what in ("interrupt", "span"):
            self._texts[unit, what] = self._text(unit, what)
        for module in modules:
            if module.startswith("I2C"):
                self._registers(f"{unit}.{module}", I2C_MAP)
            elif module.startswith("SCI"):
                self._registers(f"{unit}.{module}", SCI_MAP)
            elif module.startswith("pin:"):
                self._wire(module.removeprefix("pin:"))

    def _text(self, unit: str, what: str) -> StringVariable:
        return cast(StringVariable, self._writer.register_var(unit, what, "string", init="-"))

    def _registers(self, where: str, registers: RegisterMap) -> None:
        for register in registers:
            for f in register.fields:
                size = f.msb - f.lsb + 1
                scope = f"{where}.{register.name}".replace("-", "_")
                variable = self._writer.register_var(scope, f.name, "wire", size=size, init=f.reset)
                self._flags[where, f"{register.name}.{f.name}"] = variable

    def write(self, record: Record) -> None:
        at = record.tick * PICOSECONDS // self._per_second
        if record.kind is Kind.EDGE:
            if record.where in self._wires:
                self._writer.change(self._wires[record.where], at, record.value)
        elif record.kind is Kind.FLAG:
            variable = self._flags.get((record.where, record.what))
            if variable is not None:
                self._writer.change(variable, at, record.value)
        elif record.kind in (Kind.IRQ, Kind.SPAN):
            self._nested(record, at)
        elif record.kind is not Kind.FRAME or record.what == "byte":
            self._writer.change(self._texts["wires", SAID[record.kind]], at, on_the_bus(record))

    def _nested(self, record: Record, at: int) -> None:
        """Interrupts and spans nest: the innermost is shown."""
        key = (record.where, "interrupt" if record.kind is Kind.IRQ else "span")
        stack = self._stacks.setdefault(key, [])
        if record.value:
            stack.append(record.what)
        elif stack:
            stack.pop()
        self._writer.change(self._texts[key], at, stack[-1] if stack else "-")

    def close(self, now: int) -> None:
        self._writer.close(now * PICOSECONDS // self._per_second)


def open_writer(file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> VcdFile:
    return VcdFile(file, timebase, modules)
