"""firmware/c/imu_hil.c sends the same bytes as the same program in Python and in machine code."""

from __future__ import annotations

import re
import shutil

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.case.unit_table import Unit
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc, which compiles C sources, is not installed")

ARITHMETIC = {"arithmetic": "bytes", "model_cost": "1 us"}


def run(case: Case) -> tuple[list[tuple[str, int | str]], Result]:
    """Run a case; return the bus traffic and the frames that the unit sends, in order, and the result."""
    records: list[Record] = []
    scene = Scene(case, lambda recorder, _: recorder.subscribe([Kind.BUS, Kind.FRAME], records.append))
    result = scene.run()
    return [(record.what, record.value) for record in records if record.where != "RX"], result


def with_program(case: Case, **program: object) -> Case:
    unit = Unit(modules=case.unit["dsp"].modules, pins=case.unit["dsp"].pins, **program)
    return case.model_copy(update={"unit": {"dsp": unit}})


def test_the_emulator_in_c_sends_the_bytes_of_the_other_implementations():
    case = load(TIMING / "imu_hil_c.toml")
    in_c, result = run(case)
    python, _ = run(with_program(case, firmware="imu_hil", settings=ARITHMETIC))
    image, _ = run(with_program(case, image=str(SHIPPED / "imu_hil.asm")))
    assert in_c == python == image
    assert result.verdict == "pass" and result.counts["rounds"] == 2
    assert len({value for what, value in in_c if what == "byte"}) > 10


def test_bit_fields_of_the_header_agree_with_the_register_maps():
    """Names and positions of the bit fields in f28335.h agree with the register maps of the models."""
    header = (SHIPPED.parent / "c" / "f28335.h").read_text(encoding="utf-8")
    scene = Scene(load(TIMING / "imu_hil_c.toml"))
    maps = [place.socket.chip.MAP for place in scene.units["dsp"].memory.places.values()]
    checked = 0
    for name, body in re.findall(r"struct (\w+)_BITS \{(.*?)\};", header, re.S):
        fields = {field.name: (field.lsb, field.mask) for one in maps if name in one for field in one[name].fields}
        lsb = 0
        for field, width in re.findall(r"uint16_t (\w+) : (\d+);", body):
            if not field.startswith("reserved"):
                assert fields[field] == (lsb, ((1 << int(width)) - 1) << lsb), f"{name}.{field}"
                checked += 1
            lsb += int(width)
        assert lsb == 16, name
    assert checked > 40


def test_an_access_after_a_service_routine_has_its_own_statement():
    records: list[Record] = []
    scene = Scene(
        load(TIMING / "imu_hil_c.toml"),
        lambda recorder, _: recorder.subscribe([Kind.IRQ, Kind.ACCESS], records.append),
    )
    scene.run()
    depth, interrupts = 0, 0
    for record in records:
        if record.kind is Kind.IRQ:
            depth += 1 if record.value else -1
            interrupts += record.value
        else:
            assert record.text.startswith("sci_received:") == (depth > 0), record
    assert interrupts
