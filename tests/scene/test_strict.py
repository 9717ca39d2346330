"""`strict = true`: a broken duty of a manual ends the run, whichever module or chip it belongs to."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import partial
from pathlib import Path

import pytest

from periph_sim import Dsp, FirmwareError, Scene, load
from periph_sim.core.chip import Note, joined
from periph_sim.scene.result import notes_of
from tests.scene.small import case, scene_with, sentence_of

CASE = """\
name = "small"
duration = "1 ms"
strict = {strict}

[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A", "SCI-A", "GPIO"]
"""

BREAKS = {
    "I2C-A": ("i2c.I2CPSC.all = 5", "i2c.I2CMDR.IRS = 1"),  # 25 MHz
    "GPIO": (
        "dsp.eallow(); dsp.module('GPIO').GPAMUX2.GPIO28 = 1",
        "dsp.module('GPIO').GPBMUX1.GPIO36 = 1",  # a second pin for SCIRXDA, two cycles later
    ),
    "SYS": ("dsp.eallow()", "dsp.module('SYS').PLLCR.all = 12"),
}


def ran(folder: Path, lines: tuple[str, ...], strict: bool) -> Scene:
    firmware = folder / "breaks.py"
    body = "".join(f"    {line}\n" for line in lines)
    text = f"def main(dsp, settings):\n    i2c = dsp.module('I2C-A')\n{START}{body}    dsp.compute(1000)\n"
    firmware.write_text(text, encoding="utf-8")
    case = folder / "small.toml"
    case.write_text(CASE.format(strict=str(strict).lower(), firmware=firmware), encoding="utf-8")
    scene = Scene(load(case))
    scene.run()
    return scene


START = "    dsp.eallow()\n    dsp.module('SYS').PCLKCR0.all = 0x410\n    dsp.edis()\n    dsp.compute(10)\n"


@pytest.mark.parametrize("module", BREAKS)
def test_a_broken_duty_of_any_module_ends_a_strict_run_with_its_line(tmp_path: Path, module: str):
    assert re.match(
        rf"dsp\.{module}, line [89] of breaks\.py, at 0\.\d+ us: .* \[SP",
        sentence_of(FirmwareError, lambda: ran(tmp_path, BREAKS[module], strict=True)),
    )
    scene = ran(tmp_path, BREAKS[module], strict=False)
    assert any(note.code == "duty" for _, note in scene.units["dsp"].sockets[module].notes)


@pytest.mark.parametrize("strict", [True, False])
def test_a_broken_duty_of_a_device_or_a_sensor_chip_ends_a_strict_run(strict: bool):
    for name, table in {
        "it": {"device": {"it": {"model": "24lc64"}}},
        "chip": {"chip": {"chip": {"model": "itg3200", "values": {"fixed": [0, 0, 0]}}}},
    }.items():
        scene = scene_with(lambda dsp: dsp.compute(100_000), ["I2C-A"], strict=strict, **table)
        tick = scene.start + scene.timebase.ticks(Fraction(2, 10**6))
        breaks = partial(scene.note_logs()[name].take, Note("duty", "too soon", "the sheet"))
        scene.kernel.call_at(tick, breaks)
        if strict:
            with pytest.raises(
                FirmwareError, match=rf"^{name}, line \d+ of test_strict.py, at 2.* us: too soon \[the sh"
            ):
                scene.run()
        else:
            assert [note for note in scene.run().notes if "too soon" in note] == [
                f"{name}, first at 2.000 us: too soon [the sheet] (1 time)"
            ]


def test_notes_other_than_duties_do_not_end_a_strict_run(tmp_path: Path):
    lines = ("dsp.eallow()", "dsp.module('GPIO').GPBMUX1.GPIO34 = 3")  # XREADY: not modelled
    scene = ran(tmp_path, lines, strict=True)
    assert [note.code for _, note in scene.units["dsp"].sockets["GPIO"].notes] == ["unknown"]


def test_pins_of_the_external_bus_are_one_note_that_lists_them(tmp_path: Path):
    lines = ("dsp.eallow()", *(f"dsp.module('GPIO').GPBMUX1.GPIO{pin} = 3" for pin in range(36, 46)))
    scene = ran(tmp_path, lines, strict=False)
    (note,) = [line for line in notes_of(scene) if "not modelled" in line]
    assert "GPIO36 (XZCS0)" in note and "GPIO45 (XA5)" in note and note.count("GPIO") >= 10


def test_a_note_names_its_module_once(tmp_path: Path):
    scene = ran(
        tmp_path, ("dsp.eallow()", "dsp.module('SYS').PCLKCR0.all = 0", "dsp.module('SCI-A').SCICCR.all = 7"), False
    )
    (note,) = [line for line in notes_of(scene) if "PCLKCR0 bit" in line]
    assert note.startswith("dsp SCI-A, first at ") and note.count("SCI-A") == 1


def test_only_notes_of_one_kind_are_joined():
    one, two = (Note("unknown", f"pin {n} is odd", "S1", "pins are odd", f"pin {n}") for n in (1, 2))
    other = Note("duty", "mind the gap", "S2")
    found = joined([(5, one), (6, other), (7, two)])
    assert [(cycle, note.text) for cycle, note in found] == [(5, "pins are odd: pin 1, pin 2"), (6, "mind the gap")]


PROGRAM = """
          .include "f28335.inc"
          .sect ".text", 0x9000
_c_int00: MOVW  DP,#PLLCR >> 6
          MOVB  XAR0,#2
again:    MOV   @LOSPCP,#2        ; without EALLOW
          BANZ  again,AR0--
          EALLOW
          MOV   @WDCR,#0x68
          MOV   @PLLCR,#10        ; DIVSEL is 2, MCLKOFF 0
          ESTOP0
"""


def test_a_note_on_an_image_has_function_line_and_address(tmp_path: Path):
    (tmp_path / "own.asm").write_text(PROGRAM)
    unit = {"image": str(tmp_path / "own.asm"), "modules": []}
    notes = Scene(case(unit={"dsp": unit})).run(Fraction("0.0001")).notes
    [unit_note] = [note for note in notes if "LOSPCP" in note]
    assert unit_note.endswith("(3 times, first at _c_int00 (own.asm:6, 0x009003))")
    [module_note] = [note for note in notes if note.startswith("dsp SYS, first at ")]
    assert " us, _c_int00 (own.asm:10, 0x00900a): PLLCR was written with PLLSTS.MCLKOFF = 0" in module_note


ACCESS = """
          .sect ".text", 0x9000
_c_int00: MOVL  XAR4,#{address}
          {access}
          ESTOP0
"""


@pytest.mark.parametrize(
    ("address", "access", "at"),
    [
        ("0x6F82", "MOV   *XAR4,#1", "0.133"),
        ("0x0D00", "MOV   *XAR4,#1", "0.133"),
        ("0x7052", "MOVL  ACC,*XAR4", "0.400"),
    ],
)
def test_the_run_of_an_image_ends_at_the_instant_of_the_broken_duty(tmp_path: Path, address: str, access: str, at: str):
    (tmp_path / "own.asm").write_text(ACCESS.format(address=address, access=access))
    unit = {"image": str(tmp_path / "own.asm"), "modules": ["SCI-A"]}
    scene = Scene(case(unit={"dsp": unit}, strict=True, start="3 s"))
    with pytest.raises(FirmwareError, match=rf", at {at} us: .* \[SP"):
        scene.run(Fraction("0.0001"))
    assert scene.timebase.show(scene.kernel.now - scene.start) == f"{at} us"


def test_a_note_on_python_firmware_has_file_and_line():
    def careless(dsp: Dsp) -> None:
        dsp.module("SYS").LOSPCP.all = 2

    [note] = [note for note in scene_with(careless, []).run().notes if "LOSPCP" in note]
    line = careless.__code__.co_firstlineno + 1
    assert note.endswith(f"(1 time, at line {line} of test_strict.py)")
