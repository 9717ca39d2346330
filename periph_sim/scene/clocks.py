"""SYSCLKOUT of the units of a scene, for a recording: a scene goes in; from which tick on each had which comes out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from .scene import Scene


def clocks_of(scene: Scene) -> Mapping[str, Sequence[tuple[int, Fraction]]]:
    """By unit, in Hz."""
    return {name: unit.clock_history for name, unit in scene.units.items()}
