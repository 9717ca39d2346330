"""Decoder of packed samples: blocks of bytes are scanned once, and only the edges of each channel are kept.

    block --> words --> words that differ from the one before --> their changed bits --> positions per channel

The comparison of words runs at about the speed of memory, and a channel takes time only where a word changed. So memory
and nearly all of the time grow with the number of edges, which is limited.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..capture import size_limits as limits
from ..capture.capture import BadCapture, Channel
from .zip_member import Archive, Damage

BLOCK = (
    1 << 16
)  # bytes that are scanned at once; they fit into the caches of a processor, also with a byte for each bit

Words = NDArray[np.unsignedinteger]


class Mark(NamedTuple):
    """A state of a `Scan` to which it can return."""

    length: int
    last: int
    rest: bytes
    edges: tuple[int, ...]


class Scan:
    """Scanner of blocks of little-endian samples.

    unitsize: the number of bytes of a sample.
    channels: the names of the channels, indexed by their bits in a sample.
    length: the number of complete samples so far.
    rest: the bytes of an incomplete sample.
    """

    def __init__(self, path: Path, unitsize: int, channels: dict[int, str]) -> None:
        self.length = 0
        self.rest = b""
        self._path = path
        self._unitsize = unitsize
        self._names = channels
        self._edges = {bit: array("q") for bit in channels}
        self._first = 0
        self._last = 0

    def feed(self, block: bytes) -> None:
        """Scan a block of any size. Raise BadCapture if there are more edges than `limits` allows."""
        if self.rest:
            block = self.rest + block
        whole = len(block) - len(block) % self._unitsize
        self.rest = block[whole:]
        if whole:
            self._compare(_words(memoryview(block)[:whole], self._unitsize))

    def mark(self) -> Mark:
        """Return the present state, to which `back` can return."""
        return Mark(self.length, self._last, self.rest, tuple(len(edges) for edges in self._edges.values()))

    def back(self, mark: Mark) -> None:
        """Discard all blocks that were scanned after the mark."""
        self.length, self._last, self.rest = mark.length, mark.last, mark.rest
        for edges, length in zip(self._edges.values(), mark.edges, strict=True):
            del edges[length:]

    def channels(self) -> tuple[Channel, ...]:
        """Return all channels in the given order. No block may be fed afterwards."""
        return tuple(
            Channel(self._names[bit], bit, self._first >> bit & 1, np.frombuffer(edges, np.int64))
            for bit, edges in self._edges.items()
        )

    def _compare(self, words: Words) -> None:
        if self.length == 0:
            self._first = self._last = int(words[0])
        at = _changes(words, self._last)
        if len(at):
            now = words[at]  # the changed words, whose values hold up to the next change
            flips = now.copy()
            flips[1:] ^= now[:-1]
            flips[0] ^= words.dtype.type(self._last)
            for bit, edges in self._edges.items():
                edges.frombytes((at[(flips & words.dtype.type(1 << bit)) != 0] + self.length).tobytes())
            if sum(len(edges) for edges in self._edges.values()) > limits.MOST_EDGES:
                place, most = f"sample {self.length + len(words)}", limits.MOST_EDGES
                raise BadCapture(
                    self._path, place, f"over {most} edges", "fewer", "cut the capture or drop its busy channels"
                )
        self._last = int(words[-1])
        self.length += len(words)


def scanned(
    archive: Archive, member: str, scan: Scan, salvage: bool, unpacked: Callable[[bytes], bytes] = bytes
) -> Damage | None:
    """Scan the samples of a member. Return its damage, of which the samples before it are scanned; None if it is whole.

    unpacked: a function that converts a block to samples.

    Raise BadCapture for damage unless `salvage` is True.
    """
    try:
        if member not in archive.members:
            raise Damage(member, "nothing")
        for block in archive.blocks(member, BLOCK):
            scan.feed(unpacked(block))
    except Damage as damage:
        if not salvage:
            way_out = "copy or save it again, or read the intact part with --salvage"
            raise BadCapture(archive.path, member, damage.found, f"a whole {archive.what}", way_out) from None
        scan.rest = b""
        return damage
    return None


def _changes(words: Words, last: int) -> NDArray[np.int64]:
    """Return the places of the words that differ from the word before. last: the word before the first one."""
    differs = np.empty(len(words), np.bool_)
    differs[0] = int(words[0]) != last
    np.not_equal(words[1:], words[:-1], out=differs[1:])
    return np.flatnonzero(differs)


def _words(block: memoryview, unitsize: int) -> Words:
    """Return little-endian samples of 1 to 8 bytes as an array of the next wider machine word."""
    if unitsize in (1, 2, 4, 8):
        return np.frombuffer(block, f"<u{unitsize}")
    wide = np.zeros((len(block) // unitsize, 4 if unitsize == 3 else 8), np.uint8)
    wide[:, :unitsize] = np.frombuffer(block, np.uint8).reshape(-1, unitsize)
    return wide.view(f"<u{wide.shape[1]}")[:, 0]
