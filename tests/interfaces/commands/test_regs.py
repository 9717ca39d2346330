"""`periph-sim regs` prints the register maps and the open questions as tables."""

from __future__ import annotations

import dataclasses

import pytest

from periph_sim.interfaces.commands.regs import MAPS, OPTIONS
from tests.interfaces.commands.conftest import Run


def test_without_arguments_all_modules_are_listed(periph_sim: Run):
    out = periph_sim.passes("regs")
    assert all(module in out for module in MAPS)


@pytest.mark.parametrize("module", MAPS)
def test_a_module_lists_its_registers_and_addresses(periph_sim: Run, module: str):
    result = periph_sim("regs", module)
    base, registers = MAPS[module]
    assert result.status == 0
    for register in registers:
        assert f"{base + register.offset:#06x}" in result.out and register.name in result.out


def test_a_register_lists_its_fields(periph_sim: Run):
    out = periph_sim.passes("regs", "I2C-A.I2CSTR")
    assert out.startswith("I2C-A.I2CSTR  0x7902  reset 0x0410  [SPRUG03B")
    assert all(name in out for name in ("SDIR", "NACKSNT", "BB", "RSFULL", "XSMT", "AAS", "AD0", "SCD", "XRDY"))


@pytest.mark.parametrize("name", ["I2CSTR", "i2cstr", "I2cStr"])
def test_a_register_of_only_one_module_needs_no_module_name(periph_sim: Run, name: str):
    assert periph_sim("regs", name) == periph_sim("regs", "I2C-A.I2CSTR")


@pytest.mark.parametrize("group", OPTIONS)
def test_a_group_of_options_lists_their_questions(periph_sim: Run, group: str):
    out = periph_sim.passes("regs", "--options", group)
    text = " ".join(out.split())
    for option in dataclasses.fields(OPTIONS[group]):
        assert f"{group}.{option.name}: " in out and option.metadata["question"] in text
    assert max(map(len, out.splitlines())) <= 80


def test_options_without_a_group_lists_all_groups(periph_sim: Run):
    result = periph_sim("regs", "--options")
    assert all(f"{group}." in result.out for group in OPTIONS)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["I2C"], "there is no module 'I2C'; did you mean I2C-A?"),
        (["i2cstrx"], "there is no module or register 'i2cstrx'; did you mean I2CSTR"),
        (["I2C-A.I2CST"], "I2C-A has no register 'I2CST'; did you mean I2CSTR"),
        (["sciccr"], "3 modules have a register SCICCR; write one of SCI-A.SCICCR, SCI-B.SCICCR, SCI-C.SCICCR"),
        (["NOSUCH"], "there is no module 'NOSUCH'"),
        (["--options", "i2"], "there are no options for 'i2'; did you mean i2c?"),
    ],
)
def test_a_wrong_name_is_one_error_message_with_status_2(periph_sim: Run, arguments: list[str], sentence: str):
    assert periph_sim.refused("regs", *arguments).startswith(sentence)
