"""How frames are made: the settings of a serial line, and where its bits are looked at."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from ..core.nearest import near
from ..formats.capture import Capture

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
            raise ValueError(f"parity {self.parity!r}; {near(self.parity, PARITIES)}")
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
        raise ValueError(f"{shape!r} is no frame; expected data bits, one of n, o, e, m, s, and stop bits: 8n1, 7e1.5")
    if not re.fullmatch(r"\d+(\.\d+)?", baud.strip()):
        raise ValueError(f"{baud!r} is no baud rate; expected a number, or auto")
    rate = Fraction(baud.strip())
    return Line(rate.numerator if rate.denominator == 1 else rate, int(match[1]), parity[0], Fraction(match[3]), invert)


def width_of(capture: Capture, baud: Fraction | int) -> Fraction:
    """Samples of one bit. ValueError if the capture has no rate, or under two samples a bit."""
    if capture.rate is None:
        raise ValueError(f"{capture.path}: frames need a time base and the file states no rate; state the rate")
    width = capture.rate / Fraction(baud)
    if width < 2:
        raise ValueError(
            f"{capture.path}: {float(width):.2f} samples a bit at {baud} baud; expected at least 2, "
            f"so the rate of {capture.rate} Hz or the baud rate is wrong"
        )
    return width


def look(bit: int, width: Fraction) -> int:
    """Samples from the first low one to the look at a bit, the start bit being bit 0."""
    return ceil((bit + Fraction(1, 2)) * width - Fraction(1, 2))
