"""A written file appears complete, with the usual permissions, or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from periph_sim.traces.formats import BadCapture, atomic_write


def test_a_file_appears_when_the_block_ends(tmp_path: Path):
    path = tmp_path / "run.vcd"
    with atomic_write(path) as unfinished:
        assert (unfinished.parent, unfinished.suffix) == (tmp_path, ".vcd")
        unfinished.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["run.vcd"]
    (tmp_path / "usual").touch()
    assert path.stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_block_that_raises_leaves_no_file_and_keeps_an_older_one(tmp_path: Path):
    path = tmp_path / "run.vcd"
    path.write_text("old")
    with pytest.raises(KeyboardInterrupt), atomic_write(path) as unfinished:
        unfinished.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["run.vcd"]


def test_a_path_that_cannot_be_written_is_rejected(tmp_path: Path):
    path = tmp_path / "none" / "run.vcd"
    with pytest.raises(BadCapture) as caught, atomic_write(path):
        pass
    assert str(caught.value) == (
        f"{path}, its place: found no such file or directory, expected a place that can be written to; "
        "give another path"
    )


def test_a_folder_of_the_same_name_is_rejected_and_no_file_is_left(tmp_path: Path):
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
def test_a_pipe_receives_the_bytes_and_is_not_replaced(tmp_path: Path):
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


def test_a_full_device_is_rejected_and_not_replaced(tmp_path: Path):
    link = tmp_path / "run.vcd"
    link.symlink_to("/dev/full")  # in a folder that may not be writable
    if not link.is_char_device():
        pytest.skip("there is no /dev/full")
    with pytest.raises(BadCapture) as caught, atomic_write(link) as unfinished:
        unfinished.write_text("new")
    assert str(caught.value) == (
        f"{link}, its place: found no space left on device, expected a place that can be written to; give another path"
    )
    assert link.is_char_device() and link.is_symlink()


def test_a_disk_that_becomes_full_during_the_write_is_reported(tmp_path: Path):
    path = tmp_path / "run.vcd"
    with pytest.raises(BadCapture, match="its place: found no space left on device"), atomic_write(path):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert os.listdir(tmp_path) == []
