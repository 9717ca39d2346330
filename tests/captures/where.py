"""Where the real captures lie: data that is not part of the repository, found beside it or by PERIPH_SIM_CAPTURES.

Beside each capture stands what an independent decoder said of it, a line an annotation:
`first-last decoder-1: text`, with sample numbers.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import NamedTuple

import pytest

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "captures"
FOLDER = Path(os.environ.get("PERIPH_SIM_CAPTURES", BESIDE))

needs_captures = pytest.mark.skipif(
    not FOLDER.is_dir(), reason=f"no captures in {FOLDER}; set PERIPH_SIM_CAPTURES to the folder that holds them"
)

NO_CAPTURE = {".txt", ".md"}


class Said(NamedTuple):
    """One annotation of the oracle."""

    at: int
    end: int
    text: str


def captures() -> list[Path]:
    """Every capture: files, folders of one-channel files, and the three exports of saleae_cap1."""
    if not FOLDER.is_dir():
        return []
    found = [p for p in FOLDER.iterdir() if p.is_file() and p.suffix not in NO_CAPTURE]
    found += [p for p in FOLDER.iterdir() if p.is_dir() and any(p.glob("digital_*.bin"))]
    found += (FOLDER / "saleae_cap1").glob("*.csv")
    return sorted(p for p in found if not p.name.endswith(".saleae.csv"))


def decoded(kind: str) -> list[str]:
    """Names, without ends, of the captures with an oracle's decode of the kind, i2c or uart."""
    return sorted(p.name.removesuffix(f".{kind}.txt") for p in FOLDER.glob(f"*.{kind}.txt"))


def capture_of(name: str) -> Path:
    """The capture beside a decode; the decode of a folder NAME_bin is called NAME."""
    return next(p for p in captures() if p.stem in (name, f"{name}_bin"))


def oracle(name: str, kind: str) -> list[Said]:
    """The annotations, in the order of the file."""
    found = []
    for line in (FOLDER / f"{name}.{kind}.txt").read_text().splitlines():
        if match := re.match(r"(\d+)-(\d+) \w+-1: (.*)", line):
            found.append(Said(int(match[1]), int(match[2]), match[3]))
    return found


def remarks(name: str, kind: str) -> str:
    """The comment lines at the head: command, options, counts."""
    lines = (FOLDER / f"{name}.{kind}.txt").read_text().splitlines()
    return "\n".join(line for line in lines if line.startswith("#"))
