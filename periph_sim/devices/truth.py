"""The true values during a run: x, y, z that each chip should show at an instant, in its LSB.

    frames of the host --LineBetweenFrames--> Truth --> budgets on "value error"
    model of the firmware, motion -------------> Truth

Times are seconds from the instant at which the host's first frame is due. If the chips show the values of frames, the
truth is a straight line between frames. Otherwise the model of the firmware computes it (`scene.unit.FirmwareModel`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import floor
from typing import Protocol

Axes = Sequence[Fraction | float]
Shown = Callable[[Sequence[Fraction]], Mapping[str, Axes]]

WORD = 1 << 16  # number of values of a 16-bit word, in which -32768 follows 32767


class Truth(Protocol):
    """The true values, independent of the firmware."""

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        """Return a dictionary from chips to x, y and z in LSB.

        seconds: the time since the first frame was due; negative before this frame.
        """


class LineBetweenFrames:
    """The straight line from each frame's values to the next frame's; before the first frame, the values of that frame.

    frame: a function from the number of a frame to its values.
    period: seconds from one frame to the next.
    shown: a function from these values to a dictionary from each chip to the values that the chip shows.
    A line takes the shorter way from value to value, so it may pass from 32767 to -32768.
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
    """Return a - b modulo 2**16, as the value nearest to 0: from -32768 to below 32768."""
    return (Fraction(a) - Fraction(b) + WORD // 2) % WORD - WORD // 2
