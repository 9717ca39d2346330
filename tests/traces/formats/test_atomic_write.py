"""A file appears whole, with the usual rights, or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from periph_sim.traces.formats import BadCapture, atomic_write


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


@pytest.mark.posix("symbolic links")
def test_a_link_is_followed(tmp_path: Path):
    (tmp_path / "to").mkdir()
    target = tmp_path / "to" / "run.vcd"
    target.write_text("old")
    (tmp_path / "run.vcd").symlink_to(target)
    with atomic_write(tmp_path / "run.vcd") as unfinished:
        unfinished.write_text("new")
    assert target.read_text() == "new"
    assert (tmp_path / "run.vcd").is_symlink()


@pytest.mark.posix("pipes with a name")
def test_a_pipe_takes_the_bytes_and_stays_a_pipe(tmp_path: Path):
    path = tmp_path / "pipe.vcd"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with atomic_write(path) as unfinished:
            unfinished.write_text("new")
        assert os.read(reader, 100) == b"new"
    finally:
        os.close(reader)
    assert path.is_fifo()


def test_a_device_that_is_full_is_refused_and_stays_a_device(tmp_path: Path):
    link = tmp_path / "run.vcd"
    link.symlink_to("/dev/full")  # whose folder may not be written to
    if not link.is_char_device():
        pytest.skip("there is no /dev/full")
    with pytest.raises(BadCapture) as caught, atomic_write(link) as unfinished:
        unfinished.write_text("new")
    assert str(caught.value) == (
        f"{link}, its place: found no space left on device, expected a place that can be written to; give another path"
    )
    assert link.is_char_device() and link.is_symlink()


def test_a_disk_that_fills_up_while_the_file_is_written_is_refused(tmp_path: Path):
    path = tmp_path / "run.vcd"
    with pytest.raises(BadCapture, match="its place: found no space left on device"), atomic_write(path):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert os.listdir(tmp_path) == []
