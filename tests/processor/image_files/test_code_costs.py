"""The costs of code around accesses in docs/fidelity.md are those measured in programs that run.

The project's images are always measured, public ones if they are installed.

pass      from a read of a register to its next read by the same line; the most frequent distance
enter     from the entry of a service routine to its first access
leave     from its last access to the end of IRET, where the interrupted code continues
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.processor.source_location import statement
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from tests.docs.pages import ROOT
from tests.processor.image_files.public_images import public_image

ALL = ["SCI-A", "SCI-B", "SCI-C", "I2C-A", "GPIO", "XINT", "TIMER0", "TIMER1", "TIMER2"]


class Program(NamedTuple):
    """Settings of a program, chosen so that its waits occur.

    seconds: duration of the run.
    unit, tables: additions to the case.
    """

    seconds: str
    unit: Mapping[str, Any] = {}
    tables: Mapping[str, Any] = {}


READ = {"name": "r", "address": 0x50, "pointer": 1, "count": 3}
PROGRAMS = {
    "imu_hil.asm": Program(
        "0.006", {}, {"controller": {"first": "5.5 ms", "order": ["gyroscope"]}, "host": {"first": "4.6 ms"}}
    ),
    "register_slave.asm": Program("0.006", {}, {"controller": {"first": "5 ms", "request": [READ]}}),
    "S1": Program("0.005"),
    "S4": Program("0.005", {}, {"device": {"eeprom": {"model": "24c02"}}}),
    "S5": Program("0.0065", {}, {"device": {"clock": {"model": "x1226"}}}),
    "S7": Program("0.005"),
    "S9d": Program("0.0055", {"boot": "ram"}),
    "S9e": Program("0.006"),
    "S11": Program("0.006"),
    "S12b": Program("0.0065", {"boot": "ram"}),
}


def costs(name: str) -> dict[str, int]:
    """Return cycles by "pass REGISTER", "enter VECTOR" and "leave VECTOR"."""
    program = PROGRAMS[name]
    path = SHIPPED / name if Path(name).suffix else public_image(name)
    unit = {"image": str(path), "modules": ALL, **program.unit}
    case = Case.model_validate({"name": name, "duration": "1 s", "unit": {"dsp": unit}, **program.tables})
    records: list[Record] = []
    scene = Scene(case, lambda recorder, _: recorder.subscribe([Kind.ACCESS, Kind.IRQ], records.append))
    scene.run(Fraction(program.seconds))
    cycle = scene.timebase.per_second // 150_000_000
    found: dict[str, Counter[int]] = {}
    accesses = [one for one in records if one.kind is Kind.ACCESS]
    for before, after in pairwise(accesses):
        slow = after.what == "R SYS.PLLSTS"  # cycles are longer while the PLL locks
        if slow or not before.what.startswith("R "):
            continue
        if (before.what, statement(before.text)) == (after.what, statement(after.text)):
            found.setdefault(f"pass {after.what[2:]}", Counter())[(after.tick - before.tick) // cycle] += 1
    entered, last = None, 0
    for one in records:
        if one.kind is Kind.ACCESS:
            if entered is not None and last < entered.tick:
                found.setdefault(f"enter {entered.what}", Counter())[(one.tick - entered.tick) // cycle] += 1
            last = one.tick
        elif one.value:
            entered = one
        elif entered is not None:
            found.setdefault(f"leave {one.what}", Counter())[(one.tick - last) // cycle] += 1
            entered = None
    return {what: counts.most_common(1)[0][0] for what, counts in found.items()}


ROW = re.compile(r"^\| [^|]* \[(\S+)\] \| ((?:pass|enter|leave|enter, leave) \S+) \| (\d+(?:, \d+)?) \|$", re.MULTILINE)


def shown() -> Mapping[str, dict[str, int]]:
    """Return the figures of the page, by program."""
    found: dict[str, dict[str, int]] = {}
    for program, what, cycles in ROW.findall((ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")):
        kinds, _, name = what.rpartition(" ")
        for kind, figure in zip(kinds.split(", "), cycles.split(", "), strict=True):
            found.setdefault(program, {})[f"{kind} {name}"] = int(figure)
    return found


@pytest.mark.parametrize("program", sorted(shown()))
def test_the_figures_of_the_page_are_those_measured(program: str):
    measured = costs(program)
    assert {what: measured.get(what) for what in shown()[program]} == shown()[program]


def test_every_program_that_can_be_measured_is_on_the_page():
    assert set(shown()) == set(PROGRAMS)
