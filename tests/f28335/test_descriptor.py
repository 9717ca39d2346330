"""Descriptors: the modules of a part, and their agreement with the tables of the manual."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import periph_sim.f28335
from periph_sim.core.registers import Register, RegisterMap, field
from periph_sim.f28335.descriptor import Frame, Interrupt, ModuleDescriptor, Part
from periph_sim.f28335.gpio.pin_mux_table import FUNCTIONS
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.pie.register_map import VECTORS
from periph_sim.f28335.system_control.register_map import PCLKCR0, PCLKCR3

# SPRS439M Tables 3-8 to 3-11: base addresses; SPRUFB0D Tables 111 and 112: interrupts; Tables 15 and 17: clocks.
MANUAL = {
    "SYS": (0x7010, ("WAKEINT",), ""),
    "PIE": (0x0CE0, (), ""),
    "SCI-A": (0x7050, ("SCIRXINTA", "SCITXINTA"), "SCIAENCLK"),
    "SCI-B": (0x7750, ("SCIRXINTB", "SCITXINTB"), "SCIBENCLK"),
    "SCI-C": (0x7770, ("SCIRXINTC", "SCITXINTC"), "SCICENCLK"),
    "I2C-A": (0x7900, ("I2CINT1A", "I2CINT2A"), "I2CAENCLK"),
    "SPI-A": (0x7040, ("SPIRXINTA", "SPITXINTA"), "SPIAENCLK"),
    "GPIO": (0x6F80, (), ""),
    "XINT": (0x7070, (*(f"XINT{n}" for n in range(1, 8)), "INT13"), ""),
    "TIMER0": (0x0C00, ("TINT0",), "CPUTIMER0ENCLK"),
    "TIMER1": (0x0C08, ("INT13",), "CPUTIMER1ENCLK"),
    "TIMER2": (0x0C10, ("INT14",), "CPUTIMER2ENCLK"),
}

REGISTERS = RegisterMap("a module", "none", (Register("CTL", 0x3, "none", (field("ENA", "0"),)),))


def module(name: str = "NEW", **changes: Any) -> ModuleDescriptor:
    usual: dict[str, Any] = {
        "name": name,
        "registers": REGISTERS,
        "base": 0x7100,
        "size": 0x10,
        "frame": Frame.PF2,
        "header": {"NewRegs": 0},
    }
    return ModuleDescriptor(**usual | changes)


def test_modules_are_those_of_the_manual() -> None:
    found = {one.name: (one.base, tuple(i.vector for i in one.interrupts), one.gate) for one in PART.modules}
    assert found == MANUAL


def test_a_folder_with_a_descriptor_has_the_registers_and_the_chip():
    folders = sorted({path.parent for path in Path(periph_sim.f28335.__file__).parent.glob("*/*.py")})
    modules = [folder for folder in folders if (folder / "descriptor.py").exists()]
    assert [folder.name for folder in folders if folder not in modules] == ["cpu", "memory", "parts"]
    assert all((folder / name).exists() for folder in modules for name in ("register_map.py", "module.py"))


@pytest.mark.parametrize("one", [one for one in PART.modules if one.chip], ids=lambda one: one.name)
def test_a_chip_has_the_pins_and_interrupts_of_its_descriptor(one: ModuleDescriptor) -> None:
    chip = one.build({})
    assert chip.MAP is one.registers
    if one.inputs is not None:
        assert (len(chip.INPUTS), len(chip.OUTPUTS)) == (len(one.inputs), len(one.outputs))


@pytest.mark.parametrize("one", PART.modules, ids=lambda one: one.name)
def test_a_descriptor_agrees_with_itself_and_the_tables_of_the_manual(one: ModuleDescriptor) -> None:
    assert all(register.offset + register.width // 16 <= one.size for register in one.registers)
    assert all(interrupt.vector in VECTORS for interrupt in one.interrupts)
    names = [name.split(".") for interrupt in one.interrupts for name in interrupt.fields]
    assert all(field_name in one.registers[register] for register, field_name in names)
    assert set(one.takes) <= {"name", "options"}
    assert one.clock in ("SYSCLKOUT", "LSPCLK")
    assert all(not gate or gate in PCLKCR0 or gate in PCLKCR3 for gate in (one.gate, one.input_gate))
    signals = {*(one.inputs or ()), *one.outputs}
    assert all(signal in FUNCTIONS[one.pins[signal]] for signal in signals)
    assert {*one.pins, *one.wires.values()} <= signals


def test_modules_share_neither_names_addresses_pins_nor_undeclared_interrupts() -> None:
    addresses = [address for one in PART.modules for address in range(one.base, one.base + one.size)]
    interrupts = [i.vector for one in PART.modules for i in one.interrupts if not i.shared]
    pins = [pin for one in PART.modules for pin in one.pins.values()]
    for found in (addresses, interrupts, pins, [one.name for one in PART.modules]):
        assert len(found) == len(set(found))


def test_modules_may_share_an_interrupt_if_both_say_so() -> None:
    shared = [
        module(name, base=base, interrupts=(Interrupt("INT13", shared=True),))
        for name, base in (("A", 0x7100), ("B", 0x7200))
    ]
    part = Part("two", tuple(shared), range(0x33_0000, 0x34_0000), 0)
    assert list(part.requesters("INT13")) == ["A", "B"]
    assert part.requesters("INT14") == {}
