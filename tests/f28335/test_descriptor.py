"""Descriptors of the modules of a part, and errors in descriptors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import periph_sim.f28335
from periph_sim.core.registers import Register, RegisterMap, field
from periph_sim.f28335.descriptor import DescriptorError, Frame, Interrupt, ModuleDescriptor, Part
from periph_sim.f28335.parts.f28335 import PART

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


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"size": 3}, "register CTL at offset 0x3 lies beyond its 3 words"),
        ({"interrupts": (Interrupt("NEWINT"),)}, "there is no interrupt 'NEWINT' in the PIE's table"),
        *[
            ({"interrupts": (Interrupt(name),)}, f"no module can request {name}, which the CPU itself raises")
            for name in ("RESET", "ILLEGAL", "USER1", "USER12")
        ],
        (
            {"interrupts": (Interrupt("ADCINT", ("CTL.ENB",)),)},
            "ADCINT names CTL.ENB, which is no field of its registers",
        ),
        ({"takes": ("options", "pins")}, "its chip takes pins; expected name, options"),
        ({"clock": "HSPCLK"}, "its clock is 'HSPCLK'; expected SYSCLKOUT or LSPCLK"),
        ({"gate": "NEWENCLK"}, "there is no field 'NEWENCLK' in PCLKCR0 or PCLKCR3"),
        ({"input_gate": "NEWENCLK"}, "there is no field 'NEWENCLK' in PCLKCR0 or PCLKCR3"),
        ({"inputs": ("SPICLKA",)}, "signal SPICLKA has no pin"),
        ({"inputs": ("SPICLKA",), "pins": {"SPICLKA": 88}}, "signal SPICLKA has no pin"),
        ({"inputs": ("SPICLKA",), "pins": {"SPICLKA": 19}}, "the multiplexer does not offer SPICLKA at GPIO19"),
        ({"pins": {"SPICLKA": 18}}, "SPICLKA is neither among its inputs nor among its outputs"),
        ({"wires": {"CLK": "SPICLKA"}}, "SPICLKA is neither among its inputs nor among its outputs"),
    ],
)
def test_a_descriptor_that_contradicts_itself_or_the_manual_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DescriptorError) as caught:
        module(**changes)
    assert str(caught.value) == f"descriptor of NEW: {sentence}"


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        (module("NEW", base=0x7200), "NEW and NEW have the same name NEW"),
        (module("LATE", base=0x710F), "LATE at 0x710f overlaps NEW"),
        (module("LATE", base=0x70F1), "NEW at 0x7100 overlaps LATE"),
        (
            module("LATE", base=0x7200, interrupts=(Interrupt("ADCINT"),)),
            "NEW and LATE have the same interrupt ADCINT",
        ),
        (
            module("LATE", base=0x7200, inputs=("SPICLKA",), pins={"SPICLKA": 18}),
            "NEW and LATE have the same start-up pin GPIO18",
        ),
    ],
)
def test_modules_that_collide_are_refused(other: ModuleDescriptor, sentence: str) -> None:
    first = module(interrupts=(Interrupt("ADCINT"),), outputs=("SCITXDB",), pins={"SCITXDB": 18})
    with pytest.raises(DescriptorError) as caught:
        Part("F28335", (first, other), range(0x30_0000, 0x34_0000), 0x00EF)
    assert str(caught.value) == f"F28335: {sentence}"


def test_modules_may_share_an_interrupt_if_both_say_so() -> None:
    shared = [
        module(name, base=base, interrupts=(Interrupt("INT13", shared=True),))
        for name, base in (("A", 0x7100), ("B", 0x7200))
    ]
    part = Part("two", tuple(shared), range(0x33_0000, 0x34_0000), 0)
    assert list(part.requesters("INT13")) == ["A", "B"]
    assert part.requesters("INT14") == {}
