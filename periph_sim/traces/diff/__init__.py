"""Comparison of two captures by the events on the bus.

    Capture A, Capture B --decode--> words --pair--> entries --> TraceDiff

Events are paired by what they are and in order, not by their times. Then the times of each pair are compared. If an
interrupt came 3 us later in B, all events after it are 3 us later, and the first of them is reported.
"""

from __future__ import annotations

from fractions import Fraction

from ..capture.capture import Capture
from ..decode.uart import Line
from .compare import ChangePoint, Entry, TraceDiff, compared
from .matching import Group, i2c_groups, pairs, uart_groups

__all__ = ["ChangePoint", "Entry", "TraceDiff", "diff_i2c", "diff_uart"]

I2cLines = tuple[str | int, str | int]


def diff_i2c(
    a: Capture,
    b: Capture,
    lines: I2cLines = ("SCL", "SDA"),
    lines_b: I2cLines | None = None,
    tolerance: Fraction | None = None,
) -> TraceDiff:
    """Return the differences of two I2C captures.

    lines: the names of SCL and SDA in A, and also in B unless `lines_b` is given.
    tolerance: the allowed difference of times in seconds; None: one position of each capture.

    Raise LookupError if a channel is missing, and ValueError if a capture has no rate.
    """
    return _diff(a, b, i2c_groups(a, *lines), i2c_groups(b, *(lines_b or lines)), tolerance)


def diff_uart(
    a: Capture,
    b: Capture,
    line: Line,
    channel: str | int = "RX",
    channel_b: str | int | None = None,
    tolerance: Fraction | None = None,
) -> TraceDiff:
    """Return the differences of two UART lines. Arguments and errors are as for `diff_i2c`."""
    other = channel if channel_b is None else channel_b
    return _diff(a, b, uart_groups(a, channel, line), uart_groups(b, other, line), tolerance)


def _diff(a: Capture, b: Capture, of_a: list[Group], of_b: list[Group], tolerance: Fraction | None) -> TraceDiff:
    rates = []
    for capture in (a, b):
        if capture.rate is None:
            raise ValueError(f"{capture.path}: differences in time need a rate and the file states none; state it")
        rates.append(capture.rate)
    both = rates[0], rates[1]
    return compared(pairs(of_a, of_b, both), (str(a.path), str(b.path)), both, tolerance)
