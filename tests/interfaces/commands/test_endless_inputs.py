"""Inputs that never end, or that block: one sentence that is true of the file, exit status 2."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run

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


@pytest.mark.parametrize("file", ["zero", "pipe"])
@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_an_input_that_never_ends(periph_sim: Run, desk: Path, arguments: tuple[str, ...], file: str):
    def endless(name: str) -> None:
        (desk / name).parent.mkdir(exist_ok=True)
        (desk / name).symlink_to("/dev/zero") if file == "zero" else os.mkfifo(desk / name)

    for name in (file, f"{file}.py", f"{file}.asm", f"{file}.bin", f"folder-{file}/digital_0.bin"):
        endless(name)
    if arguments == COMMANDS["a baseline"]:
        endless("baselines/small.json")
    text = (desk / "small.toml").read_text()
    (desk / f"memory-{file}.toml").write_text(text + TARGET.replace("FILE", f"{file}.bin"))
    came = periph_sim(*(argument.replace("FILE", file) for argument in arguments))
    told = [line for line in (came.err + came.out).splitlines() if "ot a regular file" in line]
    assert came.status == 2 and told, came
    assert "there is no" not in came.err
