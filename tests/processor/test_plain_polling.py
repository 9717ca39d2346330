"""A loop of Python that polls registers without `dsp.spin` is reported with its line while it runs; waits are not.

reads  R R R R ... R (1000)   -> one note, and a line on standard error
waits  spin, R, spin, R, ...  -> none
"""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.core.time import Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene

SAYS = (
    "a loop polls registers pass by pass, which takes long to simulate; wait with dsp.spin(lambda: CONDITION), which "
    "skips the passes"
)
CASE = """\
name = "polls"
duration = "{duration}"

[unit.dsp]
firmware = "polls.py"
modules = ["I2C-A", "TIMER0"]
"""
FIRMWARE = """\
def main(dsp, settings):
    i2c, timer = dsp.module("I2C-A"), dsp.module("TIMER0")
    {loop}
"""


def run(folder: Path, loop: str, duration: str = "1 ms") -> tuple[Result, list[Record]]:
    """Return the result of a run, and the records of its notes."""
    (folder / "polls.py").write_text(FIRMWARE.format(loop=loop), encoding="utf-8")
    case = folder / "polls.toml"
    case.write_text(CASE.format(duration=duration), encoding="utf-8")
    notes: list[Record] = []

    def subscribe(recorder, timebase: Timebase) -> None:  # type: ignore[no-untyped-def]
        recorder.subscribe([Kind.NOTE], notes.append)

    return Scene(load(case), subscribe).run(), notes


@pytest.mark.parametrize(
    "loop",
    [
        "while i2c.I2CSTR.AAS == 0: pass",
        "while not (i2c.I2CSTR.AAS or i2c.I2CSTR.RRDY): pass",
        "while dsp.cpu.load(0x7902) != 0xFFFF: pass",
        "while i2c.I2CSTR.AAS == 0: dsp.compute(50)",
    ],
    ids=["one flag", "two flags", "by address", "with code in the loop"],
)
def test_a_loop_that_polls_is_reported_once_with_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], loop: str
):
    result, notes = run(tmp_path, loop)
    assert f"dsp: {SAYS} [firmware in Python] (1 time, at line 3 of polls.py)" in result.notes
    assert [note.what for note in notes] == ["polling"]
    assert capsys.readouterr().err == f"dsp, line 3 of polls.py: {SAYS}\n"


def test_a_loop_is_reported_while_it_runs(tmp_path: Path):
    _, notes = run(tmp_path, "while i2c.I2CSTR.AAS == 0: pass")
    assert notes[0].tick < 3_000_000_000 / 1000 / 4, "in the first quarter of this millisecond"


@pytest.mark.parametrize(
    "loop",
    [
        "dsp.spin(lambda: i2c.I2CSTR.AAS == 1)",
        "for _ in range(3000): dsp.spin(lambda: timer.TCR.TIF == 0) and i2c.I2CSTR.AAS",
        "for _ in range(3000): i2c.I2CSAR.all = i2c.I2CSTR.AAS",
        "for _ in range(3000): i2c.I2CSTR.AAS, dsp.compute(200)",
        "for _ in range(900): i2c.I2CSTR.AAS",
    ],
    ids=["spin", "waits between reads", "writes between reads", "long computations", "a short loop"],
)
def test_other_reads_are_not_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str], loop: str):
    result, notes = run(tmp_path, loop, "5 ms")
    assert not any(SAYS in note for note in result.notes) and capsys.readouterr().err == ""
    assert not [note for note in notes if note.what == "polling"]
