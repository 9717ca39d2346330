"""The true values during a run: x, y, z that each chip should show at an instant, in its LSB.

    frames of the host --LineBetweenFrames--> Truth --> budgets on "value error"
    motion, sensors ---------MotionTruth-------> Truth

Times are seconds from the instant at which the host's first frame is due. If the chips show the values of frames, the
truth is the line between them; with sensor models, it is what ideal sensors with the same parameters would show of the
true motion at that instant. It has no noise: a sensor's noise is not a property of the body, and the sample in a read
depends on the firmware's timing, of which truth is independent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import floor
from typing import Protocol, TypeVar

from ..imu.models.parameters import ImuParameters
from ..imu.motion import Motion

Axes = Sequence[Fraction | float]
T = TypeVar("T")

WORD = 1 << 16  # values are 16-bit words: 32767 is followed by -32768


class Truth(Protocol):
    """The true values, independent of the firmware."""

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        """Return by chip x, y, z in LSB at this time after the first frame was due; negative before."""


def shown(values: Sequence[T]) -> dict[str, Sequence[T]]:
    """Return what the chips show of a frame's six values without sensor models."""
    return {"gyroscope": values[0:3], "accelerometer": values[3:6], "magnetometer": values[0:3]}


class LineBetweenFrames:
    """The straight line from each frame's values to the next one's; before the first frame, that one's values.

    frame: number -> six values. period: seconds from one frame to the next. A value beyond one end of 16 bits continues
    at the other one.
    """

    def __init__(self, frame: Callable[[int], tuple[int, ...]], period: Fraction) -> None:
        self._frame = frame
        self._period = period

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        place = max(seconds, Fraction(0)) / self._period
        number = floor(place)
        now, later = self._frame(number), self._frame(number + 1)
        part = place - number
        return shown([a + part * distance(b, a) for a, b in zip(now, later, strict=True)])


class MotionTruth:
    """Float64 models of a motion, without noise. first: seconds of the motion's time at which frame 0 is due."""

    KEPT = 64  # cached instants: each is used for several chips and budgets

    def __init__(self, imu: ImuParameters, motion: Motion, first: Fraction) -> None:
        self._imu = imu
        self._motion = motion
        self._first = first
        self._at: Callable[[Fraction], Mapping[str, Axes]] | None = None  # built on first use, which few runs need

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        if self._at is None:
            self._at = lru_cache(self.KEPT)(self._sensed())
        return self._at(seconds)

    def _sensed(self) -> Callable[[Fraction], Mapping[str, Axes]]:
        import numpy as np

        from ..imu.models.sensed_motion import SensedMotion  # computes arrays

        felt = SensedMotion(self._imu, self._motion)

        def at(seconds: Fraction) -> Mapping[str, Axes]:
            values = felt.lsb(np.array([float(self._first + seconds)]))
            return {chip: tuple(axes[0].tolist()) for chip, axes in values.items()}

        return at


def distance(a: Fraction | float, b: Fraction | float) -> Fraction:
    """Return a - b, by the shorter way around a 16-bit word."""
    return (Fraction(a) - Fraction(b) + WORD // 2) % WORD - WORD // 2
