"""Format of a serial line: its baud rate and the shape of its frames. `line_of` parses both from text."""

from __future__ import annotations

import re
from fractions import Fraction

from msgspec import Struct

from ...core.phrases import did_you_mean, shorten

PARITIES = ("none", "odd", "even", "mark", "space")


class Line(Struct, frozen=True):
    """Baud rate of a line and shape of its frames.

    bits: the number of data bits.
    parity: an item of PARITIES.
    stop: the number of stop bits.
    invert: True if the wire is low while the line is idle.
    """

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
        """The shape of a frame as data bits, first letter of the parity, and stop bits: 8n1."""
        return f"{self.bits}{self.parity[0]}{float(self.stop):g}"

    @property
    def frame(self) -> Fraction:
        """The length of a frame in bits, from the start edge to the end of the last stop bit."""
        return 1 + self.bits + (self.parity != "none") + Fraction(self.stop)


def line_of(baud: str, shape: str = "8n1", invert: bool = False) -> Line:
    """Parse the format of a line.

    baud: a rate such as `115200` or `31250.5`.
    shape: data bits, first letter of the parity, and stop bits: `8n1`, `7e1.5`.

    Raise ValueError if the rate or the shape is invalid.
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
