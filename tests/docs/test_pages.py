"""Every command that README and docs show gives the output that they show."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.pages import CONSOLE, PAGES, commands, fitted, matches, refreshed, runs, scratch


@pytest.mark.long  # commands are processes of their own, in which nothing counts lines
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_shows_what_its_commands_print(page: Path, tmp_path: Path):
    text = page.read_text(encoding="utf-8")
    assert refreshed(text, tmp_path) == text, "run `python -m tests.docs.update` and look at the difference"


def test_commands_of_a_block_and_their_outputs():
    block = CONSOLE.findall("x\n```console\n$ periph-sim regs\none\n$ make demo\n```\ny\n")[0]
    assert list(commands(block)) == [("periph-sim regs", "one\n"), ("make demo", "")]
    assert [runs(command) for command, _ in commands(block)] == [True, False]


@pytest.mark.parametrize(
    ("shown", "came", "fits"),
    [
        ("a\n", "a\n", True),
        ("a\n", "b\n", False),
        ("a ... s\n", "a 1.25 s\n", True),
        ("a ... s\n", "a 1.25 s\nb\n", False),
        ("a\n...\nz\n", "a\nb\nc\nz\n", True),
        ("a\n...\n", "a\n", True),
        ("", "a\n", False),
        ("a.b\n", "axb\n", False),
    ],
)
def test_dots_stand_for_what_varies(shown: str, came: str, fits: bool):
    assert matches(shown, came) == fits


def test_output_that_changed_is_rewritten_and_varying_parts_are_kept(tmp_path: Path):
    page = "```console\n$ periph-sim --version\nold\n$ periph-sim --help\nUsage: ...\n...\n$ other\nkept\n```\n"
    fresh = refreshed(page, tmp_path)
    assert "old" not in fresh and "periph-sim, version" in fresh
    assert "Usage: ...\n...\n$ other\nkept\n```\n" in fresh


@pytest.mark.parametrize(
    ("shown", "came", "page"),
    [
        ("at 12 us ... s\n...\nend\n", "at 12 us 1 s\nmore\nend\n", "at 12 us ... s\n...\nend\n"),
        ("at 12 us ... s\n...\nend 3\n", "at  7 us 1 s\nmore\nend 4\n", "at  7 us ... s\n...\nend 4\n"),
        ("──\n...\n", "───\na\nb\n", "───\n...\n"),
        ("at 12 us ...\n", "of 12 us x\n", "of 12 us x\n"),
    ],
)
def test_new_figures_leave_what_is_left_out_as_it_was(shown: str, came: str, page: str):
    assert fitted(shown, came) == page


def test_files_of_a_page_are_there_for_its_commands(tmp_path: Path):
    scratch("<!-- file: a.toml -->\n```toml\nname = 1\n```\n", tmp_path)
    assert (tmp_path / "a.toml").read_text(encoding="utf-8") == "name = 1\n"
    assert (tmp_path / "timing" / "imu_hil.toml").is_file()
