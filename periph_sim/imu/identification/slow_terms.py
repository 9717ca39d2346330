"""Bias instability B and random walk K with their errors, from Allan variances.

    variance(tau) = N**2 / tau + (2 ln 2 / pi) B**2 + K**2 tau / 3        slopes -1/2, 0 and +1/2 of the deviation

IEEE Std 952 annex C. Fitted together by weighted least squares, none below 0, since the parts of slope 0 and +1/2
seldom occur alone. Points share samples: their correlation is assumed to be that of white noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.optimize import nnls

from .allan import Allan
from .confidence import edf, white_covariance
from .density import READ_AT, Density
from .series import Floats

ROUNDS = 4  # weights come from the fit itself; they converge after a few rounds
LEAST_EDF = 2.0
FLOOR = 2 * log(2) / pi  # of the variance, in B squared: a deviation of 0.664 B


@dataclass(frozen=True)
class Term:
    """A squared coefficient with its standard error, and its root, in the coefficient's unit."""

    squared: float
    squared_error: float

    @property
    def value(self) -> float:
        return sqrt(self.squared)

    @property
    def found(self) -> bool:
        """True if it differs significantly from 0."""
        return self.squared > 2 * self.squared_error

    def bounds(self, errors: float) -> tuple[float, float]:
        """Return the coefficient at `errors` standard errors below and above."""
        aside = errors * self.squared_error
        return sqrt(max(self.squared - aside, 0.0)), sqrt(self.squared + aside)


@dataclass(frozen=True)
class SlowTerms:
    """white: N in unit * sqrt(s). bias_instability: B in unit. random_walk: K in unit / sqrt(s)."""

    white: Term
    bias_instability: Term
    random_walk: Term


def white_part(found: Allan, terms: SlowTerms) -> Density:
    """Return the fitted density; its region is where white noise is most of the variance."""
    most = int(np.count_nonzero(terms.white.squared / found.taus > found.variance / 2))
    about = int(np.abs(np.log(found.taus / READ_AT)).argmin())
    freedom = 2 * (terms.white.squared / terms.white.squared_error) ** 2
    read = float(found.variance[about] * found.taus[about])
    return Density(terms.white.squared, terms.white.squared_error, freedom, slice(0, most), read)


def slow_terms(found: Allan) -> SlowTerms:
    """Fit N, B and K to a curve of octaves."""
    used = edf(found) >= LEAST_EDF
    taus, variance, freedom = found.taus[used], found.variance[used], edf(found)[used]
    parts = np.stack([1 / taus, np.full_like(taus, FLOOR), taus / 3], axis=1)
    relative = white_covariance(found.counts[used], found.length)
    correlation = relative / np.sqrt(np.outer(np.diag(relative), np.diag(relative)))
    fitted: Floats = variance
    for _ in range(ROUNDS):
        spread = fitted * np.sqrt(2 / freedom)
        squares, _ = nnls(parts / spread[:, np.newaxis], variance / spread)
        fitted = parts @ squares
    scaled = parts / spread[:, np.newaxis]
    inverse = np.linalg.pinv(scaled)
    errors = np.sqrt(np.diag(inverse @ correlation @ inverse.T))
    white, instability, walk = (Term(*pair) for pair in zip(squares.tolist(), errors.tolist(), strict=True))
    return SlowTerms(white, instability, walk)
