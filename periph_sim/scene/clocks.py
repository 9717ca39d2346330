"""SYSCLKOUT of the units of a scene over time, for a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from .scene import Scene


def clocks_of(scene: Scene) -> Mapping[str, Sequence[tuple[int, Fraction]]]:
    """Return (first tick, SYSCLKOUT in Hz) of each interval of constant frequency, by unit."""
    return {name: unit.clock_history for name, unit in scene.units.items()}
