"""The delay of one estimate relative to another: the lag between two series of attitudes with the best fit.

The emulator's answers are older than a chip's samples: the frame waits for the models, their values wait for the
next round. While the body turns this causes an angle error that is not the models'; so it is reported separately.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..attitude import Errors, errors
from ..rotations import Floats

STEP, MOST = 0.001, 0.1  # seconds: resolution and range of the search


@dataclass(frozen=True)
class Lag:
    """seconds: the delay; apart: remaining difference when the other one is shifted by it."""

    seconds: float
    apart: Errors


def lag_between(times: Floats, late: Floats, other: Floats) -> Lag:
    """Find the delay of `late` relative to `other`; both float64[n, 4], at ascending times float64[n].

    The one from 0 to 0.1 s with the least mean square of the whole angle. All are compared over the same instants,
    from 0.1 s after the first on. Without such instants: no delay, and no difference.
    """
    begins = int(np.searchsorted(times, times[0] + MOST)) if len(times) else 0
    least, found = np.inf, Lag(0.0, errors(late[begins:], other[begins:]))
    if begins == len(times):
        return found
    signed = _continuous(other)
    for number in range(round(MOST / STEP) + 1):
        earlier = _at(times[begins:] - number * STEP, times, signed)
        apart = errors(late[begins:], earlier)
        squares = float(np.sum(apart.total**2))
        if squares < least:
            least, found = squares, Lag(number * STEP, apart)
    return found


def _at(instants: Floats, times: Floats, attitudes: Floats) -> Floats:
    """Interpolate quaternions linearly and normalise them; accurate enough for steps of a few degrees."""
    between = np.stack([np.interp(instants, times, column) for column in attitudes.T], axis=1)
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True), np.float64)


def _continuous(attitudes: Floats) -> Floats:
    """Choose of q and -q the one nearer to the previous attitude."""
    turns = np.sign(np.sum(attitudes[1:] * attitudes[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns == 0, 1.0, turns))])
    return np.asarray(attitudes * signs[:, np.newaxis], np.float64)
