"""How late one estimate is behind another: two series of attitudes go in; the lateness that fits best comes out.

What the emulator answers is older than what a chip samples: the frame waits for the models, their values wait for the
next round. While the body turns that makes an error in angle, which says nothing about the models; so it is told apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...devices.attitude import Errors, errors
from ...sensors.rotations import Floats

STEP, MOST = 0.001, 0.1  # seconds: how finely, and how far, it is looked for


@dataclass(frozen=True)
class Lag:
    """seconds: how late; apart: what is left of the difference when the other one is taken so much earlier."""

    seconds: float
    apart: Errors


def lag_between(times: Floats, late: Floats, other: Floats) -> Lag:
    """Of `late`, the lateness behind `other`; both float64[n, 4], at times float64[n], rising.

    The one from 0 to 0.1 s with the least mean square of the whole angle. All are compared over the same instants:
    those from 0.1 s after the first on. With less than that there are none: no lateness, and no difference.
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
    """Attitudes between those given: on the chord, which for steps of some degrees is as good as on the arc."""
    between = np.stack([np.interp(instants, times, column) for column in attitudes.T], axis=1)
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True), np.float64)


def _continuous(attitudes: Floats) -> Floats:
    """The same attitudes, of q and -q always the one that is nearer to the one before."""
    turns = np.sign(np.sum(attitudes[1:] * attitudes[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns == 0, 1.0, turns))])
    return np.asarray(attitudes * signs[:, np.newaxis], np.float64)
