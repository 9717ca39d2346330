"""The timing limits of the I2C-bus specification, in nanoseconds and as thresholds in positions of a capture.

    Capture --> Resolution --thresholds--> whole numbers of positions to compare with

If positions are samples, an edge is recorded at the first sample at or after the true edge. So a time that is measured
as n samples is in truth longer than n - 1 and shorter than n + 1 sample periods. Exact positions (ticks of a
simulation) have no error. Times are compared as whole numbers of positions.

Source: UM10204 (I2C-bus specification and user manual), Table 10, characteristics of the SDA and SCL bus lines, with
its footnotes. The maxima of tVD in Fast-mode Plus are from general knowledge. Limits are whole nanoseconds. The maximum
of the frequency fSCL is stated as the minimum of its period.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from math import ceil, floor
from typing import NamedTuple

from ..capture.capture import Capture
from ..capture.sampling import grid_of, is_exact


class Mode(Enum):
    STANDARD = "standard"  # clock rates up to 100 kHz
    FAST = "fast"  # clock rates up to 400 kHz
    FAST_PLUS = "fast-plus"  # clock rates up to 1 MHz


class Bounds(NamedTuple):
    """Minimum (`least`) and maximum (`most`) of a time in nanoseconds; None for a bound that does not exist."""

    least: int | None = None
    most: int | None = None


class Limit(NamedTuple):
    """A limit of the specification.

    symbol: the symbol of the limited time in Table 10.
    begins, ends: the events between which the time is measured.
    bounds: a dictionary from each mode to its minimum and maximum.
    seen: False for rise and fall times, which a capture with one voltage threshold per line cannot show.
    rule: a remark on how the limit is interpreted; empty if there is no remark.
    """

    symbol: str
    begins: str
    ends: str
    bounds: dict[Mode, Bounds]
    seen: bool = True
    rule: str = ""


def _bounds(standard: Bounds, fast: Bounds, fast_plus: Bounds) -> dict[Mode, Bounds]:
    return {Mode.STANDARD: standard, Mode.FAST: fast, Mode.FAST_PLUS: fast_plus}


def _least(standard: int, fast: int, fast_plus: int) -> dict[Mode, Bounds]:
    return _bounds(Bounds(standard), Bounds(fast), Bounds(fast_plus))


STRETCHED = (
    "it binds only a device that does not stretch tLOW, so it is judged only at bits whose low phase is at most the "
    "least tLOW, or at most 1.1 times the shortest one of the trace; at longer ones, only tSU;DAT is judged"
)
SETUP = "a Fast-mode device on a Standard-mode bus must keep the 250 ns of Standard-mode: judge such a bus as standard"
HOLD = (
    "the lines do not show the 300 ns for which a device holds SDA inside itself to bridge the falling edge of SCL; "
    "the maximum is judged as that of tVD;DAT"
)
SPIKE = (
    "an input must ignore a spike of up to 50 ns, so such spikes are removed before anything else is measured; a pulse "
    "of SCL, or of SDA while SCL is high, of more than 50 and up to 100 ns is a spike that is too long; longer pulses, "
    "and pulses of SDA while SCL is low, are no spikes"
)
SLOPES = "a capture with one threshold for each line shows no rise and fall times"

LIMITS: tuple[Limit, ...] = (
    Limit("fSCL", "SCL fall", "next SCL fall", _least(10_000, 2_500, 1_000), rule="judged as the period"),
    Limit("tHD;STA", "SDA fall of START", "SCL fall", _least(4_000, 600, 260)),
    Limit("tLOW", "SCL fall", "SCL rise", _least(4_700, 1_300, 500)),
    Limit("tHIGH", "SCL rise", "SCL fall", _least(4_000, 600, 260)),
    Limit("tSU;STA", "SCL rise", "SDA fall of repeated START", _least(4_700, 600, 260)),
    Limit("tHD;DAT", "SCL fall", "first SDA change", _bounds(Bounds(0, 3_450), Bounds(0, 900), Bounds(0)), rule=HOLD),
    Limit("tSU;DAT", "last SDA change", "SCL rise", _least(250, 100, 50), rule=SETUP),
    Limit("tr", "30 %", "70 %", _bounds(Bounds(None, 1_000), Bounds(20, 300), Bounds(None, 120)), False, SLOPES),
    Limit("tf", "70 %", "30 %", _bounds(Bounds(None, 300), Bounds(None, 300), Bounds(None, 120)), False, SLOPES),
    Limit("tSU;STO", "SCL rise", "SDA rise of STOP", _least(4_000, 600, 260)),
    Limit("tBUF", "STOP", "START", _least(4_700, 1_300, 500)),
    Limit(
        "tVD;DAT",
        "SCL fall",
        "SDA valid",
        _bounds(Bounds(None, 3_450), Bounds(None, 900), Bounds(None, 450)),
        rule=STRETCHED,
    ),
    Limit(
        "tVD;ACK",
        "SCL fall",
        "SDA valid for ACK",
        _bounds(Bounds(None, 3_450), Bounds(None, 900), Bounds(None, 450)),
        rule=STRETCHED,
    ),
    Limit("tSP", "spike begins", "spike ends", _bounds(Bounds(), Bounds(None, 50), Bounds(None, 50)), rule=SPIKE),
)

LIMIT = {limit.symbol: limit for limit in LIMITS}
# A pulse of SCL, or of SDA while SCL is high, counts as a spike if it is not longer than SPIKES_TO times the maximum of
# tSP. A spike that is longer than the maximum breaks the limit tSP.
SPIKES_TO = 2


NS = 10**9


@dataclass(frozen=True)
class Resolution:
    """Resolution of the positions of a capture.

    rate: the number of positions per second.
    slack: the maximum error of a time in either direction, in positions; 0 if positions are exact.
    """

    rate: Fraction
    slack: int

    @property
    def period(self) -> Fraction:
        """The maximum error of a time, in nanoseconds."""
        return self.slack * NS / self.rate

    def ns(self, positions: int) -> Fraction:
        return positions * NS / self.rate

    def surely_at_least(self, ns: int) -> int:
        """Return the smallest measured number of positions whose true time is certainly `ns` or more."""
        return ceil(ns * self.rate / NS) + self.slack

    def surely_at_most(self, ns: int) -> int:
        """Return the largest measured number of positions whose true time is certainly `ns` or less."""
        return floor(ns * self.rate / NS) - self.slack

    def surely_below(self, ns: int) -> int:
        """Return the largest measured number of positions whose true time is certainly less than `ns`."""
        return self.surely_at_most(ns) if self.slack else ceil(ns * self.rate / NS) - 1

    def surely_above(self, ns: int) -> int:
        """Return the smallest measured number of positions whose true time is certainly more than `ns`."""
        return self.surely_at_least(ns) if self.slack else floor(ns * self.rate / NS) + 1


def resolution_of(capture: Capture, exact: bool | None = None) -> Resolution:
    """Return the resolution of the capture's positions.

    exact: how positions are interpreted if they are time stamps and not samples. True: as exact instants. False: as
        samples on the coarsest grid that contains all edges. None: as exact instants if `is_exact` is True for the
        capture, otherwise as samples.

    Raise ValueError if the capture has no rate.
    """
    rate = capture.rate_for("limits need")
    if capture.sampled:
        return Resolution(rate, 1)
    exact = is_exact(capture) if exact is None else exact
    return Resolution(rate, 0 if exact else grid_of(capture.channels))
