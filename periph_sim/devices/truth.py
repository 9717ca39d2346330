"""What is true while a run goes on: an instant goes in; what each chip should show then, x, y, z in its LSB, comes out.

    frames of the host --LineBetweenFrames--> Truth --> budgets on "value error"
    motion, sensors ---------MotionTruth-------> Truth

A truth is asked with seconds from the instant at which the host's first frame is due. Where the chips show the values
of frames it is the line between them; where sensor models stand between, it is what ideal sensors with the same
parameters would show of the true motion at that instant. It has no noise: a sensor's noise is not true of the body, and
which sample of it a read carries depends on the firmware's timing, of which truth is independent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import floor
from typing import Protocol, TypeVar

from ..sensors.models.parameters import ImuParameters
from ..sensors.motion import Motion

Axes = Sequence[Fraction | float]
T = TypeVar("T")

WORD = 1 << 16  # values are 16-bit words: past 32767 comes -32768


class Truth(Protocol):
    """What is true, whatever the firmware makes of it."""

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        """By chip, its values x, y, z in LSB at this time after the first frame was due; negative before."""


def shown(values: Sequence[T]) -> dict[str, Sequence[T]]:
    """What the chips show of a frame's six values, as long as no sensor model stands between."""
    return {"gyroscope": values[0:3], "accelerometer": values[3:6], "magnetometer": values[0:3]}


class LineBetweenFrames:
    """The straight line from each frame's values to the next one's; before the first frame, that one's values.

    frame: number -> six values. period: seconds from one frame to the next. A value that passes the end of 16 bits
    goes on at the other one.
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

    KEPT = 64  # instants: each is asked for several chips, and by several budgets

    def __init__(self, imu: ImuParameters, motion: Motion, first: Fraction) -> None:
        self._imu = imu
        self._motion = motion
        self._first = first
        self._at: Callable[[Fraction], Mapping[str, Axes]] | None = None  # made when somebody asks, which few runs do

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        if self._at is None:
            self._at = lru_cache(self.KEPT)(self._felt())
        return self._at(seconds)

    def _felt(self) -> Callable[[Fraction], Mapping[str, Axes]]:
        import numpy as np

        from ..sensors.models.sensed_motion import SensedMotion  # computes arrays

        felt = SensedMotion(self._imu, self._motion)

        def at(seconds: Fraction) -> Mapping[str, Axes]:
            values = felt.lsb(np.array([float(self._first + seconds)]))
            return {chip: tuple(axes[0].tolist()) for chip, axes in values.items()}

        return at


def distance(a: Fraction | float, b: Fraction | float) -> Fraction:
    """a - b, the shorter way round a 16-bit word."""
    return (Fraction(a) - Fraction(b) + WORD // 2) % WORD - WORD // 2
