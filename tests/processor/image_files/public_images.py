"""Images published by others; a test that needs one which is not there is skipped with the reason."""

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
    """Return the path of the image of this row in public_images.toml, whose digest it must have."""
    return public_file(name, IMAGES[name])


def public_file(name: str, row: Mapping[str, str | int]) -> Path:
    """Return the path of the file that a row names."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        pytest.skip(f"{VARIABLE} names no folder of public images")
    path = Path(folder, str(row["repository"]), str(row["path"]))
    if not path.exists():
        pytest.skip(f"{name}: {path} is missing; it is {row['path']} of {row['repository']} at {row['commit']}")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert digest == row["sha256"], f"{name}: {path} is another version, {digest}"
    return path
