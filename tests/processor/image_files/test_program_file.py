"""A program is assembled again only when one of its files has changed."""

from __future__ import annotations

from pathlib import Path

from periph_sim.processor.image_files.program_file import program_in
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING

SOURCE = ' .sect ".text", 0x8000\n_c_int00: NOP\nhere: .include "more.inc"\n .include "f28335.inc"\n'


def words_of(path: Path) -> list[tuple[int, ...]]:
    return [tuple(section.words) for section in program_in(path).code]


def test_a_source_is_assembled_again_only_if_a_file_has_changed(tmp_path: Path):
    source, more = tmp_path / "own.asm", tmp_path / "more.inc"
    source.write_text(SOURCE)
    more.write_text(" NOP\n")
    first = program_in(source)
    assert program_in(source) is first and words_of(source) == [(0x7700, 0x7700)]
    more.write_text(" LRETR\n")
    assert words_of(source) == [(0x7700, 0x0006)]
    source.write_text(SOURCE.replace("_c_int00: NOP", "_c_int00: LRETR"))
    assert words_of(source) == [(0x0006, 0x0006)]
    (tmp_path / "f28335.inc").write_text(" NOP\n")  # hides the shipped file of this name
    assert words_of(source) == [(0x0006, 0x0006, 0x7700)]


def test_scenes_of_one_image_share_its_debug_data():
    first, second = (Scene(load(TIMING / "imu_hil_image.toml")).units["dsp"].program.functions for _ in range(2))
    assert first.debug is second.debug and first.debug.lines
