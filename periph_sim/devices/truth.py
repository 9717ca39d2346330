"""The true values during a run: x, y, z that each chip should show at an instant, in its LSB.

    frames of the host --LineBetweenFrames--> Truth --> budgets on "value error"
    model of the firmware, motion -------------> Truth

Times are seconds from the instant at which the host's first frame is due. If the chips show the values of frames, the
truth is the line between them; else the model of the firmware says it (`scene.unit.FirmwareModel`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import floor
from typing import Protocol

Axes = Sequence[Fraction | float]
Shown = Callable[[Sequence[Fraction]], Mapping[str, Axes]]

WORD = 1 << 16  # values are 16-bit words: 32767 is followed by -32768


class Truth(Protocol):
    """The true values, independent of the firmware."""

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        """Return by chip x, y, z in LSB at this time after the first frame was due; negative before."""


class LineBetweenFrames:
    """The straight line from each frame's values to the next one's; before the first frame, that one's values.

    frame: number -> values. period: seconds from one frame to the next. shown: by chip, what it shows of these values.
    A value beyond one end of 16 bits continues at the other one.
    """

    def __init__(self, frame: Callable[[int], tuple[int, ...]], period: Fraction, shown: Shown) -> None:
        self._frame = frame
        self._period = period
        self._shown = shown

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        place = max(seconds, Fraction(0)) / self._period
        number = floor(place)
        now, later = self._frame(number), self._frame(number + 1)
        part = place - number
        return self._shown([a + part * distance(b, a) for a, b in zip(now, later, strict=True)])


def distance(a: Fraction | float, b: Fraction | float) -> Fraction:
    """Return a - b, by the shorter way around a 16-bit word."""
    return (Fraction(a) - Fraction(b) + WORD // 2) % WORD - WORD // 2
