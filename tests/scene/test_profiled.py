"""Where an image's time goes in a run: calls and time by function, sleep, and how often each instruction ran."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.profile import profiled
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase

SOURCE = """\
 .sect ".text", 0x9000
 .global _c_int00, _work
_c_int00:
 LCR _work
 LCR _work
 IDLE
_work:
 RPT #99
 || NOP
 LRETR
"""
CASE = """\
name = "own"
duration = "1 ms"
[unit.dsp]
image = "own.asm"
modules = []
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    (tmp_path / "own.asm").write_text(SOURCE)
    (tmp_path / "own.toml").write_text(CASE)
    return tmp_path / "own.toml"


def test_time_goes_to_functions_and_to_sleep(case_file: Path):
    told: list[float] = []
    found = profiled(load(case_file), Fraction(1, 10_000), told.append)
    assert (found.name, found.coverage, told[-1]) == ("own", {}, 1.0)
    main, work = found.profiles["dsp"].functions()
    cycle = found.ticks_per_second * 4 // 30_000_000  # OSCCLK by 4, as after a reset
    assert [(one.name, one.calls) for one in (main, work)] == [("_c_int00", 1), ("_work", 2)]
    assert main.total == found.ticks_per_second // 10_000
    assert 2 * 100 * cycle <= work.own == work.total < 2 * 130 * cycle and work.waits == 0
    assert main.waits > 0.9 * main.own
    assert found.place_of("dsp", "_work") == "_work (own.asm:8, 0x009005)"


def test_each_instruction_is_counted_where_that_is_asked_for(case_file: Path):
    found = profiled(load(case_file), Fraction(1, 10_000), coverage=True)
    assert set(found.coverage) == {"dsp"} and [*found.coverage["dsp"].executed_at.values()] == [1, 2, 2, 2, 1, 1]


def test_a_case_without_an_image_has_no_profile(tmp_path: Path):
    (tmp_path / "x.toml").write_text(
        CASE.replace('image = "own.asm"', 'firmware = "responder"').replace("[]", '["I2C-A"]')
    )
    with pytest.raises(BadCase, match="no unit runs an image, and a profile is of images; give a unit image = "):
        profiled(load(tmp_path / "x.toml"))
