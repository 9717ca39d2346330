"""Sessions of sigrok, `.sr`: zip archives of metadata and packed samples. Files are written in version 2.

    logic-1 | logic-1-1, -2, ... -10 --> blocks of samples --> edges per channel
    edges per channel --> words --> chunks logic-1-1, -2, ... of 4 MiB

Chosen: if a file names no probes, the number of probes is `total probes`, and their names are 0, 1, and so on. If a
file names some probes, the others were not captured. With salvage, a damaged chunk and all later chunks are left out.
But if the file ends within a chunk, or if the first chunk is damaged, the samples before the damage are kept.

Source: sigrok's file format as its own tools write and read it (libsigrok 0.1 to 0.6 files).
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from ...core.phrases import counted
from ..capture import size_limits as limits
from ..capture.capture import MOST_DIGITS, BadCapture, Capture
from ..capture.channel_names import channels_named
from ..capture.sampling import rate_text
from .session_archive import Archive, Scan, ini_keys, samplerate_of, scanned

NAME = "sigrok session (.sr)"
SUFFIXES = (".sr",)
SAMPLES_ONLY = True

WHAT = "sigrok session"
CHUNK = 1 << 22  # number of bytes of a chunk, as in files of sigrok's own writer
MOST_WIDE = 64  # maximum number of channels, which is 8 bytes per sample
SALVAGE = "read the intact part with --salvage"


@dataclass(frozen=True)
class Metadata:
    """The data about the first device in the member `metadata`.

    capturefile: the name of the member with the samples, or the prefix of the names of the chunks.
    unitsize: the number of bytes of a sample.
    probes: a dictionary from the bit of each probe in a sample to the name of the probe.
    """

    capturefile: str
    unitsize: int
    probes: dict[int, str]
    samplerate: str | None


def recognises(path: Path, head: bytes) -> bool:
    return head.startswith(b"PK")


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture; `rate` overrides the file's samplerate.

    salvage: True to read what is intact in a damaged file. Notes of the capture say what was left out or may be wrong.

    Raise BadCapture if the file is no zip archive, if the metadata are broken, or if no sample can be read; also for
    any other damage, unless `salvage` is True.
    """
    with path.open("rb") as file:
        archive = Archive(path, file, WHAT, salvage)
        if (version := archive.text("version").strip()) not in ("1", "2"):
            raise BadCapture(path, "version", repr(version[:40]), "1 or 2", "save it with sigrok 0.7")
        meta = _metadata(path, archive.text("metadata"))
        notes = list(archive.notes)
        members = _sample_members(path, archive, meta.capturefile, notes if salvage else None)
        rate = samplerate_of(path, "metadata", meta.samplerate, rate, notes)
        scan = Scan(path, meta.unitsize, meta.probes)
        for member in members:
            if not _scanned(archive, member, scan, salvage, notes):
                break
    if not scan.length:
        raise BadCapture(path, meta.capturefile, "no samples", "logic samples", "capture again")
    if scan.rest:
        notes.append(f"a partial sample at the end is dropped, {counted(len(scan.rest), 'byte')}")
    return Capture(path, rate, scan.length, scan.channels(), notes=tuple(notes))


def _scanned(archive: Archive, member: str, scan: Scan, salvage: bool, notes: list[str]) -> bool:
    """Scan the samples of a member. Return True if the member is intact; otherwise add a note."""
    before = scan.length, scan.rest
    damage = scanned(archive, member, scan, salvage)
    if damage is None:
        return True
    if damage.cut:
        notes.append(f"{member} holds {damage.found}: all samples after {scan.length} are dropped")
    elif before[0]:
        scan.cut(*before)
        notes.append(f"{member} holds {damage.found}: it and all samples after {scan.length} are dropped")
    else:
        notes.append(f"{member} holds {damage.found}: its samples are read up to {scan.length}, some may be wrong")
    return False


