"""Sample points of the bits of a serial frame, by its format and the capture's resolution."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

from ..capture.capture import Capture
from ..capture.resample import rate_text
from .uart_line import Line

HALF, QUARTER, LATEST = Fraction(1, 2), Fraction(1, 4), Fraction(7, 8)


def width_of(capture: Capture, baud: Fraction | int) -> Fraction:
    """Return the samples of one bit. ValueError if the capture has no rate, or under two samples a bit."""
    if capture.rate is None:
        raise ValueError(f"{capture.path}: frames need a time base and the file states no rate; state the rate")
    width = capture.rate / Fraction(baud)
    if width < 2:
        raise ValueError(
            f"{capture.path}: {float(width):.2f} samples a bit at {float(baud):.7g} baud; expected at least 2, "
            f"so the rate of {rate_text(capture.rate)} or the baud rate is wrong"
        )
    return width


def sample_points_of(line: Line, width: Fraction, step: int = 1, vote: bool = False) -> list[tuple[int, ...]]:
    """Return the offsets of each bit's samples from the first low position, from the start bit to the first stop bit.

    One sample in the middle; vote: three, an eighth of a bit apart. width: positions of a bit. step: of a sample.
    """
    places = (Fraction(3, 8), HALF, Fraction(5, 8)) if vote else (HALF,)
    return [tuple(_sample((bit + place) * width, step) for place in places) for bit in range(_checked_bits(line))]


def windows_of(line: Line, width: Fraction) -> list[tuple[int, int]]:
    """Return the first and last position, from the first low one, at which a receiver may sample each bit.

    From a quarter to seven eighths of a bit: receivers of 8 or 16 samples a bit vote around the middle, and count bits
    from an edge that they see up to one of these samples late. They watch the start bit from its begin on.
    """
    bits = range(_checked_bits(line))
    return [(int((bit + QUARTER) * width) + 1 if bit else 0, int((bit + LATEST) * width)) for bit in bits]


def longest_glitch(width: Fraction) -> int:
    """Return the length of the longest glitch, in positions: less than half a bit."""
    return ceil(width / 2) - 1


def _checked_bits(line: Line) -> int:
    return 2 + line.bits + (line.parity != "none")


def _sample(after: Fraction, step: int) -> int:
    """Return the first sample not before a time, counted from half a sample before the first low one."""
    return step * ceil(after / step - HALF)


def sample_point_step(step: int, width: Fraction | float) -> int:
    """Return the step of sample points: that of the samples, or 1 where a bit would have under two samples.

    In the second case, the grid of the signal's own edges was mistaken for the sampling grid of an analyser.
    """
    return step if width >= 2 * step else 1
