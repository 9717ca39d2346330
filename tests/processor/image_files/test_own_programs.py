"""The shipped assembly programs of firmware/c28x produce the same traffic as their Python counterparts.

Each test of `BROKEN` breaks one line of the emulator's source, and a budget of its case must fail.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.f28335.i2c.register_map import I2CMDR, I2CSTR
from periph_sim.f28335.memory.address_space import register_name
from periph_sim.f28335.pie.register_map import LINES, VECTOR_TABLE
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.case.unit_table import Unit
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING
from tests.scene.small import case as small

IMU_HIL = TIMING / "imu_hil_image.toml"
# Two rounds shortly after the PLL has locked: the first sends the initial zeros of the memory, the second a frame.
CLOSE = ("controller.first=6.5 ms", "controller.period=3 ms", "host.first=4.6 ms")
TOO_CLOSE = "schedule slack"  # the budget that CLOSE breaks


def run(case: Case, seconds: str) -> tuple[list[tuple[str, int | str]], Result, Scene]:
    """Run a case; return the bus and UART traffic in order, the result and the scene."""
    records: list[Record] = []
    scene = Scene(case, lambda recorder, _: recorder.subscribe([Kind.BUS, Kind.FRAME], records.append))
    result = scene.run(Fraction(seconds))
    return [(record.what, record.value) for record in records if record.where != "RX"], result, scene


def python_case(case: Case, firmware: str, **settings: object) -> Case:
    """Return the case with Python firmware in place of its image."""
    modules, pins = case.unit["dsp"].modules, case.unit["dsp"].pins
    unit = Unit(firmware=firmware, modules=modules, pins=pins, settings=settings)
    return case.model_copy(update={"unit": {"dsp": unit}})


def image(name: str, *modules: str, **more: object) -> Case:
    unit = {"image": str(SHIPPED / f"{name}.asm"), "modules": [*modules, "GPIO"]}
    return small(unit={"dsp": unit}, **more)


def words(scene: Scene, name: str, count: int) -> list[int]:
    """Return words of the program's memory from a symbol on."""
    dsp = scene.units["dsp"]
    symbol = next(one for one in dsp.program.image.symbols if one.name == name)  # type: ignore[union-attr]
    return [dsp.processor.bus.ram.word(symbol.address + index) for index in range(count)]


def test_registers_and_bits_of_the_include_file_agree_with_the_register_maps():
    """Registers, bits and vectors in f28335.inc agree with the register maps of the models."""
    numbers = {name: int(value, 0) for name, value in re.findall(r"^(\w+) +\.set +(\w+)", _source("f28335.inc"), re.M)}
    bits = {field.name: field.lsb for register in (I2CSTR, I2CMDR) for field in register.fields}
    vectors = {
        name: VECTOR_TABLE.start + 2 * (32 + 8 * (group - 1) + line - 1) for name, (group, line) in LINES.items()
    }
    for name, number in numbers.items():
        module, register = register_name(number)
        assert number in (bits.get(name), vectors.get(name)) or name in (register, f"{module}{register}"), name
    assert len(numbers) > 50


def test_the_emulator_sends_the_bytes_of_the_python_firmware_and_meets_its_budgets():
    case = load(IMU_HIL, list(CLOSE))
    mine, result, _ = run(case, "0.0123")
    other, other_result, _ = run(python_case(case, "imu_hil", model_cost="1 us"), "0.0123")
    assert mine == other
    assert result.counts["rounds"] == 2 and max(value for what, value in mine if what == "byte") > 0x100
    assert {one.name for one in (*result.budgets, *other_result.budgets) if not one.passed} == {TOO_CLOSE}


