"""Every public image of public_images.toml loads, and each word of its code is known. Skipped if they are missing."""

from __future__ import annotations

import pytest

from periph_sim.processor.c28x.decoder import Instruction, sweep
from periph_sim.processor.image_files.debug_info import DebugInfo
from periph_sim.processor.image_files.inspection import inspect
from periph_sim.processor.image_files.load import load
from tests.processor.image_files.public_images import IMAGES, public_image

FLASH_API = "Flash28_API"  # a section with code and tables, of which only parts can be decoded
I2C_RTC, AS608 = "S5", "S9a"


@pytest.mark.parametrize("name", IMAGES)
def test_every_word_of_code_is_known(name: str):
    image = load(public_image(name))
    found = inspect(image)
    assert found.unknown == ()
    assert image.entry == IMAGES[name]["entry"]
    assert found.debug_damaged == ""
    assert found.instructions > 1000


@pytest.mark.parametrize("name", IMAGES)
def test_branches_and_functions_are_at_the_beginning_of_an_instruction(name: str):
    """This checks the length of every form and the base of relative addresses."""
    image = load(public_image(name))
    checked = 0
    for section in image.code:
        if section.name == FLASH_API:
            continue
        code = [one for one in sweep(section.run, section.words) if isinstance(one, Instruction)]
        begins = {one.address for one in code}
        goals = [one.target for one in code]
        inside = [goal for goal in goals if goal is not None and section.runs_at(goal)]
        functions = [one.address for one in DebugInfo(image).functions if section.runs_at(one.address)]
        assert set(inside) | set(functions) <= begins
        checked += len(inside) + len(functions)
    assert checked > 100


@pytest.mark.parametrize("name", IMAGES)
def test_repeated_instructions_are_those_that_the_manual_allows(name: str):
    for section in load(public_image(name)).code:
        if section.name == FLASH_API:
            continue
        before = None
        for one in sweep(section.run, section.words):
            assert isinstance(one, Instruction)
            if before is not None and before.encoding.mnemonic == "RPT":
                assert one.encoding.repeated, f"{one.text} at {one.address:#08x}"
            before = one


def test_vectors_and_registers_of_an_i2c_program():
    found = inspect(load(public_image(I2C_RTC)))
    assert [(one.name, one.handler, one.stored_in) for one in found.vectors] == [("I2CINT1A", "i2c_int1a_isr", "main")]
    assert {"I2CMDR", "I2CSTR", "I2CDXR", "I2CISRC"} <= {one.name for one in found.registers if one.module == "I2C-A"}
    main = next(one for one in found.functions if one.name == "main")
    assert (main.address, main.size, str(main.source)) == (0x8323, 226, "../SRC/i2c_rtc.c:122")


def test_vectors_of_three_serial_ports():
    found = inspect(load(public_image(AS608)))
    assert [(one.name, one.handler) for one in found.vectors] == [
        ("SCIRXINTC", "scicRxFifoIsr"),
        ("SCIRXINTA", "sciaRxFifoIsr"),
        ("SCIRXINTB", "scibRxFifoIsr"),
    ]
