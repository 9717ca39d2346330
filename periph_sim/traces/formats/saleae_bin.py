"""Reader of Saleae's binary exports, versions 0 and 1: the file of one channel, or a folder with one file per channel.

    <SALEAE> version type | v0: level begin end count times... | v1: chunks of level rate begin end count times...

Times are float64 seconds. If the rate is known, they are converted to samples: it is `rate` or, in version 1, the rate
that all chunks state. Otherwise they are converted to nanoseconds, as in Saleae's CSV of the same capture.

Chosen: position 0 is the earliest start of all files. Levels between chunks are unknown. With salvage, the levels
of a channel are unknown after a damaged place in its file.

Source: Saleae's published export formats, binary digital version 0 and the 2025 update.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ...core.input_files import open_regular
from ..capture import size_limits as limits
from ..capture.capture import MOST_POSITION, UNKNOWN, BadCapture, Capture, Channel, Levels, Positions, channel_of_states

NAME = "Saleae binary (digital_N.bin or their folder)"
SUFFIXES = (".bin", "/")

MARK = b"<SALEAE>"
KINDS = {1: "analogue data", 100: "a piece of a Logic 2 session"}
NANOSECONDS = Fraction(10**9)
# A change may be up to OFF_GRID samples away from a sample. Errors of float64 are far smaller; errors of a wrong rate
# are far larger.
OFF_GRID = 0.02
BLOCK = 1 << 16  # number of times that are read at once
OR_SALVAGE = ", or read the intact part with --salvage"


@dataclass(frozen=True)
class Chunk:
    """A part of a channel without gaps.

    initial: the level at the beginning of the chunk.
    rate: the number of samples per second; None in version 0.
    begin, end: times in seconds.
    place: the byte of the file at which the chunk begins.
    at: the byte of the file at which the times of changes begin.
    count: the number of these times in the file.
    cut: True if the file ends too early, so that later times are missing.
    """

    initial: int
    rate: float | None
    begin: float
    end: float
    place: int
    at: int
    count: int
    cut: bool = False


def recognises(path: Path, head: bytes) -> bool:
    return bool(_files(path)) if path.is_dir() else head.startswith(MARK)


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture of one file, or of all `digital_N.bin` of a folder.

    Raise BadCapture with the file and place of an error.
    """
    files = _files(path) if path.is_dir() else {_number(path) or 0: path}
    if not files:
        raise BadCapture(path, "the folder", "no digital_N.bin", "one file a channel", "export digital data as binary")
    notes: list[str] = []
    chunks = {index: _chunks(file, notes if salvage else None) for index, file in files.items()}
    edges = sum(chunk.count for parts in chunks.values() for chunk in parts)
    if edges > limits.MOST_EDGES:
        raise BadCapture(path, "its counts", f"{edges} edges", f"at most {limits.MOST_EDGES}", "export a shorter time")
    stated = {chunk.rate for parts in chunks.values() for chunk in parts}
    if rate is None and len(stated) == 1 and (only := stated.pop()) is not None:
        rate = Fraction(only)
    begin = min(part.begin for parts in chunks.values() for part in parts)
    end = max(part.end for parts in chunks.values() for part in parts)
    grid = _Grid(begin, rate)
    length = grid.nearest(path, end) + 1
    channels = tuple(
        _channel(file, grid, index, chunks[index], length, notes if salvage else None)
        for index, file in sorted(files.items())
    )
    return Capture(path, rate or NANOSECONDS, length, channels, rate is not None, tuple(notes))


