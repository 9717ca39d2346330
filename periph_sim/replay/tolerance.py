"""Tolerance for the times of events in a replay. A larger difference is a divergence of kind TIMING.

By default a sample period of the capture, which is the uncertainty of its edges, and one SYSCLKOUT cycle of the slowest
unit, to which the chip rounds its inputs.
"""

from __future__ import annotations

from fractions import Fraction

from ..scene.scene import Scene


def tolerance_of(given: Fraction | None, rate: Fraction, scene: Scene) -> Fraction:
    """Return `given`, or else a sample period plus a cycle, in seconds. rate: the number of samples in a second."""
    if given is not None:
        return given
    return 1 / rate + max(1 / dsp.clock.hz for dsp in scene.units.values())
