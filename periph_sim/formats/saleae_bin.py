"""Saleae's binary export, versions 0 and 1: one file a channel (or their folder) in, edges out.

    <SALEAE> version type | v0: level begin end count times... | v1: chunks of level rate begin end count times...

Times are float64 seconds. They are put on the sampling grid (v1 states it, v0 needs `rate`), else on
nanoseconds, which is what the vendor's CSV of the same capture holds.

Chosen: position 0 is the earliest begin of all files. Time between chunks is unknown.

Source: Saleae's published export formats, binary digital version 0 and the 2025 update.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .capture import BadCapture, Capture, Channel, Positions, Span, channel_of_edges

NAME = "Saleae binary (digital_N.bin or their folder)"
SUFFIXES = (".bin", "/")

MARK = b"<SALEAE>"
KINDS = {1: "analogue data", 100: "a piece of a Logic 2 session"}
NANOSECONDS = Fraction(10**9)
OFF_GRID = 0.02  # of a sample: far more than float64 loses, far less than a wrong rate gives
MOST_POSITIONS = float(1 << 62)


@dataclass(frozen=True)
class Chunk:
    """A stretch without gaps: level at its begin, times of change, all in seconds as the file has them."""

    initial: int
    rate: float | None
    begin: float
    end: float
    times: NDArray[np.float64]


def recognises(path: Path, head: bytes) -> bool:
    return bool(_files(path)) if path.is_dir() else head.startswith(MARK)


def read(path: Path, rate: Fraction | None = None) -> Capture:
    """The capture of one file, or of all `digital_N.bin` of a folder. BadCapture names file and byte."""
    files = _files(path) if path.is_dir() else {_number(path) or 0: path}
    if not files:
        raise BadCapture(path, "the folder", "no digital_N.bin", "one file a channel", "export digital data as binary")
    chunks = {index: _chunks(file) for index, file in files.items()}
    stated = {chunk.rate for parts in chunks.values() for chunk in parts}
    if rate is None and len(stated) == 1 and (only := stated.pop()) is not None:
        rate = Fraction(only)
    begin = min(part.begin for parts in chunks.values() for part in parts)
    end = max(part.end for parts in chunks.values() for part in parts)
    grid = _Grid(begin, rate)
    length = grid.nearest(path, end) + 1
    channels = tuple(_channel(files[index], index, chunks[index], grid, length) for index in sorted(files))
    return Capture(path, rate or NANOSECONDS, length, channels, rate is not None)


class _Grid:
    """Seconds to positions counted from `begin`."""

    def __init__(self, begin: float, rate: Fraction | None) -> None:
        self._begin = begin
        self._rate = float(rate or NANOSECONDS)
        self._strict = rate is not None

    def places(self, path: Path, times: NDArray[np.float64]) -> Positions:
        """Positions of changes. BadCapture if one lies between two samples of a known rate."""
        exact = self._exact(path, times)
        near = np.rint(exact)
        off = np.abs(exact - near) > OFF_GRID
        if self._strict and off.any():
            found = f"a change at {times[off][0]} s"
            raise BadCapture(path, "its times", found, f"the grid of {self._rate:g} Hz", "state the right rate")
        return near.astype(np.int64)

    def nearest(self, path: Path, time: float) -> int:
        """The position nearest to a begin or an end, which real files have between samples, too."""
        return round(float(self._exact(path, np.array([time]))[0]))

    def _exact(self, path: Path, times: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(over="ignore"):  # what does not fit is refused below
            exact = (times - self._begin) * self._rate
        if not np.all(np.abs(exact) < MOST_POSITIONS):
            raise BadCapture(path, "its times", "a time beyond 64 bits", "seconds", "export it again")
        return exact


def _channel(path: Path, index: int, chunks: list[Chunk], grid: _Grid, length: int) -> Channel:
    flips: list[Positions] = []
    unknown: list[Span] = []
    known_to = 0
    level = chunks[0].initial
    for chunk in chunks:
        begin, end = grid.nearest(path, chunk.begin), grid.nearest(path, chunk.end)
        if begin > known_to:
            unknown.append(Span(known_to, begin))
        if chunk.initial != level:  # it changed while nobody looked
            flips.append(np.array([begin]))
        flips.append(grid.places(path, chunk.times))
        level = chunk.initial ^ len(chunk.times) & 1
        known_to = end + 1
    if known_to < length:
        unknown.append(Span(known_to, length))
    at, times = np.unique(np.concatenate(flips), return_counts=True)
    edges = at[times % 2 == 1]  # two changes in one position undo each other
    initial = chunks[0].initial
    if len(edges) and edges[0] == 0:
        initial, edges = initial ^ 1, edges[1:]
    return channel_of_edges(path.stem, index, initial, edges, tuple(unknown))


def _files(folder: Path) -> dict[int, Path]:
    found = {number: file for file in folder.glob("*.bin") if (number := _number(file)) is not None}
    return dict(sorted(found.items()))


def _number(path: Path) -> int | None:
    match = re.fullmatch(r"digital_(\d+)\.bin", path.name)
    return int(match[1]) if match else None


def _chunks(path: Path) -> list[Chunk]:
    cursor = _Cursor(path)
    if cursor.take("8s")[0] != MARK:
        raise BadCapture(path, "byte 0", "no <SALEAE> mark", "a Saleae binary export", "export it again")
    version, kind = cursor.take("ii")
    if kind != 0:
        raise BadCapture(
            path, "byte 12", KINDS.get(kind, f"type {kind}"), "digital data", "export digital data as binary"
        )
    if version not in (0, 1):
        raise BadCapture(path, "byte 8", f"version {version}", "version 0 or 1", "export CSV")
    count = cursor.take("Q")[0] if version else 1
    chunks = []
    for _ in range(min(count, cursor.left)):  # a chunk is more than a byte: no count from the file makes a long loop
        chunks.append(_chunk(cursor, version))
    if len(chunks) < count or not chunks:
        raise BadCapture(path, "byte 16", f"{count} chunks", "at least one, all there", "export it again")
    for before, after in pairwise(chunks):
        if after.begin < before.end:
            raise BadCapture(
                path, "its chunks", "one that begins before the last ends", "chunks in order", "export again"
            )
    return chunks


def _chunk(cursor: _Cursor, version: int) -> Chunk:
    place = f"byte {cursor.at}"
    (level,) = cursor.take("I")
    (rate,) = cursor.take("d") if version else (None,)
    begin, end, count = cursor.take("ddQ")
    times = cursor.doubles(count)
    if level > 1:
        raise BadCapture(cursor.path, place, f"initial level {level}", "0 or 1", "export it again")
    if rate is not None and not 0 < rate < float("inf"):
        raise BadCapture(cursor.path, place, f"sample rate {rate}", "more than 0", "export it again")
    marks = np.concatenate(([begin], times, [end]))
    if not (np.isfinite(marks).all() and (marks[1:] >= marks[:-1]).all()):
        raise BadCapture(cursor.path, place, "times out of order", "begin, rising times, end", "export it again")
    return Chunk(level, rate, begin, end, times)


class _Cursor:
    """A file's bytes, taken from the front; BadCapture at a cut."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.at = 0
        self._data = path.read_bytes()

    @property
    def left(self) -> int:
        return len(self._data) - self.at

    def take(self, layout: str) -> tuple[Any, ...]:
        size = struct.calcsize("<" + layout)
        self._need(size)
        self.at += size
        return struct.unpack_from("<" + layout, self._data, self.at - size)

    def doubles(self, count: int) -> NDArray[np.float64]:
        self._need(8 * count)
        self.at += 8 * count
        return np.frombuffer(self._data, "<f8", count, self.at - 8 * count)

    def _need(self, size: int) -> None:
        if size > self.left:
            raise BadCapture(
                self.path, f"byte {self.at}", f"{self.left} bytes more", f"{size}", "the file was cut, export it again"
            )
