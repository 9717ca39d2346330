"""Which registers a module of a recording has, and which of them a question is about."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.records.register_maps import is_status, one_clears, register_of, registers_of
from periph_sim.records.run import NotInRun
from periph_sim.records.subject import groups_of
from tests.records.scenes import by_hand


@pytest.mark.parametrize(
    ("module", "status", "cleared"),
    [
        ("I2C-A", "I2CSTR I2CFFTX I2CFFRX", {"I2CSTR": "SDIR NACKSNT SCD RRDY ARDY NACK AL"}),
        ("SCI-B", "SCICTL2 SCIRXST SCIRXBUF SCIFFTX SCIFFRX SCIFFCT", {}),
        ("TIMER1", "TCR", {"TCR": "TIF"}),
        ("XINT", "", {}),
        ("GPIO", "", {}),
        ("SYS", "PLLSTS SCSR WDCR", {"SCSR": "WDOVERRIDE", "WDCR": "WDFLAG"}),
        ("PIE", "", {"PIEACK": "PIEACK"}),
    ],
)
def test_registers_with_flags_of_hardware_and_fields_that_writing_1_clears(
    module: str, status: str, cleared: dict[str, str]
):
    registers = registers_of(module)
    assert registers is not None
    assert " ".join(one.name for one in registers if is_status(one)) == status
    fields = {one.name: " ".join(f.name for f in one_clears(one)) for one in registers}
    assert {name: names for name, names in fields.items() if names} == cleared


def test_other_modules_and_registers_are_not_known():
    assert [registers_of(module) for module in ("EPWM1", "", "SYSX", "I2")] == [None] * 4
    assert [register_of(*name) for name in (("EPWM1", "TBPRD"), ("I2C-A", "SCICCR"))] == [None] * 2


def access(unit: str, what: str) -> tuple[Any, ...]:
    return 1, Kind.ACCESS, unit, what, 0, "f:1", 0, ""


@pytest.mark.parametrize(
    ("name", "found"),
    [
        (None, ["one W I2CSTR", "one R I2CSTR", "two R I2CSTR"]),  # of status registers
        ("I2C-A.I2CSTR", ["one W I2CSTR", "one R I2CSTR", "two R I2CSTR"]),
        ("two.i2ca.i2cstr", ["two R I2CSTR"]),
        ("one.I2C-A.I2CSTR.scd", ["one W I2CSTR SCD", "one R I2CSTR SCD"]),
        ("I2CA.I2CCNT.ICDC", ["two W I2CCNT ICDC"]),
    ],
)
def test_a_name_means_a_register_of_all_units_or_of_one_or_a_field(name: str | None, found: list[str]):
    accesses = ("W I2C-A.I2CSTR", "R I2C-A.I2CSTR")
    run = by_hand(
        *(access("one", what) for what in accesses), access("two", accesses[1]), access("two", "W I2C-A.I2CCNT")
    )
    told = [(group.unit, group.way, group.register.name, *([f.name] if f else [])) for group, f in groups_of(run, name)]
    assert [" ".join(one) for one in told] == found


@pytest.mark.parametrize(
    ("name", "nearest"),
    [
        ("I2C-A.I2CSRT", "I2C-A.I2CSTR"),
        ("I2CSRT", "I2C-A.I2CSTR"),
        ("dsp.I2C-A.I2CSRT", "dsp.I2C-A.I2CSTR"),
        ("dsp.I2C-A.I2CSTR.SCDD", "dsp.I2C-A.I2CSTR"),
    ],
)
def test_what_was_never_accessed_is_told_with_the_nearest_written_as_long(name: str, nearest: str):
    with pytest.raises(NotInRun) as error:
        groups_of(by_hand(access("dsp", "R I2C-A.I2CSTR")), name)
    assert str(error.value).startswith(f"the run: the firmware never accessed {name!r}; ")
    assert nearest in str(error.value)
