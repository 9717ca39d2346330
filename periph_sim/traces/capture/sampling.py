"""Sampling of a capture: the step from one sample to the next, and resampling at another rate.

A file of time stamps (VCD, Saleae CSV and binary) does not say how it was sampled. Its sample period is assumed to be
that of the coarsest grid on which all its edges lie. If that grid is finer than any analyser's, the file comes from a
simulation, whose times are exact, as are those of our own runs.

Resampling moves an edge to the first sample at or after it, where an analyser of that rate would have recorded it. A
pulse between two samples is lost; a note states the number of lost pulses.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import gcd

import numpy as np

from .capture import BadCapture, Capture, Channel, Positions, Span

MOST_POSITION = 1 << 62
FASTEST_ANALYSER = 10**10  # samples per second; no logic analyser is faster
LONGEST_PAUSE = 1 << 26  # samples without an edge when time stamps become samples: 0.7 s at 100 MHz


def resampled(capture: Capture, rate: Fraction) -> Capture:
    """Return the capture at `rate` samples per second, with a note on lost pulses.

    Raise BadCapture if the capture has no rate.
    """
    if capture.rate is None:
        raise BadCapture(
            capture.path, "its rate", "none stated", "positions with a time", "state the rate at which it was captured"
        )
    ratio = rate / capture.rate
    last = max((int(channel.edges[-1]) for channel in capture.channels if len(channel.edges)), default=0)
    length = max(_ceil(capture.length * ratio), _ceil(last * ratio) + 1)  # no edge is after the last sample
    if length > MOST_POSITION:
        raise BadCapture(capture.path, "its length", f"{length} samples", f"at most {MOST_POSITION}", "use less --rate")
    moved = [_moved(channel, ratio, length) for channel in capture.channels]
    notes = [
        f"channel {channel.name}: pulses that fall between two samples of {rate_text(rate)} are lost: {lost}"
        for channel, lost in moved
        if lost
    ]
    channels = tuple(channel for channel, _ in moved)
    return replace(capture, rate=rate, length=length, channels=channels, sampled=True, exact=False).noted(*notes)


def rate_text(rate: Fraction) -> str:
    """Format a rate exactly, in the largest unit that gives a whole number: `4 MHz`, `115200 Hz`, `1000000/3 Hz`."""
    for unit, size in (("GHz", 10**9), ("MHz", 10**6), ("kHz", 10**3)):
        if rate % size == 0:
            return f"{rate // size} {unit}"
    return f"{rate} Hz"


def _moved(channel: Channel, ratio: Fraction, length: int) -> tuple[Channel, int]:
    """Return the channel at the new rate and the number of lost pulses."""
    at, changes = np.unique(_up(channel.edges, ratio), return_counts=True)
    lost = int((changes // 2).sum())
    spans = ((_ceil(hole.begin * ratio), min(_ceil(hole.end * ratio), length)) for hole in channel.unknown)
    unknown = tuple(Span(begin, end) for begin, end in spans if begin < end)
    edges = at[changes & 1 == 1]
    return Channel(channel.name, channel.index, channel.initial, edges, unknown), lost


def _up(positions: Positions, ratio: Fraction) -> Positions:
    """Return the first sample at or after each position, exactly."""
    top, bottom = ratio.numerator, ratio.denominator
    if len(positions) and int(positions[-1]) * top + bottom >= 1 << 63:
        positions = positions.astype(object)
    return (-(-positions * top // bottom)).astype(np.int64)


def _ceil(value: Fraction) -> int:
    return -(-value.numerator // value.denominator)


def grid_of(channels: tuple[Channel, ...]) -> int:
    """Return the greatest common divisor of the positions between any two edges; 1 with fewer than two edges."""
    busy = [channel.edges for channel in channels if len(channel.edges)]
    steps = [int(np.gcd.reduce(edges - busy[0][0])) for edges in busy]
    return max(1, gcd(*steps))


def is_exact(capture: Capture) -> bool:
    """Return True if the positions are instants of a simulation, or finer than those of any analyser."""
    if capture.sampled or capture.rate is None:
        return False
    return capture.exact or capture.rate / grid_of(capture.channels) > FASTEST_ANALYSER


def sample_step(capture: Capture) -> int:
    """Return the positions from one sample to the next, which is the uncertainty of an edge's true instant.

    It is 1 if positions are samples or exact instants; otherwise it is the step of the edges' grid.
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

    A capture of samples, or without a rate, is returned unchanged. Raise BadCapture if most of the samples would lie in
    one long pause, which is the effect of a single damaged time stamp.
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
    """Raise BadCapture if one pause has more samples than LONGEST_PAUSE and than the rest of the capture together.

    A capture with exact times may have such a pause.
    """
    assert capture.rate is not None
    edges = np.sort(np.concatenate([channel.edges for channel in capture.channels] or [np.empty(0, np.int64)]))
    ends = [0, *edges.tolist(), capture.length]
    lengths = np.diff(ends)
    before = int(lengths.argmax())  # number of edges before the longest pause
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
