"""docs/tutorial.md: both programs access the same registers in one order; the table has the cycles measured."""

from __future__ import annotations

import re

from tests.docs.pages import FILE, ROOT

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
TI = {"I2caRegs": "i2c", "SciaRegs": "sci", "PieCtrlRegs": "pie", "SysCtrlRegs": "sysctrl"}
TI_ACCESS = re.compile(rf"\b({'|'.join(TI)})\.(\w+)(?:\.all\b|\.bit\.(\w+))?")
ACCESS = re.compile(rf"\b({'|'.join(TI.values())})\.([A-Z]\w+)\.(\w+)")
CYCLE_NS = 10  # of the case `costs`


def test_both_programs_access_the_same_registers_in_the_same_order():
    c = PAGE.split("```c\n")[1].split("```")[0]
    python = dict(FILE.findall(PAGE))["bridge.py"]
    expected = [(TI[of], register, field or "all") for of, register, field in TI_ACCESS.findall(c)]
    assert [found.groups() for found in ACCESS.finditer(python)] == expected
    assert len(expected) > 25


def test_the_cycles_of_the_table_are_those_measured():
    measured = re.findall(
        r"^ (\S.*?) {2,}(\d\.\d{3}) us +1 us .* seen$", PAGE.split("sed -n 3,19p")[1].split("```")[0], re.M
    )
    table = re.findall(r"^\| ([^|]+) \| (\d+) \| ", PAGE, re.M)
    assert [(name, round(float(us) * 1000) // CYCLE_NS) for name, us in measured] == [(n, int(c)) for n, c in table]
    assert len(table) == 15
