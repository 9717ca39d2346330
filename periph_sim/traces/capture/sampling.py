"""Resolution of a capture's times: the step from one sample to the next.

A file of time stamps (VCD, Saleae CSV and binary) does not say how it was sampled. Its times are assumed to be as
good as the coarsest grid on which all its edges are. A grid finer than any analyser's is that of a simulation, whose
times are exact, as are those of our own runs.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import gcd

import numpy as np

from .capture import BadCapture, Capture, Channel
from .resample import rate_text, resampled

FASTEST_ANALYSER = 10**10  # samples a second; nothing samples logic faster
LONGEST_PAUSE = 1 << 26  # samples without an edge when time stamps become samples: 0.7 s at 100 MHz


def grid_of(channels: tuple[Channel, ...]) -> int:
    """Return the greatest common divisor of the positions between any two edges; 1 with fewer than two edges."""
    busy = [channel.edges for channel in channels if len(channel.edges)]
    steps = [int(np.gcd.reduce(edges - busy[0][0])) for edges in busy]
    return max(1, gcd(*steps))


def is_exact(capture: Capture) -> bool:
    """True if the positions are the instants of a simulation, or too fine for any analyser."""
    if capture.sampled or capture.rate is None:
        return False
    return capture.exact or capture.rate / grid_of(capture.channels) > FASTEST_ANALYSER


def sample_step(capture: Capture) -> int:
    """Return the positions from one sample to the next, which is the uncertainty of an edge's true instant.

    1 where positions are samples, and where they are exact; else the grid of the edges.
    """
    return 1 if capture.sampled or is_exact(capture) else grid_of(capture.channels)


def stamp_notes(capture: Capture) -> list[str]:
    """Return a note on the assumed resolution of a capture's time stamps; none for samples and exact times."""
    if capture.sampled or capture.rate is None or is_exact(capture):
        return []
    apart = float(grid_of(capture.channels) * 10**9 / capture.rate)
    return [
        f"the file gives times, not samples; all its edges are multiples of {apart:g} ns apart, which is "
        "taken as their resolution"
    ]


def on_samples(capture: Capture) -> Capture:
    """Return the capture in samples of the slowest rate that loses no edge, with a note that says so.

    A capture of samples, or without a rate, is returned as it is. BadCapture if most samples would be one long pause,
    as after a single damaged time stamp.
    """
    if capture.sampled or capture.rate is None:
        return capture
    rate = capture.rate / grid_of(capture.channels)
    _refuse_pause(capture, rate)
    if rate == capture.rate:
        return replace(capture, sampled=True, exact=False)
    said = f"times are written as samples of {rate_text(rate)}, the slowest rate that has one at every edge"
    return resampled(capture, rate).noted(said)


def _refuse_pause(capture: Capture, rate: Fraction) -> None:
    """Raise BadCapture if one pause has more samples than LONGEST_PAUSE and than all the rest. Exact times may."""
    assert capture.rate is not None
    edges = np.sort(np.concatenate([channel.edges for channel in capture.channels] or [np.empty(0, np.int64)]))
    ends = [0, *edges.tolist(), capture.length]
    lengths = np.diff(ends)
    before = int(lengths.argmax())  # edges before the pause
    begin, end, length = ends[before], ends[before + 1], int(lengths[before])
    samples = int(length * rate / capture.rate)
    if capture.exact or samples <= LONGEST_PAUSE or 2 * length <= capture.length:
        return
    kept = f"0..{begin + 1}" if 2 * before > len(edges) else f"{end - 1}..{capture.length}"
    raise BadCapture(
        capture.path,
        f"from {float(begin / capture.rate):.9g} s to {float(end / capture.rate):.9g} s",
        f"{samples} samples of {rate_text(rate)} without an edge, more than in all the rest",
        f"at most {LONGEST_PAUSE} as times become samples",
        f"cut a damaged time stamp off with --window {kept}, or state the rate of the samples with --sample",
    )
