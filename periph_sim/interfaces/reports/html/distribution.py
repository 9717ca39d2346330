"""The distribution of measured values: bins with counts, limits and quantiles.

Bins have equal width and begin at whole multiples of it, so the bins of two runs coincide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....timing.measures.measure import MILLIONTHS
from ....timing.values import Values
from ....traces.drawing.svg_diagram import nice_step

MOST = 60  # maximum number of bins
SHOWN = (("median", 500), ("p95", 950), ("p99", 990))
UNITS = (("ns", 1), ("us", 10**3), ("ms", 10**6), ("s", 10**9))


@dataclass(frozen=True)
class Bin:
    """Values from begin up to but excluding end."""

    begin: float
    end: float
    count: int


@dataclass(frozen=True)
class Distribution:
    """The distribution of the values of a budget. All numbers are in `unit`, which depends on their size.

    counted: True if the values are whole counts, so that a bin of width 1 contains one distinct value.
    limits: key and value of each limit.
    quantiles: name and value (nearest rank) of each quantile.
    """

    unit: str
    counted: bool
    bins: tuple[Bin, ...]
    least: float
    worst: float
    limits: tuple[tuple[str, float], ...]
    quantiles: tuple[tuple[str, float], ...]

    @property
    def count(self) -> int:
        return sum(one.count for one in self.bins)


def distribution(values: Values, per_ns: int) -> Distribution:
    """Return the distribution. per_ns: ticks per nanosecond, for times."""
    data = np.sort(values.values)
    least, worst = int(data[0]), int(data[-1])
    unit, size, grain = scale_of(values.unit, max(abs(least), abs(worst)), per_ns)
    width = _width(worst - least, grain)
    first = least // width
    places, counts = np.unique(data // width - first, return_counts=True)
    return Distribution(
        unit="" if unit == "value" else unit,
        counted=size == 1,
        bins=tuple(
            Bin((first + place) * width / size, (first + place + 1) * width / size, count)
            for place, count in zip(places.tolist(), counts.tolist(), strict=True)
        ),
        least=least / size,
        worst=worst / size,
        limits=tuple((key, limit / size) for key, limit in values.limits.items()),
        quantiles=tuple((name, int(data[-(-per * len(data) // 1000) - 1]) / size) for name, per in SHOWN),
    )


def _width(spread: int, grain: int) -> int:
    """Return 1, 2 or 5 times a power of ten of grains, so at most MOST bins are needed."""
    return grain * max(1, round(nice_step(spread / grain, MOST - 1))) if spread > grain else grain


def scale_of(unit: str, largest: int, per_ns: int) -> tuple[str, int, int]:
    """Return the unit to show, its size in units of the values, and the minimum bin width."""
    if unit == "time":
        return *_unit(largest, per_ns), per_ns
    if unit == "LSB":
        return unit, MILLIONTHS, MILLIONTHS // 1000
    return unit, 1, 1


def _unit(largest: int, per_ns: int) -> tuple[str, int]:
    """Return the unit in which `largest` ticks are below 1000, and its ticks."""
    return next(((unit, ns * per_ns) for unit, ns in UNITS if largest < 1000 * ns * per_ns), ("s", 10**9 * per_ns))
