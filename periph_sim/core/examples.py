"""Where shipped cases and firmware are: a wheel has them inside the package; a checkout beside it."""

from __future__ import annotations

from pathlib import Path

_ROOM = Path(__file__).parents[1] / "examples"
EXAMPLES = _ROOM if _ROOM.is_dir() else Path(__file__).parents[2]
