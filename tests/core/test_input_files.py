"""Files that the running command has read are recognized as its inputs by each of their names."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from periph_sim.core.input_files import (
    inputs_of_one_command,
    is_input,
    note_input,
    note_inputs_of,
    open_input,
    open_regular,
    read_input,
    read_regular,
    similar_file,
)


@pytest.mark.posix("links")
def test_a_file_that_was_read_is_an_input_by_each_of_its_names(tmp_path: Path):
    case, other = tmp_path / "case.toml", tmp_path / "other.toml"
    case.write_text("")
    other.write_text("")
    (tmp_path / "hard").hardlink_to(case)
    (tmp_path / "soft").symlink_to(case)
    with inputs_of_one_command():
        assert note_input(case) == case
        assert all(is_input(tmp_path / name) for name in ("case.toml", "hard", "soft"))
        assert is_input(tmp_path / "." / "case.toml")
        assert not is_input(other)
        assert not is_input(tmp_path / "absent")


def test_a_command_forgets_its_inputs_at_its_end_and_one_inside_it_does_not(tmp_path: Path):
    note_input(tmp_path)
    with inputs_of_one_command():
        assert not is_input(tmp_path)  # noted before the command
        with inputs_of_one_command():
            note_input(tmp_path)
        assert is_input(tmp_path)
    assert not is_input(tmp_path)


def test_a_file_that_did_not_exist_when_noted_is_not_an_input(tmp_path: Path):
    with inputs_of_one_command():
        note_input(tmp_path / "later")
        (tmp_path / "later").write_text("")
        assert not is_input(tmp_path / "later")
        assert not is_input(Path("a\0b"))


def test_a_module_that_was_imported_is_an_input_without_a_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    drivers = tmp_path / "drivers_of_this_test.py"
    drivers.touch()
    assert not is_input(drivers)
    monkeypatch.syspath_prepend(tmp_path)
    __import__(drivers.stem)
    assert is_input(drivers)
    del sys.modules[drivers.stem]


def test_files_are_not_looked_up_while_no_command_runs(tmp_path: Path):
    note_inputs_of(pytest.fail("looked up") for _ in range(1))
    with inputs_of_one_command():
        note_inputs_of([tmp_path, tmp_path / "absent"])
        assert is_input(tmp_path)


def test_a_file_is_read_and_noted_unless_its_reader_may_replace_it(tmp_path: Path):
    file, baseline = tmp_path / "file", tmp_path / "baseline"
    for path in (file, baseline):
        path.write_bytes(b"four")
    with inputs_of_one_command():
        assert read_input(file, 4) == read_regular(baseline, 4) == b"four"
        assert is_input(file) and not is_input(baseline)
        with open_input(baseline) as opened:
            assert opened.read() == b"four" and is_input(baseline)


@pytest.mark.posix("devices and pipes with a name")
def test_devices_pipes_and_long_files_are_refused_before_they_are_read(tmp_path: Path):
    (tmp_path / "zero").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "long").write_bytes(b"three")
    for name, why in (
        ("zero", "Not a regular file"),
        ("pipe", "Not a regular file"),
        ("long", "Longer than 4 bytes"),
        ("a\0b", "Not a file name"),
        ("absent", "No such file or directory"),
    ):
        for read in (read_input, read_regular, open_input, open_regular):
            with pytest.raises(OSError) as caught:
                read(tmp_path / name, 4)
            assert (caught.value.strerror, caught.value.filename) == (why, str(tmp_path / name))
    with pytest.raises(IsADirectoryError):
        read_input(tmp_path)


def test_a_file_whose_size_is_not_known_is_read_up_to_its_limit():
    assert os.stat("/proc/self/status").st_size == 0
    with pytest.raises(OSError, match="Longer than 4 bytes"):
        read_input(Path("/proc/self/status"), 4)


def test_files_that_share_only_the_suffix_are_not_similar(tmp_path: Path):
    for name in ("pyproject.toml", "memory.toml"):
        (tmp_path / name).touch()
    assert similar_file(tmp_path / "none.toml") == ""
    assert similar_file(tmp_path / "memry.toml") == f"did you mean {tmp_path / 'memory.toml'}?"
    assert similar_file(tmp_path / "memory.tml") == f"did you mean {tmp_path / 'memory.toml'}?"
    (tmp_path / "memry.toml").symlink_to("nowhere")
    assert similar_file(tmp_path / "memry.toml") == f"did you mean {tmp_path / 'memory.toml'}?"
