"""The true values during a run: the x, y and z that each chip's registers should contain at an instant, in LSB.

    frames of the host --LineBetweenFrames----> Truth --> the measure "value error"
    motion --------------FirmwareModel.truth--> Truth

The chips are emulated by the firmware of a unit, which receives frames from the host. There are two kinds of firmware:

- It copies the values of frames to the registers. The truth is then a straight line from each frame's values to the
  next.
- It computes the registers from the motion that the frames describe. The truth is then what ideal chips would measure
  during this motion (`scene.unit.FirmwareModel.truth`).

Times are seconds from the instant at which the host's first frame is due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import floor
from typing import Protocol

Axes = Sequence[Fraction | float]
Distribute = Callable[[Sequence[Fraction]], Mapping[str, Axes]]

WORD = 1 << 16  # number of values of a 16-bit word, in which -32768 follows 32767


class Truth(Protocol):
    """The true values. They do not depend on what the firmware does during the run."""

    def at(self, seconds: Fraction) -> Mapping[str, Axes]:
        """Return x, y and z of each chip in LSB, by the name of the chip.

        seconds: the time since the first frame was due; negative before this frame.
        """


class LineBetweenFrames:
    """Linear interpolation between the values of successive frames; before frame 0 is due, the values of frame 0.

    Values are 16-bit and wrap around: from 32767 to -32768 is a step of 1. The interpolation takes the shorter way.

    frame: a function from the number of a frame to its values.
    period: seconds from one frame to the next.
    shown: a function that distributes the values of a frame to the chips, as `HostFrames.shown` does.
    """

    def __init__(self, frame: Callable[[int], tuple[int, ...]], period: Fraction, shown: Distribute) -> None:
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
