"""Folders of captures: traces/ of the repository, and real captures beside the repository or at PERIPH_SIM_CAPTURES.

Those of the repository are recordings of runs and drawn waves, so that every test of captures has some; the real ones
are not part of the repository. Beside each capture is the output of an independent decoder (the oracle), one
annotation per line: `first-last decoder-1: text`, with sample numbers.
"""

from __future__ import annotations

import os
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
OURS = ROOT / "traces"
FOLDER = Path(os.environ.get("PERIPH_SIM_CAPTURES", ROOT.parent / "shared" / "captures"))

needs_captures = pytest.mark.skipif(
    not FOLDER.is_dir(), reason=f"no real captures in {FOLDER}; set PERIPH_SIM_CAPTURES to the folder that holds them"
)

NO_CAPTURE = {".txt", ".md"}


class Said(NamedTuple):
    """One annotation of the oracle."""

    at: int
    end: int
    text: str


def captures() -> list[Path]:
    """Return every capture: files, folders of one-channel files, and the three exports of saleae_cap1."""
    found = [p for folder in _folders() for p in folder.iterdir() if p.is_file() and p.suffix not in NO_CAPTURE]
    found += [p for folder in _folders() for p in folder.iterdir() if p.is_dir() and any(p.glob("digital_*.bin"))]
    found += (FOLDER / "saleae_cap1").glob("*.csv")
    return sorted(p for p in found if not p.name.endswith(".saleae.csv"))


def decoded(kind: str) -> list[str]:
    """Return the names, without suffixes, of the captures with an oracle's decode of the kind, i2c or uart."""
    return sorted(p.name.removesuffix(f".{kind}.txt") for folder in _folders() for p in folder.glob(f"*.{kind}.txt"))


def capture_of(name: str) -> Path:
    """Return the capture beside a decode; the decode of a folder NAME_bin is called NAME."""
    return next(p for p in _all_captures() if p.stem in (name, f"{name}_bin"))


@cache
def _all_captures() -> list[Path]:
    return captures()


def oracle(name: str, kind: str) -> list[Said]:
    """Return the annotations in the order of the file."""
    found = []
    for line in _decode(name, kind):
        if match := re.match(r"(\d+)-(\d+) \w+-1: (.*)", line):
            found.append(Said(int(match[1]), int(match[2]), match[3]))
    return found


def remarks(name: str, kind: str) -> str:
    """Return the comment lines at the head: command, options, counts."""
    return "\n".join(line for line in _decode(name, kind) if line.startswith("#"))


def _folders() -> list[Path]:
    return [folder for folder in (OURS, FOLDER) if folder.is_dir()]


@cache
def _decode(name: str, kind: str) -> list[str]:
    file = next(path for folder in _folders() if (path := folder / f"{name}.{kind}.txt").is_file())
    return file.read_text().splitlines()
