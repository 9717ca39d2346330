"""Writer of value change dumps, by the library pyvcd.

Chosen: the coarsest timescale in which a sample is a whole number of ticks. At rates such as 24 MHz there is none: then
times are rounded to a tick so fine that a reader that knows the rate gets the same samples back, and a note says so.
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import count
from pathlib import Path
from typing import IO

from ..capture.capture import BadCapture, Capture
from ..capture.changes import changes
from ..capture.resample import rate_text

SECONDS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}  # decimals of each unit
MOST_TICKS = 1 << 62
FINEST = 15  # decimals of a second: femtoseconds
ROUNDED_TO = 1000  # ticks in a sample, at least, if the timescale does not divide it
LETTERS = "01x"
OURS, SCOPE = "periph-sim", "capture"  # variables need a scope; reading our own files drops it


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture. Return notes on losses. BadCapture if positions have no time, or it is too fine or too long."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        return write_to(file, capture)


def write_to(file: IO[str], capture: Capture, scope: tuple[str, ...] = (SCOPE,)) -> tuple[str, ...]:
    """Write to an open file. scope: prefix of all names."""
    from vcd import VCDWriter

    scale, per_second, notes = timescale_of(capture)
    at, which, states = changes(capture)
    names = channel_names(capture)
    renamed = [f"{c.name!r} {name}" for c, name in zip(capture.channels, names, strict=True) if c.name != name]
    if renamed:
        notes.append(f"names that VCD cannot hold were changed: {', '.join(renamed)}")
    first = len(names)
    times = to_ticks([*at.tolist(), capture.length], per_second / (capture.rate or per_second))
    if times[-1] > MOST_TICKS:
        found, most = f"{times[-1]} ticks of {scale}", f"at most {MOST_TICKS}"
        raise BadCapture(Path(file.name), "its length", found, most, "cut a window")
    with VCDWriter(file, timescale=scale, date="", version=OURS) as writer:
        lines = [
            writer.register_var((*scope, *scopes), name, "wire", size=1, init=LETTERS[state])
            for (*scopes, name), state in zip((name.split(".") for name in names), states.tolist(), strict=False)
        ]
        rows = zip(times[first:-1], which[first:].tolist(), states[first:].tolist(), strict=True)
        for time, line, state in rows:
            writer.change(lines[line], time, LETTERS[state])
        writer.close(times[-1])
    return tuple(notes)


def timescale_of(capture: Capture) -> tuple[str, Fraction, list[str]]:
    """Return (`10 ns`, its ticks a second, a note if samples are not whole ticks)."""
    rate = capture.rate
    if rate is None:
        raise BadCapture(capture.path, "its rate", "none stated", "positions with a time", "state it with --rate")
    exact = [n for n in range(FINEST + 1) if Fraction(10**n) % rate == 0]
    fine = [n for n in range(FINEST + 1) if 10**n >= ROUNDED_TO * rate]
    if not exact and not fine:
        raise BadCapture(
            capture.path,
            "its rate",
            rate_text(rate),
            f"up to {10**FINEST // ROUNDED_TO // 10**9} GHz, or a whole number of femtoseconds a sample",
            "write .psr",
        )
    decimals = (exact or fine)[0]
    unit, size = next((unit, size) for unit, size in SECONDS.items() if size >= decimals)
    scale = f"{10 ** (size - decimals)} {unit}"
    notes = [
        f"a sample of {rate_text(rate)} is no whole number of ticks, so times are rounded to {scale}; "
        "a reader that uses that rate gets the same samples"
    ]
    return scale, Fraction(10**decimals), [] if exact else notes


def to_ticks(positions: list[int], ratio: Fraction) -> list[int]:
    """Return each position times `ratio`, to the nearest whole number."""
    top, bottom = ratio.numerator, ratio.denominator
    return [(2 * position * top + bottom) // (2 * bottom) for position in positions]


def channel_names(capture: Capture) -> list[str]:
    """Return names without blanks, without empty parts, and without duplicates."""
    names: list[str] = []
    for channel in capture.channels:
        parts = [re.sub(r"\s+|^\$", "_", part.strip()) for part in channel.name.split(".")]
        name = ".".join(parts) if all(parts) else f"channel_{channel.index}"
        same = (f"{name}_{number}" for number in count(2))
        names.append(name if name not in names else next(other for other in same if other not in names))
    return names
