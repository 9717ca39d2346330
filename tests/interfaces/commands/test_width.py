"""Every command that prints a table, at 80 columns: no line is longer, and no text is cut off.

A line that states one finding is not wrapped, so that `grep` finds it. `SENTENCES` lists these kinds of line.
"""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from periph_sim.cli import cli
from periph_sim.processor.image_files.assemble import assemble_file
from periph_sim.processor.image_files.coff2 import write
from tests.interfaces.commands.conftest import Run
from tests.processor.image_files.own_images import image

ROOT = Path(__file__).resolve().parents[3]
ROUND, NACK, FRAMES, SESSION = (
    str(ROOT / "traces" / f"{name}.sr") for name in ("imu_round", "nack", "host_frames", "imu_session")
)

SENTENCES = {
    r"run \d+: ": "a run of a sweep with its values",
    r"\w+: PASS, .*; cycles between accesses of \w+ are estimated": "the verdict of C sources",
    r"at the end: ": "where an image is, and what it waits for",
    r"stuck: ": "what hangs, since when and why",
    r"note: (?!polls of|reads: |A read that)": "a note of this run or capture; those that explain a table are wrapped",
    r"\S+ at [\d.]+ ms: .* before": "the answer of `why`",
    r"\S+: I2C limits of mode ": "the title of `compliance`, after the capture's path",
    r"first difference: |  .* at [AB] [\d.]+ s": "events that differ, of `diff`",
    r"first wrong: ": "the received and the expected bytes",
    r"[\w .]+: .* is (over|under) its limit of ": "a broken budget with its instant",
    r"(dsp|unit) \S+: .* \[.*\]$": "a finding of a lint, in the form of a compiler's messages",
    r"DIFFERENT: |EQUAL: |UNDECIDABLE at ": "the verdict of diff and compliance",
    r"[\w .]+: '.*' still waited for .* when the run ended": "a budget that was not judged to the end, with its events",
    r"[\w ]+: .* \(max .*\); ": "the parts of a budget of several measures",
    r"\S+, \S+: (PASS|FAIL)": "the verdict of a replay, after the capture's path",
    r"[\d.]+  S .* P$": "a transfer of `decode --transfers` is one line, however long",
}

PRINTS_NO_TABLE = {
    "assemble": "a line of the file written",
    "convert": "a line that names the file written",
    "host-unit": "the number of frames sent and their lateness",
    "new": "a line for each file, and the next steps",
    "schema": "JSON",
    "terminal": "what is typed and answered, then what `run` prints",
    "watch": "what `run` prints, again and again",
}


def case(name: str) -> str:
    return str(ROOT / "timing" / f"{name}.toml")