BROKEN = {
    "no SDIR wait": (r"\nread: [^\n]*\n[^\n]*", "", {"wrong bytes"}),
    "wrong byte order": (r"_order:   \.word 1, 0,", "_order:   .word 0, 1,", {"wrong bytes"}),
    "a late answer": (
        r"\nnext: ",
        "\n          RPT #249 || NOP\n          RPT #249 || NOP\nnext: ",
        {"reaction", "reaction at the latest"},
    ),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_line_breaks_a_budget(tmp_path: Path, what: str):
    pattern, line, broken = BROKEN[what]
    source, count = re.subn(pattern, line, _source("imu_hil.asm"))
    assert count == 1
    (tmp_path / "broken.asm").write_text(source)
    case = load(IMU_HIL, [f"unit.dsp.image={tmp_path / 'broken.asm'}", *CLOSE])
    _, result, _ = run(case, "0.0123")
    assert {one.name for one in result.budgets if one.verdict == "fail"} == broken | {TOO_CLOSE}


def test_the_register_slave_has_the_traffic_of_the_python_firmware():
    requests = [
        {"name": "over the end", "address": 0x50, "pointer": 0xFE, "write": "a1 a2 a3", "count": 0},
        {"name": "and read", "address": 0x50, "pointer": 0xFD, "count": 6, "expect": "00 a1 a2 a3 11 12"},
        {"name": "none of its own", "address": 0x51, "pointer": 0, "count": 1},
        {"name": "all", "address": 0x00, "pointer": 0x01, "write": "77", "count": 0},
        {"name": "again", "address": 0x50, "pointer": 0x01, "count": 2, "expect": "11 12"},
    ]
    controller = {"first": "5 ms", "period": "10 ms", "request": requests}
    budgets = [{"name": "wrong bytes", "measure": "wrong bytes", "max": 0}]
    case = image("register_slave", "I2C-A", controller=controller, budget=budgets)
    mine, result, scene = run(case, "0.009")
    other, _, _ = run(python_case(case, "register_slave", registers="10 11 12 13"), "0.009")
    assert mine == other
    assert [(verdict.passed, verdict.count) for verdict in result.budgets] == [(True, 8)]
    assert words(scene, "_registers", 2) == [0xA3, 0x11]


def test_the_echo_has_the_traffic_of_the_python_firmware():
    serial = {"send": [{"name": "text", "to": "dsp.SCI-A", "text": "ab\n", "at": "5 ms"}]}
    case = image("sci_echo", "SCI-A", serial=serial)
    mine, _, _ = run(case, "0.006")
    assert mine == run(python_case(case, "sci_echo"), "0.006")[0] and len(mine) >= 4


def test_the_master_writes_an_eeprom_polls_it_and_reads_the_data_back():
    device = {"eeprom": {"model": "24lc64", "write_time": "0.4 ms"}}
    sent, _, scene = run(image("eeprom", "I2C-A", device=device), "0.0075")
    assert words(scene, "_got", 8) == list(range(0xA0, 0xA8))
    assert scene.devices["eeprom"].target.memory[0x38:0x40] == bytes(range(0xA0, 0xA8))
    assert scene.units["dsp"].program.finished
    assert [what for what, _ in sent].count("STOP") > 3  # those of the write, of the polls and of the read


def test_the_master_sets_a_clock_and_reads_it_back():
    _, _, scene = run(image("rtc", "I2C-A", device={"clock": {"model": "isl12026"}}), "0.008")
    assert bytes(words(scene, "_got", 8)).hex(" ") == "50 39 95 01 03 12 06 20"
    assert scene.units["dsp"].program.finished and scene.devices["clock"].log.notes == {}


def test_the_timer_blinks_an_led_while_the_cpu_sleeps():
    blink = {"kind": "blink", "wire": "LED", "rate": "1 kHz", "duty": "50 %", "after": "4.5 ms", "tolerance": "1 ns"}
    strobe = {"kind": "edges", "wire": "LED", "edges": [["0 s", "rise"], ["500 us", "fall"]], "since": "first edge"}
    watch = {"led": blink, "strobe": {**strobe, "after": "4.5 ms", "more": True, "tolerance": "1 ns"}}
    case = image("blink", "TIMER0", watch=watch)
    unit = case.unit["dsp"].model_copy(update={"pins": {"LED": 31}})
    _, result, _ = run(case.model_copy(update={"unit": {"dsp": unit}}), "0.008")
    assert [(one.name, one.verdict, one.worst, one.count) for one in result.budgets] == [
        ("led", "pass", 0.0, 6),
        ("strobe", "pass", 0.0, 2),
    ]


def _source(name: str) -> str:
    return (SHIPPED / name).read_text(encoding="utf-8")
