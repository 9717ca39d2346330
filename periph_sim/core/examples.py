"""Location of the shipped cases and firmware: inside the package in a wheel, next to it in a checkout."""

from __future__ import annotations

from pathlib import Path

_ROOM = Path(__file__).parents[1] / "examples"
EXAMPLES = _ROOM if _ROOM.is_dir() else Path(__file__).parents[2]
