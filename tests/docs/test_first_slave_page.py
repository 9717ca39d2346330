"""Both programs of docs/first_slave.md access the same registers in the same order."""

from __future__ import annotations

import re

from tests.docs.pages import FILE, ROOT

PAGE = (ROOT / "docs" / "first_slave.md").read_text(encoding="utf-8")
TI = {"I2caRegs": "i2c", "SciaRegs": "sci", "PieCtrlRegs": "pie", "SysCtrlRegs": "sysctrl"}
TI_ACCESS = re.compile(rf"\b({'|'.join(TI)})\.(\w+)(?:\.all\b|\.bit\.(\w+))?")
ACCESS = re.compile(rf"\b({'|'.join(TI.values())})\.([A-Z]\w+)\.(\w+)")


def test_both_programs_access_the_same_registers_in_the_same_order():
    c = PAGE.split("```c\n")[1].split("```")[0]
    python = dict(FILE.findall(PAGE))["memory.py"]
    expected = [(TI[of], register, field or "all") for of, register, field in TI_ACCESS.findall(c)]
    assert [found.groups() for found in ACCESS.finditer(python)] == expected
    assert len(expected) > 15