def _sample_members(path: Path, archive: Archive, capturefile: str, notes: list[str] | None) -> list[str]:
    """Return the members that contain samples: a single member, or chunks in the order of their numbers (10 after 9).

    If a number is missing, the list ends before this number and a note is added. Raise BadCapture instead if `notes` is
    None or if number 1 is missing, and if there are no samples or too many.
    """
    chunk = re.compile(re.escape(capturefile) + r"-(\d{1,9})", re.ASCII)
    numbered = {int(match[1]): name for name in archive.members if (match := chunk.fullmatch(name))}
    members = [capturefile] if capturefile in archive.members else [numbered[n] for n in sorted(numbered)]
    if not members:
        found = f"no member {capturefile!r} or {capturefile + '-1'!r}"
        raise BadCapture(path, "the archive", found, "logic samples", "capture again")
    if capturefile not in archive.members:
        missing = next((n for n in range(1, len(numbered) + 1) if n not in numbered), None)
        if missing is not None:
            expected = f"chunks 1 to {max(numbered)}"
            if notes is None or missing == 1:
                raise BadCapture(
                    path,
                    "the archive",
                    f"no chunk {capturefile}-{missing}",
                    expected,
                    ("save it again" if missing == 1 else f"save it again, or {SALVAGE}"),
                )
            notes.append(f"{capturefile}-{missing} is missing: it and the rest are dropped")
            members = members[: missing - 1]
    size = sum(archive.members[name].size or 0 for name in members)
    if size > limits.MOST_BYTES:
        found = f"{size} bytes unpacked"
        raise BadCapture(path, capturefile, found, f"at most {limits.MOST_BYTES}", "cut it with sigrok-cli")
    return members


def _metadata(path: Path, text: str) -> Metadata:
    keys = ini_keys(text, "[device 1]")
    if not keys:
        raise BadCapture(path, "metadata", "no section [device 1]", "the device's settings", "save it again as .sr")
    unitsize = _number(path, keys, "unitsize", 1, 8)
    probes = {}
    for key, value in keys.items():
        if (match := re.fullmatch(r"probe(\d+)", key)) and value:
            bit = int(match[1][:MOST_DIGITS]) - 1
            if not 0 <= bit < 8 * unitsize:
                raise BadCapture(
                    path,
                    f"metadata, {key}",
                    f"unitsize {unitsize}",
                    f"probe1 to probe{8 * unitsize}",
                    "mend the metadata",
                )
            probes[bit] = value
    if not probes:
        total = _number(path, keys, "total probes", 1, 8 * unitsize)
        probes = {bit: str(bit) for bit in range(total)}
    return Metadata(keys.get("capturefile", "logic-1"), unitsize, dict(sorted(probes.items())), keys.get("samplerate"))


def _number(path: Path, keys: dict[str, str], key: str, least: int, most: int) -> int:
    value = keys.get(key, "nothing")
    if not value.isdecimal() or len(value) > MOST_DIGITS or not least <= int(value) <= most:
        raise BadCapture(path, f"metadata, {key}", value, f"{least} to {most}", "mend the metadata or save it again")
    return int(value)


# Writing of sessions ------------------------------------------------------------------------


def write(capture: Capture, path: Path) -> tuple[str, ...] | None:
    """Write a capture in version 2. The channels are, in order, the bits of a sample from bit 0 on.

    Raise BadCapture if sigrok could not read a file with this capture, or if there are too many samples.
    """
    _check_writable(capture, path)
    with path.open("wb") as file:
        return write_to(file, capture)


def write_to(file: IO[bytes], capture: Capture) -> tuple[str, ...] | None:
    """Write a capture to an open file. Return a note if levels are unknown.

    The capture must have at most 64 channels, and its rate must be a whole number of samples per second or None.
    """
    channels = capture.channels
    unitsize = next(size for size in (1, 2, 4, 8) if len(channels) <= 8 * size)
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        _put(archive, "version", b"2")
        _put(archive, "metadata", _described(capture, unitsize).encode())
        for number, words in enumerate(_chunks(capture, unitsize), 1):
            _put(archive, f"logic-1-{number}", words.data)
    gaps = [channel.name for channel in channels if channel.unknown]
    if gaps:
        return (f"a session has no unknown levels: those of {', '.join(gaps)} are written as the level before them",)
    return None


