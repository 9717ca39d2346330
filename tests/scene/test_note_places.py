"""Notes of duties that firmware breaks say where it first did, of the unit and of its modules."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.processor.dsp import Dsp
from periph_sim.scene.scene import Scene
from tests.scene.small import case, scene_with

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


def test_of_an_image_function_line_and_address(tmp_path: Path):
    (tmp_path / "own.asm").write_text(PROGRAM)
    unit = {"image": str(tmp_path / "own.asm"), "modules": []}
    notes = Scene(case(unit={"dsp": unit})).run(Fraction("0.0001")).notes
    [unit_note] = [note for note in notes if "LOSPCP" in note]
    assert unit_note.endswith("(3 times, first at _c_int00 (own.asm:6, 0x009003))")
    [module_note] = [note for note in notes if note.startswith("dsp SYS, first at ")]
    assert " us, _c_int00 (own.asm:10, 0x00900a): PLLCR was written with PLLSTS.MCLKOFF = 0" in module_note


def test_of_python_firmware_file_and_line(monkeypatch: pytest.MonkeyPatch):
    def careless(dsp: Dsp) -> None:
        dsp.module("SYS").LOSPCP.all = 2

    [note] = [note for note in scene_with(monkeypatch, careless, []).run().notes if "LOSPCP" in note]
    line = careless.__code__.co_firstlineno + 1
    assert note.endswith(f"(1 time, at line {line} of test_note_places.py)")
