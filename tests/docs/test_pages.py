"""Every command in README and docs prints the output that is shown."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.pages import (
    CONSOLE,
    PAGES,
    Run,
    commands,
    desk,
    fitted,
    matches,
    output,
    refreshed,
    runs,
    runs_of,
    scratch,
)

RUNS = runs_of(PAGES)


@pytest.mark.long  # the commands run in other processes, whose lines are not counted
@pytest.mark.parametrize("run", RUNS, ids=lambda run: f"{'+'.join(run.shown)}: {run.commands[0][:50]}")
def test_pages_show_what_their_commands_print(run: Run, tmp_path: Path):
    desk(tmp_path, run.files)
    result = [output(command, tmp_path) for command in run.commands]
    for page, shown in run.shown.items():
        fresh = [fitted(text, text_now) for text, text_now in zip(shown, result, strict=True)]
        assert fresh == list(shown), f"run `python -m tests.docs.update {page}` and look at the difference"


def test_every_command_of_every_page_is_in_a_run():
    there = [
        (page.stem, command, shown)
        for page in PAGES
        for block in CONSOLE.findall(page.read_text(encoding="utf-8"))
        for command, shown in commands(block)
        if runs(command)
    ]
    run = [
        (page, command, text)
        for one in RUNS
        for page, shown in one.shown.items()
        for command, text in zip(one.commands, shown, strict=True)
    ]
    assert sorted(run) == sorted(there) and len(there) > 100


def test_commands_with_shared_files_are_one_run_and_equal_runs_are_made_once(tmp_path: Path):
    (tmp_path / "a.md").write_text(
        "<!-- file: case.toml -->\n```toml\nfirmware = 'mine.py'\n```\n"
        "```console\n$ periph-sim run timing/x.toml --record a.psr\n1\n$ periph-sim run timing/x.toml\n2\n```\n"
        "```console\n$ periph-sim why a.psr\n3\n$ sed p > mine.py\n4\n$ periph-sim run case.toml\n5\n```\n"
    )
    (tmp_path / "b.md").write_text("```console\n$ periph-sim run timing/x.toml\n6\n```\n")
    (tmp_path / "c.md").write_text(
        "<!-- file: pytest.ini -->\n```ini\n[pytest]\n```\n```console\n$ pytest timing/x.toml\n7\n```\n"
    )
    (tmp_path / "d.md").write_text(
        "```console\n$ periph-sim new x\n8\n$ periph-sim regs\n9\n$ periph-sim check\n10\n```\n"
    )
    case = ("case.toml", "firmware = 'mine.py'\n")
    assert sorted(runs_of(sorted(tmp_path.glob("*.md")))) == [
        Run(("periph-sim new x", "periph-sim regs", "periph-sim check"), (), {"d": ("8\n", "9\n", "10\n")}),
        Run(("periph-sim run timing/x.toml",), (), {"a": ("2\n",), "b": ("6\n",)}),
        Run(("periph-sim run timing/x.toml --record a.psr", "periph-sim why a.psr"), (), {"a": ("1\n", "3\n")}),
        Run(("pytest timing/x.toml",), (("pytest.ini", "[pytest]\n"),), {"c": ("7\n",)}),
        Run(("sed p > mine.py", "periph-sim run case.toml"), (case,), {"a": ("4\n", "5\n")}),
    ]


def test_a_block_is_split_into_commands_and_outputs():
    block = CONSOLE.findall("x\n```console\n$ periph-sim regs\none\n$ make demo\n```\ny\n")[0]
    assert list(commands(block)) == [("periph-sim regs", "one\n"), ("make demo", "")]
    assert [runs(command) for command, _ in commands(block)] == [True, False]


@pytest.mark.parametrize(
    ("shown", "result", "fits"),
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
def test_dots_match_any_text(shown: str, result: str, fits: bool):
    assert matches(shown, result) == fits


def test_output_that_changed_is_rewritten_and_varying_parts_are_kept(tmp_path: Path):
    page = "```console\n$ periph-sim --version\nold\n$ periph-sim --help\nUsage: ...\n...\n$ other\nkept\n```\n"
    fresh = refreshed(page, tmp_path)
    assert "old" not in fresh and "periph-sim, version" in fresh
    assert "Usage: ...\n...\n$ other\nkept\n```\n" in fresh


@pytest.mark.parametrize(
    ("shown", "result", "page"),
    [
        ("at 12 us ... s\n...\nend\n", "at 12 us 1 s\nmore\nend\n", "at 12 us ... s\n...\nend\n"),
        ("at 12 us ... s\n...\nend 3\n", "at  7 us 1 s\nmore\nend 4\n", "at  7 us ... s\n...\nend 4\n"),
        ("──\n...\n", "───\na\nb\n", "───\n...\n"),
        ("at 12 us ...\n", "of 12 us x\n", "of 12 us x\n"),
    ],
)
def test_new_figures_keep_text_that_is_left_out(shown: str, result: str, page: str):
    assert fitted(shown, result) == page


def test_files_of_a_page_are_written_for_its_commands(tmp_path: Path):
    scratch("<!-- file: a.toml -->\n```toml\nname = 1\n```\n", tmp_path)
    assert (tmp_path / "a.toml").read_text(encoding="utf-8") == "name = 1\n"
    assert (tmp_path / "timing" / "imu_hil.toml").is_file()
