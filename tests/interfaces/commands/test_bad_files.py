"""Endless inputs, very long texts and outputs that would overwrite an input: a short error message, exit status 2."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.traces.formats.writers import metadata, zip_bytes

TARGET = '\n[device.m]\nmodel = "24lc64"\naddress = 0x50\ncontents = "FILE"\n'
COMMANDS = {
    "a case": ("run", "FILE"),
    "a case by a change": ("run", "small.toml", "--set", "unit.dsp.firmware=FILE.py"),
    "a case to check": ("check", "FILE"),
    "a case to sweep": ("sweep", "FILE", "--vary", "seed=1", "--jobs", "1"),
    "an image": ("image", "FILE"),
    "assembly": ("image", "FILE.asm"),
    "a flight": ("host-unit", "loop://", "--flight", "FILE", "--frames", "1"),
    "a recording at rest": ("identify", "FILE"),
    "a run to explain": ("why", "FILE", "SDA@1 us"),
    "a run to lint": ("lint", "FILE"),
    "a capture": ("decode", "FILE"),
    "a capture of a folder": ("decode", "folder-FILE"),
    "a capture to convert": ("convert", "FILE", "out.vcd"),
    "the log of a session": ("new", "--live", "FILE", "again"),
    "a baseline": ("check", "small.toml"),
    "contents": ("run", "memory-FILE.toml"),
}


@pytest.mark.posix("/dev/zero and pipes with a name")
@pytest.mark.parametrize("file", ["zero", "pipe"])
@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_an_endless_input_is_rejected(periph_sim: Run, desk: Path, arguments: tuple[str, ...], file: str):
    def endless(name: str) -> None:
        (desk / name).parent.mkdir(exist_ok=True)
        (desk / name).symlink_to("/dev/zero") if file == "zero" else os.mkfifo(desk / name)

    for name in (file, f"{file}.py", f"{file}.asm", f"{file}.bin", f"folder-{file}/digital_0.bin"):
        endless(name)
    if arguments == COMMANDS["a baseline"]:
        endless("baselines/small.json")
    text = (desk / "small.toml").read_text()
    (desk / f"memory-{file}.toml").write_text(text + TARGET.replace("FILE", f"{file}.bin"))
    result = periph_sim(*(argument.replace("FILE", file) for argument in arguments))
    report = [line for line in (result.err + result.out).splitlines() if "ot a regular file" in line]
    assert result.status == 2 and report, result
    assert "there is no" not in result.err


ROOT = Path(__file__).resolve().parents[3]
NACK, FRAMES = (str(ROOT / "traces" / name) for name in ("nack.sr", "host_frames.sr"))
RESPONDER, LOGGER = (str(ROOT / "timing" / name) for name in ("responder.toml", "uart_logger.toml"))
LONG = "9" * 5000
LONGEST = 3000  # characters of the whole message, click's usage lines included

OPTIONS = [
    ("decode", NACK, "--rate", LONG),
    ("decode", NACK, "--i2c", f"scl={LONG},sda=1"),
    ("decode", NACK, "--glitch", LONG),
    ("decode", NACK, "--glitch", f"{LONG}ns"),
    ("decode", NACK, "--uart", f"rx=0,baud={LONG}"),
    ("decode", NACK, "--uart", LONG),
    ("decode", LONG),
    ("convert", NACK, "a.vcd", "--window", f"0..{LONG}"),
    ("convert", NACK, "a.vcd", "--channels", LONG),
    ("convert", NACK, f"a.{LONG}"),
    ("diff", NACK, NACK, "--tolerance", f"{LONG}us"),
    ("diff", FRAMES, FRAMES, "--uart", f"baud={LONG}"),
    ("replay", NACK, "--case", RESPONDER, "--address", LONG),
    ("replay", NACK, "--case", RESPONDER, "--map", f"scl={LONG}"),
    ("replay", FRAMES, "--case", LOGGER, "--baud", LONG),
    ("compliance", NACK, "--mode", "fast", "--map", f"scl={LONG},sda=1"),
    ("compliance", NACK, "--mode", "fast", "--rate", "1e99"),
]


@pytest.mark.parametrize("arguments", OPTIONS, ids=lambda arguments: f"{arguments[0]} {arguments[-2][:12]}")
def test_the_message_about_a_very_long_option_is_short(periph_sim: Run, desk: Path, arguments: tuple[str, ...]):
    result = periph_sim(*arguments)
    assert result.status == 2 and result.out == ""
    assert "Traceback" not in result.err and "Exceeds the limit" not in result.err
    assert 0 < len(result.err) < LONGEST


@pytest.mark.parametrize(
    "names", [["A" * 5000, "B" * 5000], [f"channel {n} {'C' * 200}" for n in range(64)]], ids=["long", "many"]
)
@pytest.mark.parametrize("command", [("decode",), ("compliance", "--mode", "fast"), ("replay", "--case", RESPONDER)])
def test_the_list_of_many_or_long_channel_names_is_short(periph_sim: Run, desk: Path, command, names: list[str]):
    Path("names.sr").write_bytes(
        zip_bytes({"version": b"2", "metadata": metadata(names, "1 MHz", 8), "logic-1-1": bytes(80)})
    )
    result = periph_sim(command[0], "names.sr", *command[1:])
    assert result.status == 2 and names[0][:20] in result.err and len(result.err) < LONGEST


SHORT = ("--seconds", "0.001")
CASES = {
    "page over case": ("run", "small.toml", "--html", "small.toml", *SHORT),
    "page over case by a link": ("run", "small.toml", "--html", "link.toml", *SHORT),
    "page over firmware": ("run", "small.toml", "--html", "still.py", *SHORT),
    "page over a module that firmware imports": ("run", "small.toml", "--html", "helper.py", *SHORT),
    "page over a log of another session": ("run", "again.toml", "--html", "live.jsonl", *SHORT),
    "page over a module that is imported later": ("run", "small.toml", "--html", "later.py", *SHORT),
    "JUnit over case": ("check", "small.toml", "--junit", "small.toml"),
    "JUnit over firmware of another process": ("check", "small.toml", "--junit", "still.py", "--jobs", "2"),
    "JUnit over baseline": ("check", "small.toml", "--junit", "baselines/small.json"),
    "JUnit over coverage": ("check", "small.toml", "--junit", "coverage/small.json"),
    "page over baseline": ("run", "small.toml", "--html", "baselines/small.json", *SHORT),
    "page over proof": ("run", "small.toml", "--html", "proofs/small.json", *SHORT),
    "rows over proof": ("sweep", "small.toml", "--vary", "seed=0,1", "--csv", "proofs/small.json", *SHORT),
    "page over an unfinished table": ("run", "small.toml", "--html", "proofs/small.unfinished", *SHORT),
    "functions over proof": ("profile", "small.toml", "--lcov", "proofs/small.json", *SHORT),
    "page over a case in a folder": ("check", ".", "--html", "small.toml"),
    "rows over case": ("sweep", "small.toml", "--vary", "seed=0,1", "--csv", "small.toml", *SHORT),
    "rows over firmware": ("sweep", "small.toml", "--vary", "seed=0,1", "--csv", "still.py", *SHORT),
    "parameters over samples": ("identify", "rest.csv", "--write-parameters", "rest.csv"),
}


@pytest.mark.parametrize("arguments", CASES.values(), ids=CASES)
def test_an_output_never_overwrites_an_input(periph_sim: Run, desk: Path, arguments: tuple[str, ...]):
    (desk / "link.toml").symlink_to("small.toml")
    (desk / "helper.py").touch()
    (desk / "still.py").write_text("from . import helper\n" + (desk / "still.py").read_text())
    (desk / "later.py").touch()
    (desk / "again.toml").write_text(
        (desk / "small.toml").read_text() + '[outside]\nwires = ["RX"]\nlog = "live.jsonl"\n'
    )
    for name in (
        "live.jsonl",
        "baselines/small.json",
        "coverage/small.json",
        "proofs/small.json",
        "proofs/small.unfinished",
        "rest.csv",
    ):
        (desk / name).parent.mkdir(exist_ok=True)
        (desk / name).write_text("as it was\n")
    before = {file: file.read_bytes() for file in desk.rglob("*") if file.is_file()}
    result = periph_sim(*arguments)
    assert result.status == 2
    (report,) = [
        line for line in result.err.splitlines() if not line.startswith("the compiled core was built of other")
    ]
    assert "found a file that this command reads, expected a file that is no input" in report
    assert {file: file.read_bytes() for file in desk.rglob("*") if file.is_file()} == before


def test_update_baseline_overwrites_a_baseline(periph_sim: Run, desk: Path):
    for _ in range(2):
        assert periph_sim("check", "small.toml", "--update-baseline", "--junit", "out.xml").status in (0, 1)
    assert (desk / "baselines" / "small.json").is_file()
