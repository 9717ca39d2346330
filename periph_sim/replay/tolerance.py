"""How far an event of a replay may be from the capture's before it counts as a timing difference.

By default a sample period of the capture, within which nobody knows when its edges were, and one SYSCLKOUT cycle of
the slowest unit, to which the chip rounds what it sees.
"""

from __future__ import annotations

from fractions import Fraction

from ..scene.scene import Scene


def tolerance_of(given: Fraction | None, rate: Fraction, scene: Scene) -> Fraction:
    """Seconds."""
    if given is not None:
        return given
    return 1 / rate + max(1 / dsp.clock.hz for dsp in scene.units.values())
