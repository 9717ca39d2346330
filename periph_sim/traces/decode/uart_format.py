"""How frames are made: the settings of a serial line, and where its bits are looked at."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from ...core.shorten import shorten
from ...core.suggest import did_you_mean
from ..capture.capture import Capture
from ..capture.resample import rate_text

HALF, QUARTER, LATEST = Fraction(1, 2), Fraction(1, 4), Fraction(7, 8)
PARITIES = ("none", "odd", "even", "mark", "space")


@dataclass(frozen=True, slots=True)
class Line:
    """How frames are made. invert: True where idle is low on the wire."""

    baud: Fraction | int
    bits: int = 8
    parity: str = "none"
    stop: Fraction | int = 1
    invert: bool = False

    def __post_init__(self) -> None:
        if self.baud <= 0:
            raise ValueError(f"baud is {self.baud}; expected more than 0")
        if not 1 <= self.bits <= 16:
            raise ValueError(f"{self.bits} data bits; expected 1 to 16")
        if self.parity not in PARITIES:
            raise ValueError(f"parity {self.parity!r}; {did_you_mean(self.parity, PARITIES)}")
        if self.stop not in (1, Fraction(3, 2), 2):
            raise ValueError(f"{self.stop} stop bits; expected 1, 3/2 or 2")

    @property
    def shape(self) -> str:
        """Data bits, first letter of the parity, stop bits: 8n1."""
        return f"{self.bits}{self.parity[0]}{float(self.stop):g}"

    @property
    def frame(self) -> Fraction:
        """Bit times from the start edge to the end of the last stop bit."""
        return 1 + self.bits + (self.parity != "none") + Fraction(self.stop)


def line_of(baud: str, shape: str = "8n1", invert: bool = False) -> Line:
    """A line from text: `115200` or `31250.5` baud; data bits, first letter of the parity, stop bits: `8n1`, `7e1.5`.

    ValueError says what was expected.
    """
    match = re.fullmatch(r"(\d\d?)([a-z])(1|1\.5|2)", shape.strip().casefold())
    parity = [name for name in PARITIES if match and name[0] == match[2]]
    if not match or not parity:
        raise ValueError(
            f"{shorten(repr(shape))} is no frame; expected data bits, one of n, o, e, m, s, and stop bits: 8n1, 7e1.5"
        )
    if not re.fullmatch(r"\d{1,18}(\.\d{1,18})?", baud.strip()):
        raise ValueError(f"{shorten(repr(baud))} is no baud rate; expected a number, or auto")
    rate = Fraction(baud.strip())
    return Line(rate.numerator if rate.denominator == 1 else rate, int(match[1]), parity[0], Fraction(match[3]), invert)


def width_of(capture: Capture, baud: Fraction | int) -> Fraction:
    """Samples of one bit. ValueError if the capture has no rate, or under two samples a bit."""
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
    """Positions from the first low one to the looks at each bit, from the start bit to the first stop bit.

    One look in the middle; vote: three, an eighth of a bit apart. width: positions of a bit. step: of a sample.
    """
    places = (Fraction(3, 8), HALF, Fraction(5, 8)) if vote else (HALF,)
    return [tuple(_sample((bit + place) * width, step) for place in places) for bit in range(_checked_bits(line))]


def windows_of(line: Line, width: Fraction) -> list[tuple[int, int]]:
    """(first, last) position, from the first low one, at which a receiver may sample a bit, as for `sample_points_of`.

    From a quarter to seven eighths of a bit: receivers of 8 or 16 samples a bit vote around the middle, and take their
    bits from an edge that they see up to one of these samples late. The start bit they watch from its begin on.
    """
    bits = range(_checked_bits(line))
    return [(int((bit + QUARTER) * width) + 1 if bit else 0, int((bit + LATEST) * width)) for bit in bits]


def longest_glitch(width: Fraction) -> int:
    """Positions of the longest pulse that was no bit: it is shorter than half of one."""
    return ceil(width / 2) - 1


def _checked_bits(line: Line) -> int:
    return 2 + line.bits + (line.parity != "none")


def _sample(after: Fraction, step: int) -> int:
    """The first sample not before a time, counted from half a sample before the first low one."""
    return step * ceil(after / step - HALF)


def sample_point_step(step: int, width: Fraction | float) -> int:
    """The step of the looks at bits: that of the samples, or 1 where a bit would have under two samples.

    There the signal's own raster, which all its edges lie on, was taken for the samples of an analyser.
    """
    return step if width >= 2 * step else 1