def _check_writable(capture: Capture, path: Path) -> None:
    """Raise BadCapture, with all reasons and the options that help, if a capture cannot be written."""
    found, expected, options = [], [], []
    if not 1 <= (count := len(capture.channels)) <= MOST_WIDE:
        found.append(f"{count} channels")
        expected.append(f"1 to {MOST_WIDE}")
        options.append("--channels " + ",".join(_few_names(capture)))
    if capture.length > limits.MOST_SAMPLES_WRITTEN:
        at = "" if capture.rate is None else f" of {rate_text(capture.rate)}"
        found.append(f"{capture.length} samples{at}")
        expected.append(f"at most {limits.MOST_SAMPLES_WRITTEN}")
    elif capture.rate is not None and capture.rate.denominator != 1:
        found.append(f"{capture.rate} samples a second")
        expected.append("a whole number")
    if len(expected) > len(options):
        options.append(f"--sample '{_possible_rate(capture)}'")
    if found:
        raise BadCapture(
            path,
            "what it would hold",
            " and ".join(found),
            " and ".join(expected),
            f"convert with {' '.join(options)}, or write .vcd",
        )


def _few_names(capture: Capture) -> list[str]:
    """Return the names of at most four channels: the first channel for each of SCL, SDA, RX and TX.

    If none of these exists, return the names of the first two channels of the capture.
    """
    usual = [found[0].name for line in ("scl", "sda", "rx", "tx") if (found := channels_named(capture, line))]
    return usual or [channel.name for channel in capture.channels[:2]]


def _possible_rate(capture: Capture) -> str:
    """Return a rate at which the capture can be written, at most 4 MHz."""
    rate = Fraction(4_000_000)
    while capture.rate and capture.length / capture.rate * rate > limits.MOST_SAMPLES_WRITTEN:
        rate /= 2
    return rate_text(max(Fraction(1), Fraction(int(rate))))


def _put(archive: zipfile.ZipFile, name: str, content: bytes | memoryview) -> None:
    info = zipfile.ZipInfo(name)  # a member without a date, so that equal captures give equal files
    info.create_system = 3
    info.external_attr = 0o644 << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(info, content)


def _described(capture: Capture, unitsize: int) -> str:
    names = (" ".join(channel.name.split()) or str(channel.index) for channel in capture.channels)
    lines = [
        "[global]",
        "sigrok version=0.5.2",
        "",
        "[device 1]",
        "capturefile=logic-1",
        f"total probes={len(capture.channels)}",
        *([] if capture.rate is None else [f"samplerate={rate_text(capture.rate)}"]),
        "total analog=0",
        *(f"probe{number}={name}" for number, name in enumerate(names, 1)),
        f"unitsize={unitsize}",
    ]
    return "\n".join([*lines, ""])


def _chunks(capture: Capture, unitsize: int) -> Iterator[NDArray[np.unsignedinteger]]:
    """Yield chunks of samples as words. Each edge inverts the bit of its channel in all later samples."""
    samples = CHUNK // unitsize
    word = sum(channel.initial << bit for bit, channel in enumerate(capture.channels))
    for begin in range(0, capture.length, samples):
        flips = np.zeros(min(samples, capture.length - begin), f"<u{unitsize}")
        for bit, channel in enumerate(capture.channels):
            first, last = np.searchsorted(channel.edges, [begin, begin + samples])
            flips[channel.edges[first:last] - begin] ^= flips.dtype.type(1 << bit)
        flips[0] ^= flips.dtype.type(word)
        words = np.bitwise_xor.accumulate(flips)
        word = int(words[-1])
        yield words
