"""Sampling grids: the grid of a capture's positions, and conversions between positions, times and other grids.

    "0.000016460", ISO 8601 --> ticks (a power of ten per second) <--> samples of a known rate

A file of time stamps (VCD, Saleae CSV and binary) does not say how it was sampled. Its sample period is assumed to be
the step of the coarsest grid on which all its edges lie. If this grid is finer than the grid of any analyser, the file
is assumed to come from a simulation, and its times to be exact. The times of our own runs are always exact.

Resampling moves an edge to the first sample at or after the edge, where an analyser would have recorded it. A pulse
between two samples is lost; a note states the number of lost pulses. Positions are calculated without floats.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from fractions import Fraction
from math import ceil, gcd
from pathlib import Path

import numpy as np

from ...core.phrases import shorten
from .capture import MOST_DIGITS, MOST_POSITION, BadCapture, Capture, Channel, Positions, Span

FASTEST_ANALYSER = 10**10  # a rate in samples per second that no logic analyser exceeds
# A pause is a time without edges. A pause of at most this number of samples (0.7 s at 100 MHz) is always accepted.
LONGEST_PAUSE = 1 << 26


def resampled(capture: Capture, rate: Fraction) -> Capture:
    """Return the capture at `rate` samples per second, with a note on lost pulses.

    Raise BadCapture if the capture has no rate, or if it would have more than MOST_POSITION samples.
    """
    if capture.rate is None:
        raise BadCapture(
            capture.path, "its rate", "none stated", "positions with a time", "state the rate at which it was captured"
        )
    ratio = rate / capture.rate
    last = max((int(channel.edges[-1]) for channel in capture.channels if len(channel.edges)), default=0)
    length = max(ceil(capture.length * ratio), ceil(last * ratio) + 1)  # so long that no edge is after the last sample
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
    at, changes = np.unique(rescaled(channel.edges, ratio, up=True), return_counts=True)
    lost = int((changes // 2).sum())
    spans = ((ceil(hole.begin * ratio), min(ceil(hole.end * ratio), length)) for hole in channel.unknown)
    unknown = tuple(Span(begin, end) for begin, end in spans if begin < end)
    edges = at[changes & 1 == 1]
    return Channel(channel.name, channel.index, channel.initial, edges, unknown), lost


def grid_of(channels: tuple[Channel, ...]) -> int:
    """Return the greatest common divisor of the distances between edges, in positions; 1 if all are 0."""
    busy = [channel.edges for channel in channels if len(channel.edges)]
    steps = [int(np.gcd.reduce(edges - busy[0][0])) for edges in busy]
    return max(1, gcd(*steps))


def is_exact(capture: Capture) -> bool:
    """Return True if the capture is marked as exact, or if the grid of its edges is finer than any analyser's.

    Samples, and captures without a rate, are never exact.
    """
    if capture.sampled or capture.rate is None:
        return False
    return capture.exact or capture.rate / grid_of(capture.channels) > FASTEST_ANALYSER


def sample_step(capture: Capture) -> int:
    """Return the number of positions per sample, which is the uncertainty of the true instant of an edge.

    The number is 1 if positions are samples or exact instants; otherwise it is the step of the grid of all edges.
    """
    return 1 if capture.sampled or is_exact(capture) else grid_of(capture.channels)


def stamp_notes(capture: Capture) -> list[str]:
    """Return a list with a note on the assumed resolution of time stamps.

    Return an empty list for samples, for exact times, and if the capture has no rate.
    """
    if capture.sampled or capture.rate is None or is_exact(capture):
        return []
    apart = float(grid_of(capture.channels) * 10**9 / capture.rate)
    return [
        f"the file gives times, not samples; all its edges are multiples of {apart:g} ns apart, which is "
        "taken as their resolution"
    ]


def on_samples(capture: Capture) -> Capture:
    """Return the capture in samples of the slowest rate that loses no edge. A note states a changed rate.

    A capture of samples, or without a rate, is returned unchanged.

    Raise BadCapture if most of the samples would lie in one long pause, which a single damaged time stamp can cause.
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
    """Raise BadCapture if a pause has more samples than LONGEST_PAUSE and more than the rest of the capture.

    A capture that is marked as exact is always accepted.
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


# These patterns limit the number of digits. A text with more digits is not a time.
DECIMAL = re.compile(r"\s*([+-]?)(\d{1,40})(?:\.(\d{0,40}))?(?:[eE]([-+]?\d\d?))?\s*", re.ASCII)
ISO = re.compile(r"\s*(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d)(?:\.(\d{1,40}))?(Z|[+-]\d\d:?\d\d)?\s*")

FINEST = 15  # maximum number of decimals with which seconds are written: femtoseconds
LEAST_DECIMALS = 9  # number of decimals of a second in Saleae's CSV, unless more are needed: nanoseconds


class OffGrid(ValueError):
    """A time lies between two samples of the given rate.

    which: the index of the time in its sequence.
    off: the time minus the time of the nearest sample, in ticks.
    """

    def __init__(self, which: int, off: Fraction) -> None:
        super().__init__(f"time {which} is {float(off):.3g} ticks off the grid")
        self.which = which


def exact_time(text: str) -> tuple[int, int]:
    """Parse a time exactly. Return (digits, decimals); the time is digits / 10**decimals seconds.

    A time of ISO 8601 is counted from the beginning of 1970 in UTC. Raise ValueError if the text is neither a number of
    seconds nor a time of ISO 8601.
    """
    whole, _, part = text.partition(".")
    if part.isdecimal() and whole.isdecimal() and text.isascii() and len(text) <= MOST_DIGITS:
        return int(whole + part), len(part)  # the most frequent form of a time is parsed here, because this is quicker
    if match := DECIMAL.fullmatch(text):
        part = match[3] or ""
        decimals = len(part) - int(match[4] or 0)
        return int(match[1] + match[2] + part) * 10 ** max(-decimals, 0), max(decimals, 0)
    if match := ISO.fullmatch(text):
        zone = "+00:00" if match[3] in (None, "Z") else match[3]
        since = datetime.fromisoformat(match[1] + zone) - datetime(1970, 1, 1, tzinfo=UTC)
        part = match[2] or ""
        return (since.days * 86400 + since.seconds) * 10 ** len(part) + int(part or 0), len(part)
    raise ValueError(f"{shorten(repr(text.strip()))} is neither seconds nor an ISO 8601 time")


def decimals_for(capture: Capture, least: int, rounded_to: int, otherwise: str = "") -> tuple[int, bool]:
    """Return the number of decimals with which seconds are written, and True if all times are then exact.

    The number of decimals is as small as possible, but at least `least`. If FINEST decimals suffice, the times of all
    samples are exact. Otherwise, a sample period is at least `rounded_to` units of the last decimal, so that a reader
    that knows the rate gets the same samples.

    otherwise: a text that the error message states after the highest possible rate.

    Raise BadCapture if the capture has no rate, or a rate that is too high.
    """
    rate = capture.rate
    if rate is None:
        raise BadCapture(capture.path, "its rate", "none stated", "positions with a time", "state it with --rate")
    able = range(least, FINEST + 1)
    for decimals in able:
        if Fraction(10**decimals) % rate == 0:
            return decimals, True
    for decimals in able:
        if 10**decimals >= rounded_to * rate:
            return decimals, False
    raise BadCapture(
        capture.path,
        "its rate",
        rate_text(rate),
        f"up to {10**FINEST // rounded_to // 10**9} GHz{otherwise}",
        "write .psr",
    )


def rescaled(times: Positions, ratio: Fraction, up: bool = False) -> Positions:
    """Return each time multiplied by `ratio`, rounded to the nearest whole number or, if `up` is True, up.

    The calculation is exact. If the arithmetic does not fit 64 bits, the result is an array of objects, which are
    Python's integers.
    """
    top, bottom = ratio.numerator, ratio.denominator
    if len(times) and 2 * (int(abs(times).max()) * top + bottom) >= 1 << 63:
        times = times.astype(object)
    return (2 * times * top + (2 * bottom - 1 if up else bottom)) // (2 * bottom)


def quantized(ticks: Positions, per_second: Fraction, rate: Fraction) -> Positions:
    """Return the number of the sample nearest to each time.

    If a sample period is a whole number of ticks, each time must be exactly on a sample. Otherwise a time may be up to
    one tick away from a sample, because the writer of the file may have rounded or truncated the time. Raise OffGrid
    for a time that is further away, and OverflowError if the number of a sample exceeds 64 bits.

    ticks: the times.
    per_second: the number of ticks per second.
    rate: the number of samples per second.
    """
    period = per_second / rate  # ticks per sample
    samples = rescaled(ticks, 1 / period)
    off = ticks.astype(samples.dtype) * period.denominator - samples * period.numerator
    beyond = np.flatnonzero(abs(off) > (0 if period.denominator == 1 else period.denominator))
    if len(beyond):
        which = int(beyond[0])
        raise OffGrid(which, Fraction(int(off[which]), period.denominator))
    return samples.astype(np.int64)


def refuse_beyond(path: Path, tick: int, per_second: Fraction, rate: Fraction) -> None:
    """Raise BadCapture if the number of the sample nearest to a time exceeds MOST_POSITION.

    tick, per_second, rate: a time in ticks, the number of ticks per second, and the number of samples per second.
    """
    sample = round(tick * rate / per_second)
    if sample > MOST_POSITION:
        raise BadCapture(
            path,
            "its times",
            f"sample {sample} of {rate_text(rate)}",
            f"at most {MOST_POSITION}",
            "state the right rate or none",
        )


def on_grid(
    path: Path, lines: Sequence[Positions], last: int, per_second: Fraction, rate: Fraction, said: str
) -> tuple[list[Positions], int]:
    """Return the sample numbers of the times of each line, and the sample number of the latest time of all.

    lines: the times of each line, in ticks.
    last: a further time in ticks, such as the end of the capture.
    per_second: the number of ticks per second.
    said: the description of a wrong time in the message, with {} in place of the time.

    Raise BadCapture if a time is not on a sample, by the rule of `quantized`, or after sample MOST_POSITION.
    """
    moments = np.unique(np.concatenate([np.array([last], np.int64), *lines]))
    refuse_beyond(path, int(moments[-1]), per_second, rate)
    try:
        samples = quantized(moments, per_second, rate)
    except OffGrid as off:
        raise BadCapture(
            path,
            "its times",
            said.format(moments[off.which]),
            f"times on the grid of {rate} Hz",
            "state the right rate or none",
        ) from off
    return [samples[np.searchsorted(moments, at)] for at in lines], int(samples[-1])