class _Grid:
    """Conversion of seconds to positions counted from `begin`."""

    def __init__(self, begin: float, rate: Fraction | None) -> None:
        self._begin = begin
        self._rate = float(rate or NANOSECONDS)
        self._strict = rate is not None

    def places(self, path: Path, times: NDArray[np.float64]) -> Positions:
        """Return the positions of changes.

        Raise BadCapture if the rate is known and a change is not on a sample, or if a position exceeds MOST_POSITION.
        """
        exact = self._exact(path, times)
        near = np.rint(exact)
        off = np.abs(exact - near) > OFF_GRID
        if self._strict and off.any():
            raise BadCapture(
                path,
                "its times",
                f"a change at {times[off][0]} s",
                f"the grid of {self._rate:g} Hz",
                "state the right rate",
            )
        return near.astype(np.int64)

    def nearest(self, path: Path, time: float) -> int:
        """Return the position nearest to the start or end of a chunk, even if this time is between two samples."""
        return round(float(self._exact(path, np.array([time]))[0]))

    def _exact(self, path: Path, times: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(over="ignore"):  # values of more than 64 bits are rejected below
            exact = (times - self._begin) * self._rate
        if not np.all(np.abs(exact) < MOST_POSITION):
            raise BadCapture(path, "its times", "a time beyond 64 bits", "seconds", "export it again")
        return exact


def _channel(path: Path, grid: _Grid, index: int, chunks: list[Chunk], length: int, notes: list[str] | None) -> Channel:
    """Read the channel of one file.

    If the file is damaged, add a note to `notes`; if `notes` is None, raise BadCapture.
    """
    parts: list[tuple[Positions, Levels]] = []  # for each chunk and gap: positions, and the state from each position on
    known_to = 0
    with path.open("rb") as file:
        for chunk in chunks:
            begin = grid.nearest(path, chunk.begin)
            if begin > known_to:
                parts.append(_unknown_from(known_to))
            changes, end = _changes(path, file, grid, chunk, notes)
            at = np.concatenate([np.array([begin]), *changes])
            parts.append((at, (np.arange(len(at)) + chunk.initial & 1).astype(np.uint8)))
            known_to = grid.nearest(path, chunk.end if end is None else end) + 1
            if end is not None:
                break
    if known_to < length:
        parts.append(_unknown_from(known_to))
    positions, states = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return channel_of_states(path.stem, index, positions, states, length)


def _unknown_from(position: int) -> tuple[Positions, Levels]:
    return np.array([position], np.int64), np.array([UNKNOWN], np.uint8)


def _changes(
    path: Path, file: BinaryIO, grid: _Grid, chunk: Chunk, notes: list[str] | None
) -> tuple[list[Positions], float | None]:
    """Read the changes of a chunk in blocks. Return their positions, and the last valid time if the chunk is damaged.

    If the chunk is intact, return None in place of this time.
    """
    file.seek(chunk.at)
    found: list[Positions] = []
    last = chunk.begin
    for done in range(0, chunk.count, BLOCK):
        times = np.frombuffer(file.read(8 * min(BLOCK, chunk.count - done)), "<f8")
        steps = np.concatenate(([last], times))
        sound = np.isfinite(times) & (times >= steps[:-1]) & (times <= chunk.end)
        good = len(times) if sound.all() else int(np.argmin(sound))
        if good < len(times) and notes is None:
            place, way_out = f"byte {chunk.place}", f"export it again{OR_SALVAGE}"
            raise BadCapture(path, place, "times out of order", "begin, rising times, end", way_out)
        found.append(grid.places(path, times[:good]))
        last = float(steps[good])
        if good < len(times) and notes is not None:
            place = f"byte {chunk.at + 8 * (done + good)}"
            notes.append(f"{path.name} has times out of order from {place} on: they are dropped")
            return found, last
    return found, last if chunk.cut else None


def _files(folder: Path) -> dict[int, Path]:
    found = {number: file for file in folder.glob("*.bin") if (number := _number(file)) is not None}
    return dict(sorted(found.items()))


def _number(path: Path) -> int | None:
    match = re.fullmatch(r"digital_(\d+)\.bin", path.name)
    return int(match[1]) if match else None


def _chunks(path: Path, notes: list[str] | None) -> list[Chunk]:
    """Read the heads of the chunks of a file. `_changes` reads the times of changes later.

    If the file is damaged, leave out the chunks after the damage and add a note. Raise BadCapture instead if `notes` is
    None, or if the first chunk or the head of the file is damaged.
    """
    try:
        opened = open_regular(path)
    except OSError as error:
        raise BadCapture(
            path, "the file", (error.strerror or "an error").lower(), "a file that can be read", "export it again"
        ) from None
    with opened as file:
        cursor = _Cursor(path, file)
        if cursor.read("8s")[0] != MARK:
            raise BadCapture(path, "byte 0", "no <SALEAE> mark", "a Saleae binary export", "export it again")
        version, kind = cursor.read("ii")
        if kind != 0:
            found = KINDS.get(kind, f"type {kind}")
            raise BadCapture(path, "byte 12", found, "digital data", "export digital data as binary")
        if version not in (0, 1):
            raise BadCapture(path, "byte 8", f"version {version}", "version 0 or 1", "export CSV")
        count = cursor.read("Q")[0] if version else 1
        chunks: list[Chunk] = []
        try:
            # A chunk has at least one byte. So a wrong count does not cause a long loop.
            for _ in range(min(count, cursor.left)):
                chunk = _chunk(cursor, version, notes)
                if chunks and chunk.begin < chunks[-1].end:
                    found = "one that begins before the last ends"
                    raise BadCapture(path, "its chunks", found, "chunks in order", "export again")
                chunks.append(chunk)
        except BadCapture as error:
            if not chunks:
                raise
            if notes is None:
                raise BadCapture(
                    path,
                    error.place,
                    error.found,
                    error.expected,
                    (error.way_out.removesuffix(OR_SALVAGE) + OR_SALVAGE),
                ) from None
            notes.append(f"{error.place} of {path.name} has {error.found}: the rest is dropped")
            return chunks
    if len(chunks) < count or not chunks:
        raise BadCapture(path, "byte 16", f"{count} chunks", "at least one, all there", "export it again")
    return chunks


def _chunk(cursor: _Cursor, version: int, notes: list[str] | None) -> Chunk:
    place = cursor.at
    (level,) = cursor.read("I")
    (rate,) = cursor.read("d") if version else (None,)
    begin, end, count = cursor.read("ddQ")
    if level > 1:
        raise BadCapture(cursor.path, f"byte {place}", f"initial level {level}", "0 or 1", "export it again")
    if rate is not None and not 0 < rate < float("inf"):
        raise BadCapture(cursor.path, f"byte {place}", f"sample rate {rate}", "more than 0", "export it again")
    if not float("-inf") < begin <= end < float("inf"):
        raise BadCapture(
            cursor.path, f"byte {place}", "times out of order", "begin, rising times, end", "export it again"
        )
    at = cursor.at
    if notes is not None and 8 * count > cursor.left:
        whole = cursor.left // 8
        notes.append(f"{cursor.path.name} ends after {whole} of {count} changes: the rest is dropped")
        cursor.skip(8 * whole)
        return Chunk(level, rate, begin, end, place, at, whole, cut=True)
    cursor.skip(8 * count, OR_SALVAGE)
    return Chunk(level, rate, begin, end, place, at, count)


class _Cursor:
    """Sequential reader of the bytes of a file. `read` and `skip` raise BadCapture if the file ends too early."""

    def __init__(self, path: Path, file: BinaryIO) -> None:
        self.path = path
        self.at = 0
        self._file = file
        self._size = file.seek(0, 2)

    @property
    def left(self) -> int:
        return self._size - self.at

    def read(self, layout: str) -> tuple[Any, ...]:
        at = self.at
        self.skip(struct.calcsize("<" + layout))
        self._file.seek(at)
        return struct.unpack("<" + layout, self._file.read(self.at - at))

    def skip(self, size: int, more: str = "") -> None:
        if size > self.left:
            raise BadCapture(
                self.path,
                f"byte {self.at}",
                f"{self.left} bytes more",
                f"{size}",
                f"the file was cut, export it again{more}",
            )
        self.at += size
