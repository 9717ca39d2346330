"""Modules of a scene's parts. Each module is imported at its first use, so unused parts cost no import.

from . import parts;  parts.controller.build_head(...)  --> periph_sim.scene.controller is imported now
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import (
        controller,
        deadlock,
        derived_records,
        devices,
        faults,
        host,
        image_watching,
        measured_parts,
        outside_log,
        outside_parties,
        release_delay,
        sensor_chips,
        state,
        unit,
        watch,
    )

__all__ = [
    "controller",
    "deadlock",
    "derived_records",
    "devices",
    "faults",
    "host",
    "image_watching",
    "measured_parts",
    "outside_log",
    "outside_parties",
    "release_delay",
    "sensor_chips",
    "state",
    "unit",
    "watch",
]


def __getattr__(name: str) -> ModuleType:
    """Import the module of a part, and store it as an attribute so that later accesses do not call this function."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = globals()[name] = import_module(f".{name}", __package__)
    return module
