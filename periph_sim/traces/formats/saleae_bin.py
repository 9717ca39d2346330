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
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any, NamedTuple

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
ORDER = "begin, rising times, end"
OR_SALVAGE = ", or read the intact part with --salvage"


@dataclass(frozen=True)
class Chunk:
    """A part of a channel without gaps. Times are in seconds.

    initial: the level at the beginning of the chunk.
    rate: the number of samples per second; None in version 0.
    begin, end: the stated times of the beginning and the end.
    times: the times of the changes, up to the damage if the chunk is damaged.
    damaged: True if later times are wrong, or missing because the file ends too early.
    """

    initial: int
    rate: float | None
    begin: float
    end: float
    times: NDArray[np.float64]
    damaged: bool


def recognises(path: Path, head: bytes) -> bool:
    return bool(_files(path)) if path.is_dir() else head.startswith(MARK)


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture of one file, or of all `digital_N.bin` of a folder.

    salvage: True to keep the levels before a damaged place. Notes of the capture say what was left out.

    Raise BadCapture with the file and place of an error.
    """
    files = _files(path) if path.is_dir() else {_number(path) or 0: path}
    if not files:
        raise BadCapture(path, "the folder", "no digital_N.bin", "one file a channel", "export digital data as binary")
    notes: list[str] = []
    chunks = {index: _chunks(file, notes if salvage else None) for index, file in files.items()}
    edges = sum(len(chunk.times) for parts in chunks.values() for chunk in parts)
    if edges > limits.MOST_EDGES:
        raise BadCapture(path, "its counts", f"{edges} edges", f"at most {limits.MOST_EDGES}", "export a shorter time")
    stated = {chunk.rate for parts in chunks.values() for chunk in parts}
    if rate is None and len(stated) == 1 and (only := stated.pop()) is not None:
        rate = Fraction(only)
    begin = min(part.begin for parts in chunks.values() for part in parts)
    end = max(part.end for parts in chunks.values() for part in parts)
    grid = _Grid(begin, rate)
    length = int(grid.places(path, np.array([end]))[0]) + 1
    channels = tuple(_channel(file, grid, index, chunks[index], length) for index, file in files.items())
    return Capture(path, rate or NANOSECONDS, length, channels, rate is not None, tuple(notes))


class _Grid(NamedTuple):
    """Conversion of seconds to positions counted from `begin`. rate: samples per second; None if it is unknown."""

    begin: float
    rate: Fraction | None

    def places(self, path: Path, times: NDArray[np.float64], are_changes: bool = False) -> Positions:
        """Return the position nearest to each time.

        Raise BadCapture if a position exceeds MOST_POSITION.

        are_changes: True to raise BadCapture, too, if the rate is known and a time is not on a sample.
        """
        rate = float(self.rate or NANOSECONDS)
        with np.errstate(over="ignore"):  # values of more than 64 bits are rejected below
            exact = (times - self.begin) * rate
        if not np.all(np.abs(exact) < MOST_POSITION):
            raise BadCapture(path, "its times", "a time beyond 64 bits", "seconds", "export it again")
        near = np.rint(exact)
        off = np.abs(exact - near) > OFF_GRID
        if are_changes and self.rate is not None and off.any():
            found = f"a change at {times[off][0]} s"
            raise BadCapture(path, "its times", found, f"the grid of {rate:g} Hz", "state the right rate")
        return near.astype(np.int64)


def _channel(path: Path, grid: _Grid, index: int, chunks: list[Chunk], length: int) -> Channel:
    """Return the channel of one file. After a damaged place, its level is unknown."""
    parts: list[tuple[Positions, Levels]] = []  # for each chunk and gap: positions, and the state from each position on
    known_to = 0
    for chunk in chunks:
        known = chunk.end if not chunk.damaged else chunk.times[-1] if len(chunk.times) else chunk.begin
        begin, end = grid.places(path, np.array([chunk.begin, known])).tolist()
        if begin > known_to:
            parts.append(_unknown_from(known_to))
        at = np.append(begin, grid.places(path, chunk.times, are_changes=True))
        parts.append((at, (np.arange(len(at)) + chunk.initial & 1).astype(np.uint8)))
        known_to = end + 1
        if chunk.damaged:
            break
    if known_to < length:
        parts.append(_unknown_from(known_to))
    positions, states = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return channel_of_states(path.stem, index, positions, states, length)


def _unknown_from(position: int) -> tuple[Positions, Levels]:
    return np.array([position], np.int64), np.array([UNKNOWN], np.uint8)


def _files(folder: Path) -> dict[int, Path]:
    found = {number: file for file in folder.glob("*.bin") if (number := _number(file)) is not None}
    return dict(sorted(found.items()))


def _number(path: Path) -> int | None:
    match = re.fullmatch(r"digital_(\d+)\.bin", path.name)
    return int(match[1]) if match else None


def _chunks(path: Path, notes: list[str] | None) -> list[Chunk]:
    """Read the chunks of a file.

    If the file is damaged, leave out the rest and add a note. Raise BadCapture instead if `notes` is None, or if the
    head of the file or of the first chunk is damaged.
    """
    try:
        opened = open_regular(path)
    except OSError as error:
        raise BadCapture(
            path, "the file", (error.strerror or "an error").lower(), "a file that can be read", "export it again"
        ) from None
    with opened as file:
        # The times are views of the mapped file, so a file with too many of them does not fill the memory.
        cursor = _Cursor(path, mmap(file.fileno(), 0, access=ACCESS_READ) if file.seek(0, 2) else b"")
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
    path, place = cursor.path, f"byte {cursor.at}"
    (level,) = cursor.read("I")
    (rate,) = cursor.read("d") if version else (None,)
    begin, end, count = cursor.read("ddQ")
    if level > 1:
        raise BadCapture(path, place, f"initial level {level}", "0 or 1", "export it again")
    if rate is not None and not 0 < rate < float("inf"):
        raise BadCapture(path, place, f"sample rate {rate}", "more than 0", "export it again")
    if not float("-inf") < begin <= end < float("inf"):
        raise BadCapture(path, place, "times out of order", ORDER, "export it again")
    whole = count if notes is None else min(count, cursor.left // 8)
    at = cursor.skip(8 * whole, OR_SALVAGE)
    times = np.frombuffer(cursor.content, "<f8", whole, at)
    sound = np.isfinite(times) & (np.diff(times, prepend=begin) >= 0) & (times <= end)
    good = len(times) if sound.all() else int(np.argmin(sound))
    if good < len(times) and notes is None:
        raise BadCapture(path, place, "times out of order", ORDER, f"export it again{OR_SALVAGE}")
    if whole < count and notes is not None:
        notes.append(f"{path.name} ends after {whole} of {count} changes: the rest is dropped")
    if good < len(times) and notes is not None:
        notes.append(f"{path.name} has times out of order from byte {at + 8 * good} on: they are dropped")
    return Chunk(level, rate, begin, end, times[:good], good < count)


class _Cursor:
    """Sequential reader of the bytes of a file. `read` and `skip` raise BadCapture if the file ends too early."""

    def __init__(self, path: Path, content: mmap | bytes) -> None:
        self.path = path
        self.content = content
        self.at = 0

    @property
    def left(self) -> int:
        return len(self.content) - self.at

    def read(self, layout: str) -> tuple[Any, ...]:
        return struct.unpack_from("<" + layout, self.content, self.skip(struct.calcsize("<" + layout)))

    def skip(self, size: int, more: str = "") -> int:
        """Skip `size` bytes, and return the index of the first of them.

        more: a text to append to the remedy in the message, if the file ends too early.
        """
        if size > self.left:
            found, way_out = f"{self.left} bytes more", f"the file was cut, export it again{more}"
            raise BadCapture(self.path, f"byte {self.at}", found, f"{size}", way_out)
        self.at += size
        return self.at - size
