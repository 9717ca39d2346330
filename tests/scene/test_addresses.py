"""Addresses of registers, typed from the manuals and compared with those of a scene."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.memory.memory_map import AddressMap
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.processor.dsp import Dsp, DspPlan

ADDRESSES = {
    # SPRUFB0D, registers of system control and of the PIE
    "SYS": {"PLLSTS": 0x7011, "HISPCP": 0x701A, "LOSPCP": 0x701B, "PCLKCR0": 0x701C, "PCLKCR1": 0x701D}
    | {"PCLKCR3": 0x7020, "PLLCR": 0x7021, "SCSR": 0x7022, "WDCNTR": 0x7023, "WDKEY": 0x7025, "WDCR": 0x7029},
    "PIE": {"PIECTRL": 0x0CE0, "PIEACK": 0x0CE1, "PIEIER1": 0x0CE2, "PIEIFR1": 0x0CE3, "PIEIER12": 0x0CF8},
    # SPRUG03B table 4
    "I2C-A": {"I2COAR": 0x7900, "I2CIER": 0x7901, "I2CSTR": 0x7902, "I2CCLKL": 0x7903, "I2CCLKH": 0x7904}
    | {"I2CCNT": 0x7905, "I2CDRR": 0x7906, "I2CSAR": 0x7907, "I2CDXR": 0x7908, "I2CMDR": 0x7909, "I2CISRC": 0x790A}
    | {"I2CEMDR": 0x790B, "I2CPSC": 0x790C, "I2CFFTX": 0x7920, "I2CFFRX": 0x7921},
    # SPRUFZ5A tables 2-1, 2-2
    "SCI-A": {"SCICCR": 0x7050, "SCICTL1": 0x7051, "SCIHBAUD": 0x7052, "SCILBAUD": 0x7053, "SCICTL2": 0x7054}
    | {"SCIRXST": 0x7055, "SCIRXEMU": 0x7056, "SCIRXBUF": 0x7057, "SCITXBUF": 0x7059, "SCIFFTX": 0x705A}
    | {"SCIFFRX": 0x705B, "SCIFFCT": 0x705C, "SCIPRI": 0x705F},
    "SCI-B": {"SCICCR": 0x7750, "SCIRXBUF": 0x7757, "SCIPRI": 0x775F},
    "SCI-C": {"SCICCR": 0x7770, "SCIRXBUF": 0x7777, "SCIPRI": 0x777F},
    # SPRUEU3 table 1-1
    "SPI-A": {"SPICCR": 0x7040, "SPICTL": 0x7041, "SPISTS": 0x7042, "SPIBRR": 0x7044, "SPIRXEMU": 0x7046}
    | {"SPIRXBUF": 0x7047, "SPITXBUF": 0x7048, "SPIDAT": 0x7049, "SPIFFTX": 0x704A, "SPIFFRX": 0x704B}
    | {"SPIFFCT": 0x704C, "SPIPRI": 0x704F},
    # SPRUFB0D, registers of GPIO, of the CPU timers and of the external interrupts
    "GPIO": {"GPACTRL": 0x6F80, "GPAMUX1": 0x6F86, "GPBMUX1": 0x6F96, "GPADAT": 0x6FC0, "GPASET": 0x6FC2}
    | {"GPACLEAR": 0x6FC4, "GPATOGGLE": 0x6FC6, "GPBDAT": 0x6FC8, "GPBSET": 0x6FCA, "GPCDAT": 0x6FD0},
    "TIMER0": {"TIM": 0x0C00, "PRD": 0x0C02, "TCR": 0x0C04, "TPR": 0x0C06},
    "TIMER1": {"TIM": 0x0C08},
    "TIMER2": {"TIM": 0x0C10},
    "XINT": {"XINT1CR": 0x7070, "XINT3CR": 0x7072, "XNMICR": 0x7077, "XINT1CTR": 0x7078},
}


def everything() -> Dsp:
    plan = DspPlan("dsp", tuple(PART.selectable), {})
    return Dsp(Kernel(), Timebase(150_000_000), Recorder(), plan)


@pytest.mark.rule("I2C-001", "I2C-002", "SCI-001", "SYS-082")
def test_every_register_is_where_the_manual_has_it() -> None:
    memory = everything().memory
    found = {
        module: {name: address for name, address in registers.items() if _at(memory, address) == (module, name)}
        for module, registers in ADDRESSES.items()
    }
    assert found == ADDRESSES


def test_no_module_is_left_out() -> None:
    assert set(ADDRESSES) == {*PART.selectable, "SYS", "PIE"}


def _at(memory: AddressMap, address: int) -> tuple[str, str] | None:
    found = memory.at(address)
    return None if found is None else (found[0].name, found[1].name)
