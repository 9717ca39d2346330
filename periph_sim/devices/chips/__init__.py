"""Models of sensor chips, independent of kernel, wires and files.

One file of this folder that has CHIP, the class of its chip, is one `model` of [chip.NAME], found by its presence.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from ...core.discover import modules_with


@cache
def chip_models() -> Mapping[str, type[Any]]:
    """Return the class of every chip, a `RegisterChip`, by the name of its file."""
    return {name: module.CHIP for name, module in modules_with("CHIP", __name__, __path__).items()}
