"""While a command runs, a file that it has read is known by each of its names; afterwards by none."""

from __future__ import annotations

from pathlib import Path

from periph_sim.core.input_files import inputs_of_one_command, is_input, note_input


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


def test_a_file_that_does_not_exist_is_no_input(tmp_path: Path):
    with inputs_of_one_command():
        note_input(tmp_path / "later")
        (tmp_path / "later").write_text("")
        assert not is_input(tmp_path / "later")
        assert not is_input(Path("a\0b"))
