"""`make bench`, decoding: the whole command beside sigrok-cli on the same files, and beside unzipping them alone.

python -m tests.bench.decode [--folder FOLDER] [--repeats N]

Each command is a fresh process with its output to nowhere; commands take turns, so that all meet the same other
work on the machine; medians are shown. cpu far below wall means that others had the processor, or the disk did.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter

from . import big_captures
from .timed import Seconds, middle

REPEATS = 5

# What each is asked for: the same protocol rows.
ROWS = {
    "dense": (["--i2c", "scl=SCL,sda=SDA"], ["-P", "i2c:scl=SCL:sda=SDA", "-A", "i2c=addr-data:warnings"]),
    "sparse": (["--i2c", "scl=SCL,sda=SDA"], ["-P", "i2c:scl=SCL:sda=SDA", "-A", "i2c=addr-data:warnings"]),
    "uart": (
        ["--uart", "rx=RX,baud=115200"],
        ["-P", "uart:rx=RX:baudrate=115200", "-A", "uart=rx-data:rx-warnings"],
    ),
}
WHAT = {
    "dense": "I2C, 20 million samples, 1.05 million edges",
    "sparse": "I2C, 50 million samples, 37 thousand edges",
    "uart": "UART 115200, 76 million samples, 164 thousand edges",
}

UNZIP = """
import sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as archive:
    for member in archive.namelist():
        with archive.open(member) as stream:
            while stream.read(1 << 20):
                pass
"""
NUMPY = "import numpy"


def commands(name: str, file: Path) -> Iterator[tuple[str, list[str]]]:
    """(who, command line) for one file."""
    ours, theirs = ROWS[name]
    yield "periph-sim decode", [*_ours(), "decode", str(file), *ours]
    if found := shutil.which("sigrok-cli"):
        yield "sigrok-cli", [found, "-i", str(file), *theirs]
    yield "unzip alone, Python's zlib", [sys.executable, "-c", UNZIP, str(file)]
    if found := shutil.which("unzip"):
        yield "unzip alone, unzip -p", [found, "-p", str(file)]
    yield "starting Python with numpy", [sys.executable, "-c", NUMPY]


def _ours() -> list[str]:
    """The command beside this interpreter, as users start it."""
    beside = Path(sys.executable).with_name("periph-sim")
    return [str(beside)] if beside.exists() else [sys.executable, "-m", "periph_sim"]


def spent(command: Sequence[str]) -> Seconds:
    """How long one process took, output to nowhere."""
    before, wall = os.times(), perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    wall, after = perf_counter() - wall, os.times()
    cpu = after.children_user - before.children_user + after.children_system - before.children_system
    return Seconds(wall, cpu)


def rows(folder: Path, repeats: int) -> Iterator[tuple[str, str, str, str]]:
    """(what, wall, cpu, times as long as ours) for each file and command."""
    for name, file in big_captures.write(folder).items():
        asked = list(commands(name, file))
        times: dict[str, list[Seconds]] = {who: [] for who, _ in asked}
        for _ in range(repeats):
            for who, command in asked:
                times[who].append(spent(command))
        ours = middle(times["periph-sim decode"])
        yield f"{name}: {WHAT[name]}", "", "", ""
        for who, taken in times.items():
            each = middle(taken)
            yield f"  {who}", f"{each.wall:.3f} s", f"{each.cpu:.3f} s", f"{each.wall / ours.wall:.2f}"
        if "sigrok-cli" not in times:
            yield "  sigrok-cli", "is not installed", "", ""


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.decode", description="How fast captures are decoded.")
    parser.add_argument("--folder", type=Path, help="where the files are kept; else they are made and thrown away")
    parser.add_argument("--repeats", type=int, default=REPEATS)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as own:
        folder = given.folder or Path(own)
        folder.mkdir(parents=True, exist_ok=True)
        line = "| {:<58} | {:>16} | {:>9} | {:>12} |"
        print(line.format("file and command, median of " + str(given.repeats), "wall", "cpu", "ours is 1"))
        print(line.format("-" * 58, "-" * 16, "-" * 9, "-" * 12))
        for row in rows(folder, given.repeats):
            print(line.format(*row), flush=True)


if __name__ == "__main__":
    main()
