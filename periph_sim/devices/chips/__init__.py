"""Models of sensor chips. They do not depend on the bus, the event queue, or files.

Each file of this folder that defines CHIP, the class of a chip, is a model. Its file name, without .py, is a value of
the key `model` in the [chip.NAME] tables of a case. The files are found automatically.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from ...core.discover import modules_with


@cache
def chip_models() -> Mapping[str, type[Any]]:
    """Return the class of each chip, a subclass of `RegisterChip`, by the name of its model."""
    return {name: module.CHIP for name, module in modules_with("CHIP", __name__, __path__).items()}
