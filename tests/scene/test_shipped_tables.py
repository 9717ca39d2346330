"""Data files of the package: a key that no code reads is refused in every one of their tables."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import periph_sim
from periph_sim import Scene, load
from periph_sim.imu import parameter_sets
from periph_sim.processor.c28x.encodings import read_table

PACKAGE = Path(periph_sim.__file__).parent
HEADER = re.compile(r"^\[.*\]$", re.MULTILINE)
FREE = re.compile(r"^\[.*\.settings\]$")  # of firmware, which defines its settings itself


def read_encodings(path: Path) -> object:
    return read_table(path.read_text(encoding="utf-8"))


def build(path: Path) -> object:
    """Build a scene, which reads the tables of devices."""
    return Scene(load(path))


READERS: dict[str, Callable[[Path], object]] = {
    "processor/c28x": read_encodings,
    "imu/models/sets": parameter_sets.load,
    "interfaces/commands/templates": build,
}
FILES = sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.toml"))


def reader(file: Path) -> Callable[[Path], object]:
    return READERS[file.parent.as_posix()]


@pytest.mark.parametrize("file", FILES, ids=str)
def test_a_key_that_no_code_reads_is_refused(file: Path, tmp_path: Path):
    text, copy = (PACKAGE / file).read_text(encoding="utf-8"), tmp_path / file.name
    for beside in (PACKAGE / file).parent.glob("*.*"):
        shutil.copy(beside, tmp_path)
    reader(file)(copy)
    headers = [found for found in HEADER.finditer(text) if not FREE.match(found.group())]
    for header in headers[:: max(1, len(headers) // 8)]:
        copy.write_text(f"{text[: header.end()]}\nunread_key = 1{text[header.end() :]}", encoding="utf-8")
        with pytest.raises(ValueError, match="unread_key"):
            reader(file)(copy)
