"""Reader of packed samples in zip archives, in blocks that fit into the cache of a processor.

    central directory (salvage: or local headers) --> Archive.members --> blocks of unpacked bytes
    block --> words --> words that differ from the previous word --> their changed bits --> edges per channel

Sizes, CRC-32 and the end of the deflate stream are checked while blocks are read. A mismatch raises `Damage`. The
caller converts this to an error, or uses the data before the damage. The directory is read by `zipfile`, but members
are not, because `zipfile` would discard the last data before damage, and take 18 times as long. In a broken archive, a
member whose sizes follow its data is read up to the end of its deflate stream, without a check of CRC-32.

Only the edges of each channel are kept. Words are compared at about the speed of memory, and channels are processed
only where a word changed. So memory and nearly all of the time grow with the number of edges, which is limited.

Source: APPNOTE 6.3 (PKWARE), sections 4.3 and 4.5.
"""

from __future__ import annotations

import struct
import zipfile
from array import array
from bisect import bisect_left
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import BinaryIO, cast

import numpy as np
from numpy.typing import NDArray
from zlib_ng import zlib_ng

from ..capture import size_limits as limits
from ..capture.capture import BadCapture, Channel, rate_of

STORED, DEFLATED = 0, 8
ENCRYPTED, SIZES_BEHIND = 1 << 0, 1 << 3  # flags of a header; SIZES_BEHIND is set if the sizes follow the data
LOCAL = struct.Struct("<4s5H3I2H")
LOCAL_MARK, END_MARK = b"PK\3\4", b"PK\5\6"
END_REACH = 22 + 65535  # maximum length of the end record and the comment after it
WIDE = 0xFFFFFFFF  # the value of a size field if the size has 64 bits and is stored elsewhere
PIECE = 1 << 16  # number of packed bytes that are read at once
# The cast is needed, because the stub declares this class as an instance.
BrokenStream = cast(type[Exception], zlib_ng.error)
BROKEN = (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError, struct.error)


class Damage(ValueError):
    """A member is damaged. cut: True if the archive ends within the member; then the data before this end is intact."""

    def __init__(self, member: str, found: str, cut: bool = False) -> None:
        super().__init__(f"{member}: {found}")
        self.member = member
        self.found = found
        self.cut = cut


@dataclass(frozen=True)
class Member:
    """One packed file of an archive.

    at: the byte of the archive at which the data begins.
    packed: the number of packed bytes.
    method: STORED or DEFLATED.
    size, crc: the number and the CRC-32 of the unpacked bytes; None if the header does not state them.
    """

    name: str
    at: int
    packed: int
    method: int
    size: int | None
    crc: int | None