CASES = sorted(path.stem for path in (ROOT / "timing").glob("*.toml"))
SHORT = ("--seconds", "0.1")
ROWS = ("--row", "record .psr", "--max-error", "1 us")
RECORDED = ("run", case("imu_hil_published"), *SHORT, "--record", "run.psr")
SLOW = ("--set", "unit.dsp.settings.frame_cost=200 us")
COMMANDS = [
    *(
        ("run", str(path), *SHORT, "-v")
        for path in sorted((ROOT / "timing").glob("*.toml"))
        if path.stem != "imu_hil_c"
    ),
    ("run", case("imu_hil_c"), "-v"),
    ("run", case("late_model"), "--seconds", "0.2"),
    ("check", case("responder"), case("uart_logger")),
    ("sweep", case("imu_hil_no_sdir"), *SHORT, "--jobs", "1", "--vary", "controller.rate=50 kHz, 100 kHz"),
    ("prove", case("imu_hil_published"), "--phases", "1.577 ms to 1.579 ms", "--jobs", "1"),
    ("prove", case("imu_hil_published"), *SLOW, "--phases", "18.95 ms to 18.953 ms", "--jobs", "1"),
    ("worst", case("imu_hil_no_sdir"), *SHORT),
    ("worst", case("imu_hil_drift"), "--seconds", "0.43", "--set", "unit.dsp.settings.frame_cost=200 us"),
    ("trade", case("imu_hil"), "--seconds", "0.04", *ROWS),
    ("trade", case("uart_logger"), "--seconds", "0.01", *ROWS),
    ("serve", case("uart_logger"), "--pty", "--pace", "0", "--for", "100 ms"),
    ("races", "run.psr"),
    ("races", "run.psr", "--register", "I2C-A.I2CSTR"),
    ("why", "run.psr", "I2C-A.I2CDXR.DATA@33.3ms"),
    ("why", "run.psr", "I2C-A.I2CSTR.SDIR@33.3ms"),
    ("why", "run.psr", "SCL@33.3ms"),
    ("lint", "run.psr"),
    ("regs",),
    ("image", "own.out"),
    ("image", "own.out", "-v"),
    ("image", "--cycles", "echo.out", "_echo"),
    ("profile", "echo.toml"),
    ("regs", "I2C-A"),
    ("regs", "I2C-A.I2CSTR"),
    ("regs", "--options"),
    ("decode", ROUND),
    ("decode", ROUND, "--times"),
    ("decode", ROUND, "--transfers"),
    ("decode", FRAMES, "--uart", "rx=RX,baud=auto"),
    *(("compliance", ROUND, "--mode", mode) for mode in ("standard", "fast", "fast-plus")),
    ("compliance", SESSION, "--mode", "fast-plus"),
    ("diff", ROUND, NACK, "--all"),
    ("diff", ROUND, ROUND),
    ("replay", ROUND, "--case", case("responder"), "--map", "scl=SCL,sda=SDA"),
    ("replay", ROUND, "--case", case("responder"), "--address", "0x53"),
    ("replay", ROUND, "--case", case("imu_hil_published"), "--loop", "open", "--first", "1"),
    ("replay", FRAMES, "--case", case("uart_logger"), "--map", "rx=RX"),
    ("imu-table", "--samples", "1000", "--write", "rest.csv"),
    ("imu-table", "--turn"),
    ("identify", "rest.csv", "--slow-terms"),
    ("extremes", "--samples", "100", "--only", "roll rate beyond frames", "--only", "clocks"),
    ("moving", case("imu_moving"), "--direct", "--seconds", "0.6"),
]


def test_every_command_is_tested_or_prints_no_table():
    assert {command[0] for command in COMMANDS} | set(PRINTS_NO_TABLE) == set(cli.list_commands(click.Context(cli)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `own.out` and `echo.toml`, in which `run.psr` and `rest.csv` are created when they are needed."""
    folder = tmp_path_factory.mktemp("width")
    (folder / "own.out").write_bytes(write(image()))
    (folder / "echo.out").write_bytes(assemble_file(ROOT / "firmware" / "c28x" / "sci_echo.asm")[1])
    (folder / "echo.toml").write_text(
        'name = "echo"\nduration = "1 ms"\n[unit.dsp]\nimage = "echo.out"\nmodules = ["SCI-A"]\n'
    )
    return folder


def make_inputs(periph_sim: Run, wanted: tuple[str, ...]) -> None:
    for name, maker in (("run.psr", RECORDED), ("rest.csv", ("imu-table", "--samples", "4000", "--write", "rest.csv"))):
        if name in wanted and maker != wanted and not Path(name).exists():
            periph_sim(*maker)


def command_id(command: tuple[str, ...]) -> str:
    return " ".join(part.removeprefix(f"{ROOT}/") for part in command)


@pytest.mark.parametrize("command", COMMANDS, ids=command_id)
def test_no_line_is_longer_than_80_columns(
    periph_sim: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
):
    monkeypatch.chdir(folder)
    make_inputs(periph_sim, command)
    result = periph_sim(*command)
    assert result.status in (0, 1) and result.out, result.err
    report = [line.replace(f"{ROOT}/", "") for line in result.out.splitlines()]
    long = [line for line in report if len(line) > 80]
    assert [line for line in long if not any(re.match(begin, line) for begin in SENTENCES)] == []
    assert "…" not in result.out
