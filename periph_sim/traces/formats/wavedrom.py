"""Writer of WaveDrom's JSON, for a picture of a short window in a document. Each channel is a line of bricks.

    SCL  11100111...

A brick is one character of a `wave`. All bricks have the same length, so the picture is true to scale. The length of a
brick is the greatest common divisor of the positions of all changes and of the end; without the end, if there would be
too many bricks. A window that needs too many bricks nevertheless, or has too many edges, is an error.

Source: the WaveDrom schema (github.com/wavedrom/schema), waves `0`, `1`, `x` and `.` for "as before".
"""

from __future__ import annotations

import json
from fractions import Fraction
from math import gcd
from pathlib import Path

from ..capture.capture import STATE_LETTERS, BadCapture, Capture, changes

NAME = "WaveDrom (.wavedrom.json)"
SUFFIXES = (".wavedrom.json",)

MOST_EDGES = 1000
MOST_BRICKS = 4000


def write(capture: Capture, path: Path) -> None:
    """Write a capture as the source of a picture.

    Raise BadCapture if the capture has too many edges, or if a wave would have too many characters (bricks).
    """
    edges = sum(len(channel.edges) for channel in capture.channels)
    if edges > MOST_EDGES:
        _refuse(capture, f"{edges} edges", f"at most {MOST_EDGES}")
    count = len(capture.channels)
    at, which, states = (column.tolist() for column in changes(capture))
    brick = gcd(*at, capture.length) or 1
    bricks = capture.length // brick
    if bricks > MOST_BRICKS:
        brick = gcd(*at) or capture.length  # the end of the window may be within a brick
        bricks = -(-capture.length // brick)
    if bricks > MOST_BRICKS:
        _refuse(capture, f"{bricks} bricks of {brick} positions", f"at most {MOST_BRICKS}")
    waves = [["."] * bricks for _ in range(count)]
    for position, line, state in zip(at, which, states, strict=True):
        waves[line][position // brick] = STATE_LETTERS[state]
    lanes = [{"name": c.name, "wave": "".join(wave)} for c, wave in zip(capture.channels, waves, strict=True)]
    long = "" if capture.rate is None else f", {_time(brick / capture.rate)} each"
    foot = {"text": f"{bricks} bricks{long}"}
    picture = {"signal": lanes, "config": {"skin": "narrowerer"}, "foot": foot}
    path.write_text(json.dumps(picture, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _refuse(capture: Capture, found: str, expected: str) -> None:
    raise BadCapture(capture.path, "the window", found, expected, "state a shorter one, as --window '100 us..150 us'")


def _time(length: Fraction) -> str:
    """Format a length: `250 ns`, `8.333 us`."""
    for unit, size in (("s", 1), ("ms", 10**3), ("us", 10**6)):
        if length * size >= 1:
            return f"{float(length * size):.6g} {unit}"
    return f"{float(length * 10**9):.6g} ns"
