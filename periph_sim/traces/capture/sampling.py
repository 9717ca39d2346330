"""How well a capture knows its times: a Capture goes in, the step from one sample to the next comes out.

A file of time stamps (VCD, Saleae CSV and binary) does not say how it was sampled. Its times are taken to be as good
as the coarsest grid on which all its edges lie. A grid finer than any analyser's is a simulation's, whose times are
exact, as are those of our own runs.
"""

from __future__ import annotations

from dataclasses import replace
from math import gcd

import numpy as np

from .capture import Capture, Channel
from .resample import rate_text, resampled

FASTEST_ANALYSER = 10**10  # samples a second; nothing samples logic faster


def grid_of(channels: tuple[Channel, ...]) -> int:
    """The greatest common divisor of the positions between any two edges; 1 with fewer than two edges."""
    busy = [channel.edges for channel in channels if len(channel.edges)]
    steps = [int(np.gcd.reduce(edges - busy[0][0])) for edges in busy]
    return max(1, gcd(*steps))


def is_exact(capture: Capture) -> bool:
    """True if the positions are a simulation's own instants, or too fine for any analyser."""
    if capture.sampled or capture.rate is None:
        return False
    return capture.exact or capture.rate / grid_of(capture.channels) > FASTEST_ANALYSER


def sample_step(capture: Capture) -> int:
    """Positions from one sample to the next: within so many nobody knows where an edge truly was.

    1 where positions are samples, and where they are exact; else the grid of the edges.
    """
    return 1 if capture.sampled or is_exact(capture) else grid_of(capture.channels)


def stamp_notes(capture: Capture) -> list[str]:
    """One note on how good the time stamps of a capture are taken to be; none of samples and exact times."""
    if capture.sampled or capture.rate is None or is_exact(capture):
        return []
    apart = float(grid_of(capture.channels) * 10**9 / capture.rate)
    return [
        f"the file gives times, not samples; all its edges lie {apart:g} ns or multiples of it apart, and so good its "
        "times are taken to be"
    ]


def on_samples(capture: Capture) -> Capture:
    """The capture in samples of the slowest rate that loses no edge, with a note that says so.

    A capture of samples, or without a rate, as it is.
    """
    if capture.sampled or capture.rate is None:
        return capture
    rate = capture.rate / grid_of(capture.channels)
    if rate == capture.rate:
        return replace(capture, sampled=True, exact=False)
    said = f"times are written as samples of {rate_text(rate)}, the slowest rate that has one at every edge"
    return resampled(capture, rate).noted(said)
