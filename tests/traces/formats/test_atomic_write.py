"""A file appears whole, with the usual rights, or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from periph_sim.traces.formats import BadCapture
from periph_sim.traces.formats.atomic_write import atomic_write


def test_it_appears_when_the_block_ends(tmp_path: Path):
    path = tmp_path / "run.vcd"
    with atomic_write(path) as unfinished:
        assert (unfinished.parent, unfinished.suffix) == (tmp_path, ".vcd")
        unfinished.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["run.vcd"]
    (tmp_path / "usual").touch()
    assert path.stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_nothing_is_left_when_the_block_raises_and_what_was_there_stays(tmp_path: Path):
    path = tmp_path / "run.vcd"
    path.write_text("old")
    with pytest.raises(KeyboardInterrupt), atomic_write(path) as unfinished:
        unfinished.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["run.vcd"]


def test_a_place_that_cannot_be_written_to(tmp_path: Path):
    path = tmp_path / "none" / "run.vcd"
    with pytest.raises(BadCapture) as caught, atomic_write(path):
        pass
    assert str(caught.value) == (
        f"{path}, its place: found no such file or directory, expected a place that can be written to; "
        "give another path"
    )


def test_a_folder_in_the_way_leaves_nothing_behind(tmp_path: Path):
    (tmp_path / "run.vcd").mkdir()
    with pytest.raises(BadCapture, match="its place: found is a directory"), atomic_write(tmp_path / "run.vcd"):
        pass
    assert os.listdir(tmp_path) == ["run.vcd"]
