"""sigrok sessions, `.sr` versions 1 and 2: a zip of metadata and packed samples in, edges out.

    logic-1 | logic-1-1, -2, ... -10 --> blocks of words --> changed words --> edges a channel

Samples are looked at block by block, so memory follows the number of changes and not the length;
both are limited, because a zip of a few kilobytes can hold terabytes of either.

Chosen: a file that names no probe at all has all of `total probes`, called 0, 1, ...; where some
are named, the nameless were not captured.

Source: sigrok's file format as its own tools write it (libsigrok 0.1 to 0.6 files).
"""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .capture import BadCapture, Capture, Channel, channel_of_edges, rate_of

NAME = "sigrok session (.sr)"
SUFFIXES = (".sr",)

BLOCK = 1 << 20  # samples looked at in one go
MOST_BYTES = 1 << 36  # unpacked: 64 GiB of samples
MOST_CHANGES = 1 << 27  # 2 GiB of positions and words
MOST_METADATA = 1 << 20

Words = NDArray[np.unsignedinteger]


@dataclass(frozen=True)
class Metadata:
    """What the member `metadata` says about the first device."""

    capturefile: str
    unitsize: int
    probes: dict[int, str]  # bit of the sample -> name
    samplerate: str | None


def recognises(path: Path, head: bytes) -> bool:
    return head.startswith(b"PK")


def read(path: Path, rate: Fraction | None = None) -> Capture:
    """The capture; `rate` wins over the file's samplerate. BadCapture if zip, metadata or samples are broken."""
    try:
        with zipfile.ZipFile(path) as archive:
            return _read(path, archive, rate)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        NotImplementedError,
        RuntimeError,
        OSError,
        UnicodeDecodeError,
    ) as error:
        found = f"a broken zip ({str(error) or type(error).__name__})"
        raise BadCapture(path, "the archive", found, "a whole sigrok session", "copy or save it again") from error


def _read(path: Path, archive: zipfile.ZipFile, rate: Fraction | None) -> Capture:
    _check_version(path, archive)
    meta = _metadata(path, _member(path, archive, "metadata").decode("utf-8", "replace"))
    members = _sample_members(path, archive, meta.capturefile)
    notes: list[str] = []
    if rate is None and meta.samplerate is not None:
        try:
            rate = rate_of(meta.samplerate)
        except ValueError as error:
            raise BadCapture(
                path, "metadata, samplerate", repr(meta.samplerate), "a rate such as 4 MHz", "state the rate"
            ) from error
    if not rate:
        notes.append("the file states no samplerate, so positions have no time")
        rate = None

    scan = _Scan(path, meta)
    for member in members:
        with archive.open(member) as stream:
            while block := stream.read(BLOCK * meta.unitsize):
                scan.feed(block)
    if not scan.length:
        raise BadCapture(path, meta.capturefile, "no samples", "logic samples", "capture again")
    if scan.rest:
        notes.append(f"{len(scan.rest)} bytes of a partial sample at the end are left out")
    return Capture(path, rate, scan.length, tuple(scan.channels()), notes=tuple(notes))


class _Scan:
    """Blocks of packed samples in, in order; positions and words at which a captured channel changed out."""

    def __init__(self, path: Path, meta: Metadata) -> None:
        self.length = 0
        self.rest = b""  # of a sample that the last block cut
        self._path = path
        self._meta = meta
        self._mask = sum(1 << bit for bit in meta.probes)
        self._first = 0
        self._last = 0
        self._changes = 0
        self._at: list[NDArray[np.int64]] = []
        self._words: list[Words] = []

    def feed(self, block: bytes) -> None:
        if self.rest:
            block = self.rest + block
        whole = len(block) - len(block) % self._meta.unitsize
        self.rest = block[whole:]
        if whole:
            self._compare(_words(block[:whole], self._meta.unitsize))

    def _compare(self, words: Words) -> None:
        mask = words.dtype.type(self._mask)
        if int(mask) != np.iinfo(words.dtype).max:
            words = words & mask
        if self.length == 0:
            self._first = self._last = int(words[0])
        at = np.flatnonzero(words[1:] != words[:-1]) + 1
        if int(words[0]) != self._last:
            at = np.concatenate(([0], at))
        self._changes += len(at)
        if self._changes > MOST_CHANGES:
            place = f"sample {self.length + len(words)}"
            raise BadCapture(
                self._path, place, f"over {MOST_CHANGES} changes", "fewer", "cut the capture or drop its busy channels"
            )
        self._at.append(at + self.length)
        self._words.append(words[at])
        self._last = int(words[-1])
        self.length += len(words)

    def channels(self) -> Iterator[Channel]:
        at = np.concatenate(self._at)
        words = np.concatenate(self._words)
        for bit, name in self._meta.probes.items():
            levels = (words >> words.dtype.type(bit)).astype(np.uint8) & 1
            initial = self._first >> bit & 1
            changed = levels != np.concatenate(([initial], levels[:-1]))
            yield channel_of_edges(name, bit, initial, at[changed])


