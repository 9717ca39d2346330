"""Extremes of the Allan variance: large offsets and steep ramps, against the same variance in whole numbers."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import accumulate
from random import Random

import numpy as np

from ..identification.allan import allan
from .finding import EVERY, Finding

LENGTH = 3001  # samples, so that their mean is no whole number
NOISE = 9  # LSB: samples are whole numbers, and `exact_variance` does not round
OFFSETS = (10**9, 10**15)
RAMPS = (10**3, 10**9)  # LSB a sample
ALLOWED = 1e-9  # relative error of the variance


def allan_variances() -> Iterator[Finding]:
    """Compare the variance of noise with an offset, and with a ramp, with its exact value at every averaging time."""
    random = Random(1)
    noise = [random.randint(-NOISE, NOISE) for _ in range(LENGTH)]
    for offset in OFFSETS:
        yield _finding(f"Allan variance, offset of {offset:.0e}", [offset + one for one in noise])
    for slope in RAMPS:
        yield _finding(f"Allan variance, ramp of {slope:.0e}", [slope * n + one for n, one in enumerate(noise)])


def _finding(extreme: str, samples: list[int]) -> Finding:
    found = allan(np.array(samples, np.float64), 1.0)
    meant = [exact_variance(samples, m) for m in found.counts.tolist()]
    off = max(abs(Fraction(one) / of - 1) for one, of in zip(found.variance.tolist(), meant, strict=True))
    agrees = off <= ALLOWED
    note = f"{'' if agrees else 'not '}within {ALLOWED:.0e} of the exact variance at {len(meant)} averaging times"
    return Finding(extreme, EVERY, "agrees" if agrees else "off", None, "", note=note)


def exact_variance(samples: list[int], m: int) -> Fraction:
    """Return the mean square of the change between neighbouring averages over m samples, at every place, halved."""
    sums = [0, *accumulate(samples)]
    changes = (sums[i + 2 * m] - 2 * sums[i + m] + sums[i] for i in range(len(samples) - 2 * m + 1))
    return Fraction(sum(change**2 for change in changes), 2 * (len(samples) - 2 * m + 1) * m**2)