class Archive:
    """A zip archive in an open file.

    what: the kind of file, for messages.
    members: a dictionary from names to members.
    notes: notes on what could not be read, if `salvage` is True.

    Raise BadCapture if the file is no zip archive. Raise it, too, if `salvage` is False and the directory is damaged or
    lists a member that cannot be unpacked.
    """

    def __init__(self, path: Path, file: BinaryIO, what: str, salvage: bool) -> None:
        self.path = path
        self.what = what
        self.notes: list[str] = []
        self._file = file
        self.members = self._members(salvage)

    def text(self, name: str) -> str:
        """Read a member as UTF-8 text, in which invalid bytes are replaced.

        Raise BadCapture if the member is missing, too large or damaged.
        """
        if name not in self.members:
            raise BadCapture(self.path, "the archive", f"no member {name!r}", f"a {self.what}", "save it again")
        size = self.members[name].size or 0
        blocks = self.blocks(name, limits.MOST_METADATA)
        content = b""
        try:
            while size <= limits.MOST_METADATA and (block := next(blocks, b"")):
                content += block
                size = max(size, len(content))
        except Damage as damage:
            raise BadCapture(self.path, name, damage.found, f"a whole {self.what}", "copy or save it again") from None
        if size > limits.MOST_METADATA:
            raise BadCapture(self.path, name, f"{size} bytes", f"at most {limits.MOST_METADATA}", "save it again")
        return content.decode("utf-8", "replace")

    def blocks(self, name: str, most: int) -> Iterator[bytes]:
        """Yield the unpacked bytes of a member in blocks of at most `most` bytes. Raise Damage at a damaged place."""
        member = self.members[name]
        total = crc = 0
        for block in self._unpacked(member, most):
            total += len(block)
            if member.size is not None and total > member.size:
                raise Damage(name, f"more than the {member.size} bytes it states")
            crc = zlib_ng.crc32(block, crc)
            yield block
        if member.size is not None and total != member.size:
            raise Damage(name, f"{total} bytes instead of {member.size}", cut=self._ends_at(member))
        if member.crc is not None and crc != member.crc:
            raise Damage(name, "bytes that do not fit their CRC-32")

    def _unpacked(self, member: Member, most: int) -> Iterator[bytes]:
        if member.method == STORED:
            yield from self._packed(member, most)
            return
        inflate = zlib_ng.decompressobj(-15)
        for piece in self._packed(member, PIECE):
            while piece and not inflate.eof:
                try:
                    block = inflate.decompress(piece, most)
                except BrokenStream:
                    raise Damage(member.name, "a broken deflate stream") from None
                piece = inflate.unconsumed_tail
                if block:
                    yield block
        while not inflate.eof and (block := inflate.decompress(b"", most)):
            yield block
        if not inflate.eof:
            raise Damage(member.name, "a deflate stream without an end", cut=self._ends_at(member))

    def _packed(self, member: Member, most: int) -> Iterator[bytes]:
        left = member.packed
        self._file.seek(member.at)
        while left and (piece := self._file.read(min(left, most))):
            left -= len(piece)
            yield piece

    def _ends_at(self, member: Member) -> bool:
        """Return True if the archive ends within this member."""
        return member.at + member.packed >= self._file.seek(0, 2)

    # Places of the members ---------------------------------------------------------

    def _members(self, salvage: bool) -> dict[str, Member]:
        try:
            self._check_directory()
            with zipfile.ZipFile(self._file) as directory:
                return {info.filename: self._listed(info) for info in directory.infolist()}
        except BROKEN as error:
            found = f"a broken zip ({str(error) or type(error).__name__})"
            if salvage and self._starts_as_zip():
                self.notes.append(f"the archive is {found}: its members were searched one by one")
                return self._searched()
            way_out = "copy or save it again"
            if self._starts_as_zip():
                way_out += ", or read the intact part with --salvage"
            raise BadCapture(self.path, "the archive", found, f"a whole {self.what}", way_out) from None

    def _check_directory(self) -> None:
        """Raise BadZipFile if the directory of the archive, which zipfile reads as a whole, exceeds MOST_DIRECTORY."""
        end = self._file.seek(0, 2)
        self._file.seek(max(0, end - END_REACH))
        tail = self._file.read()
        place = tail.rfind(END_MARK)
        if 0 <= place <= len(tail) - 16:
            (size,) = struct.unpack_from("<I", tail, place + 12)
            if size > limits.MOST_DIRECTORY:
                raise zipfile.BadZipFile(f"a directory of {size} bytes, expected at most {limits.MOST_DIRECTORY}")

    def _starts_as_zip(self) -> bool:
        self._file.seek(0)
        return self._file.read(4) == LOCAL_MARK

    def _listed(self, info: zipfile.ZipInfo) -> Member:
        """Return the member that an entry of the directory describes. Its local header states where the data begins."""
        self._file.seek(info.header_offset)
        head = self._file.read(LOCAL.size)
        if len(head) < LOCAL.size or head[:4] != LOCAL_MARK:
            raise zipfile.BadZipFile(f"no member at byte {info.header_offset}")
        *_, name, extra = LOCAL.unpack(head)
        if refused := self._kind_refused(info.filename, info.flag_bits, info.compress_type):
            raise zipfile.BadZipFile(refused)
        at = info.header_offset + LOCAL.size + name + extra
        return Member(info.filename, at, info.compress_size, info.compress_type, info.file_size, info.CRC)

    def _kind_refused(self, name: str, flags: int, method: int) -> str:
        """Return why a member cannot be unpacked; "" if the member can be unpacked."""
        if flags & ENCRYPTED:
            return f"member {name!r} is encrypted"
        return "" if method in (STORED, DEFLATED) else f"member {name!r} is packed by method {method}, not by deflate"

    def _searched(self) -> dict[str, Member]:
        """Return the members that are found by following local headers, up to the first invalid header.

        If the sizes of a member follow its data, the end of the data is not known yet. The member then has all bytes up
        to the end of the file, and unpacking stops where the data ends. The next header is found by its mark.
        """
        found: dict[str, Member] = {}
        with mmap(self._file.fileno(), 0, access=ACCESS_READ) as data:
            end, at = len(data), 0
            while data[at : at + 4] == LOCAL_MARK and at + LOCAL.size <= end:
                _, _, flags, method, _, _, crc, packed, size, name_size, extra_size = LOCAL.unpack_from(data, at)
                name = data[at + LOCAL.size : at + LOCAL.size + name_size].decode("utf-8", "replace")
                at += LOCAL.size + name_size + extra_size
                if at > end or self._kind_refused(name, flags, method):
                    break
                if method == DEFLATED and (flags & SIZES_BEHIND or packed == WIDE):
                    found.setdefault(name, Member(name, at, end - at, method, None, None))
                    at = data.find(LOCAL_MARK, at)  # -1 if there is no other mark, which ends the loop
                else:
                    found.setdefault(name, Member(name, at, min(packed, end - at), method, size, crc))
                    at += packed
        return found