def _words(block: bytes, unitsize: int) -> Words:
    """Little-endian samples of 1 to 8 bytes as an array of the next wider machine word."""
    if unitsize in (1, 2, 4, 8):
        return np.frombuffer(block, f"<u{unitsize}")
    wide = np.zeros((len(block) // unitsize, 4 if unitsize == 3 else 8), np.uint8)
    wide[:, :unitsize] = np.frombuffer(block, np.uint8).reshape(-1, unitsize)
    return wide.view(f"<u{wide.shape[1]}")[:, 0]


def _check_version(path: Path, archive: zipfile.ZipFile) -> None:
    version = _member(path, archive, "version").strip()
    if version not in (b"1", b"2"):
        raise BadCapture(path, "version", repr(version.decode("utf-8", "replace")), "1 or 2", "save it with sigrok 0.7")


def _member(path: Path, archive: zipfile.ZipFile, name: str) -> bytes:
    try:
        size = archive.getinfo(name).file_size
    except KeyError:
        raise BadCapture(
            path, "the archive", f"no member {name!r}", "a sigrok session", "save it again as .sr"
        ) from None
    if size > MOST_METADATA:
        raise BadCapture(path, name, f"{size} bytes", f"at most {MOST_METADATA}", "save it again as .sr")
    return archive.read(name)


def _sample_members(path: Path, archive: zipfile.ZipFile, capturefile: str) -> list[zipfile.ZipInfo]:
    """The members that hold samples, in order: one plain, or chunks by number (10 after 9)."""
    numbered: dict[int, zipfile.ZipInfo] = {}
    single: list[zipfile.ZipInfo] = []
    for info in archive.infolist():
        if info.filename == capturefile:
            single.append(info)
        elif match := re.fullmatch(re.escape(capturefile) + r"-(\d+)", info.filename):
            numbered[int(match[1])] = info
    members = single[:1] or [numbered[n] for n in sorted(numbered)]
    if not members:
        raise BadCapture(
            path,
            "the archive",
            f"no member {capturefile!r} or {capturefile + '-1'!r}",
            "logic samples",
            "capture again",
        )
    for number in range(1, len(numbered) + 1) if not single else ():
        if number not in numbered:
            raise BadCapture(
                path, "the archive", f"no chunk {capturefile}-{number}", f"chunks 1 to {max(numbered)}", "save it again"
            )
    size = sum(info.file_size for info in members)
    if size > MOST_BYTES:
        raise BadCapture(path, capturefile, f"{size} bytes unpacked", f"at most {MOST_BYTES}", "cut it with sigrok-cli")
    return members


def _metadata(path: Path, text: str) -> Metadata:
    """Sections and keys by hand: real files indent keys, which configparser takes for continued values."""
    section = ""
    keys: dict[str, str] = {}
    for line in (line.strip() for line in text.splitlines()):
        if line.startswith("["):
            section = line
        elif section == "[device 1]" and "=" in line:
            key, _, value = line.partition("=")
            keys.setdefault(key.strip(), value.strip())
    if not keys:
        raise BadCapture(path, "metadata", "no section [device 1]", "the device's settings", "save it again as .sr")
    unitsize = _number(path, keys, "unitsize", 1, 8)
    probes = {}
    for key, value in keys.items():
        if (match := re.fullmatch(r"probe(\d+)", key)) and value:
            bit = int(match[1]) - 1
            if not 0 <= bit < 8 * unitsize:
                fit = f"probe1 to probe{8 * unitsize}"
                raise BadCapture(path, f"metadata, {key}", f"unitsize {unitsize}", fit, "mend the metadata")
            probes[bit] = value
    if not probes:
        total = _number(path, keys, "total probes", 1, 8 * unitsize)
        probes = {bit: str(bit) for bit in range(total)}
    return Metadata(keys.get("capturefile", "logic-1"), unitsize, dict(sorted(probes.items())), keys.get("samplerate"))


def _number(path: Path, keys: dict[str, str], key: str, least: int, most: int) -> int:
    value = keys.get(key, "nothing")
    if not value.isdecimal() or not least <= int(value) <= most:
        raise BadCapture(path, f"metadata, {key}", value, f"{least} to {most}", "mend the metadata or save it again")
    return int(value)
