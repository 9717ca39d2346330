"""The chips of the family. Each chip has a file with its name, in which `PART` describes it."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import cast

from ...core.discover import module_with
from ..descriptor import Part


def part_names() -> tuple[str, ...]:
    """Return the names of all parts, such as "F28335", as a case writes them."""
    return tuple(sorted(file.stem.upper() for file in Path(__file__).parent.glob("f*.py")))


@cache
def part_named(name: str) -> Part | None:
    """Return the part with this name, such as "F28335", or None. Import only its file and the files that it uses."""
    module = module_with("PART", __name__, __path__, name.lower()) if name.isupper() else None
    return None if module is None else cast(Part, module.PART)
