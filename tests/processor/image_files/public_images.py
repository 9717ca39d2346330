"""Images that other people published: a name goes in, its path comes out, or the test is skipped with the reason."""

from __future__ import annotations

import hashlib
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest

VARIABLE = "PERIPH_SIM_IMAGES"
IMAGES: Mapping[str, Mapping[str, str | int]] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
)


def public_image(name: str) -> Path:
    """The file of this row of public_images.toml, with the contents that it had when the row was written."""
    return public_file(name, IMAGES[name])


def public_file(name: str, row: Mapping[str, str | int]) -> Path:
    """The file that a row of facts about files names."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        pytest.skip(f"{VARIABLE} names no folder of public images")
    path = Path(folder, str(row["repository"]), str(row["path"]))
    if not path.exists():
        pytest.skip(f"{name}: {path} is missing; it is {row['path']} of {row['repository']} at {row['commit']}")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert digest == row["sha256"], f"{name}: {path} is another version, {digest}"
    return path