def ini_keys(text: str, section: str) -> dict[str, str]:
    """Return the keys of a section of an INI text. If a key occurs twice, the first one counts.

    configparser is not used, because it would read the indented keys of real files as continued values.
    """
    keys: dict[str, str] = {}
    present = ""
    for line in (line.strip() for line in text.splitlines()):
        key, equals, value = (part.strip() for part in line.partition("="))
        if line.startswith("["):
            present = line
        elif equals and present == section:
            keys.setdefault(key, value)
    return keys


def samplerate_of(path: Path, place: str, text: str | None, rate: Fraction | None, notes: list[str]) -> Fraction | None:
    """Return `rate` or, if `rate` is None, the samplerate in `text`. Add a note and return None if both are None or 0.

    Raise BadCapture, with `place` as the place in the file, if `text` is no rate.
    """
    if rate:
        return rate
    try:
        stated = rate_of(text) if text is not None else None
    except ValueError:
        raise BadCapture(path, f"{place}, samplerate", repr(text), "a rate such as 4 MHz", "state the rate") from None
    if not stated:
        notes.append("the file states no samplerate, so positions have no time")
    return stated or None


BLOCK = 1 << 16  # number of bytes that are scanned at once; 8 times as many still fit into the caches of a processor

Words = NDArray[np.unsignedinteger]


class Scan:
    """Scanner of blocks of little-endian samples.

    unitsize: the number of bytes of a sample.
    channels: a dictionary from the bit of each channel in a sample to the name of the channel.
    length: the number of complete samples so far.
    rest: the bytes of an incomplete sample at the end of the last block.
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
        """Scan a block of any size. Raise BadCapture if there are more edges than `size_limits` allows."""
        if self.rest:
            block = self.rest + block
        whole = len(block) - len(block) % self._unitsize
        self.rest = block[whole:]
        if whole:
            self._compare(_words(memoryview(block)[:whole], self._unitsize))

    def cut(self, length: int, rest: bytes) -> None:
        """Discard all samples from number `length` on. No block may be fed afterwards.

        rest: the value of the attribute `rest` when `length` samples had been scanned.
        """
        self.length, self.rest = length, rest
        for edges in self._edges.values():
            del edges[bisect_left(edges, length) :]

    def channels(self) -> tuple[Channel, ...]:
        """Return all channels, in the order of the argument `channels`. No block may be fed afterwards."""
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
    """Scan the samples of a member up to the first damaged place. Return this damage; None if the member is intact.

    unpacked: a function that converts a block to samples.

    Raise BadCapture for damage unless `salvage` is True, and if there are too many edges.
    """
    try:
        if member not in archive.members:
            raise Damage(member, "nothing")
        for block in archive.blocks(member, BLOCK):
            scan.feed(unpacked(block))
    except Damage as damage:
        if not salvage:
            raise BadCapture(
                archive.path,
                member,
                damage.found,
                f"a whole {archive.what}",
                "copy or save it again, or read the intact part with --salvage",
            ) from None
        scan.rest = b""
        return damage
    return None


def _changes(words: Words, last: int) -> NDArray[np.int64]:
    """Return the indices of the words that differ from the previous word. last: the word before the first word."""
    differs = np.empty(len(words), np.bool_)
    differs[0] = int(words[0]) != last
    np.not_equal(words[1:], words[:-1], out=differs[1:])
    return np.flatnonzero(differs)


def _words(block: memoryview, unitsize: int) -> Words:
    """Return little-endian samples of 1 to 8 bytes as an array of the narrowest machine words that can hold them."""
    if unitsize in (1, 2, 4, 8):
        return np.frombuffer(block, f"<u{unitsize}")
    wide = np.zeros((len(block) // unitsize, 4 if unitsize == 3 else 8), np.uint8)
    wide[:, :unitsize] = np.frombuffer(block, np.uint8).reshape(-1, unitsize)
    return wide.view(f"<u{wide.shape[1]}")[:, 0]
