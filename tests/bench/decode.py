"""`make bench`, decoding: the whole command compared with sigrok-cli, and with unzipping alone, on the same files.

Each command is a new process whose output is discarded. The commands take turns, so that other work on the machine
affects all of them, and medians are shown. A CPU time far below the wall time means waiting for processor or disk.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from . import big_captures
from .timed import Seconds, middle, spent

Row = dict[str, Any]

OURS = "periph-sim decode"

# The options with which each program prints the same protocol rows.
ROWS = {
    "dense": (["--i2c", "scl=SCL,sda=SDA"], ["-P", "i2c:scl=SCL:sda=SDA", "-A", "i2c=addr-data:warnings"]),
    "sparse": (["--i2c", "scl=SCL,sda=SDA"], ["-P", "i2c:scl=SCL:sda=SDA", "-A", "i2c=addr-data:warnings"]),
    "uart": (
        ["--uart", "rx=RX,baud=115200"],
        ["-P", "uart:rx=RX:baudrate=115200", "-A", "uart=rx-data:rx-warnings"],
    ),
}
WHAT = {
    "dense": "I2C, 20 million samples, 1.03 million edges",
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
    """Yield name and command line of each program for one file."""
    ours, theirs = ROWS[name]
    yield OURS, [*_ours(), "decode", str(file), *ours]
    if found := shutil.which("sigrok-cli"):
        yield "sigrok-cli", [found, "-i", str(file), *theirs]
    yield "unzip alone, Python's zlib", [sys.executable, "-c", UNZIP, str(file)]
    if found := shutil.which("unzip"):
        yield "unzip alone, unzip -p", [found, "-p", str(file)]
    yield "starting Python with numpy", [sys.executable, "-c", NUMPY]


def _ours() -> list[str]:
    """Return the command beside this interpreter, as users start it."""
    beside = Path(sys.executable).with_name("periph-sim")
    return [str(beside)] if beside.exists() else [sys.executable, "-m", "periph_sim"]


def rows(repeat: int) -> Iterator[Row]:
    """Yield a row for each file and command."""
    with tempfile.TemporaryDirectory() as folder:
        for name, file in big_captures.write(Path(folder)).items():
            asked = list(commands(name, file))
            times: dict[str, list[Seconds]] = {who: [] for who, _ in asked}
            for _ in range(repeat):
                for who, command in asked:
                    times[who].append(spent(command))
            ours = middle(times[OURS])
            for who, taken in times.items():
                each = middle(taken)
                row = {"file": f"{name}: {WHAT[name]}", "who": who, "cpu_s": each.cpu, "wall_s": each.wall}
                yield row | {"times_as_long": each.cpu / ours.cpu}
            if "sigrok-cli" not in times:
                yield {"file": f"{name}: {WHAT[name]}", "who": "sigrok-cli", "skipped": "sigrok-cli is not installed"}


def line(row: Row) -> str:
    head = f"{row['file']:54} {row['who']:28}"
    if "skipped" in row:
        return f"{head} skipped: {row['skipped']}"
    return f"{head} {row['cpu_s']:.3f} s of cpu, {row['wall_s']:.3f} s of wall, {row['times_as_long']:.2f} times ours"
