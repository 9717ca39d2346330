"""Reader of DSView sessions, `.dsl`: zip archives with a file for each block of a channel, one bit per sample.

    L-<channel>/0, /1, ... --> a byte per sample --> edges

The header lists the channels as probes, with their numbers and names.

Chosen: a probe without blocks was not captured. If channels are switched off, DSView may number the probes of the
header and the folders of the blocks differently. So if a folder has a number that no probe has, probes and
folders are paired in the order of their numbers. With salvage, the levels of a channel are unknown after a damaged
place in its blocks.

Source: the demo captures that come with DSView, whose header versions are 2 and 3.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..capture import size_limits as limits
from ..capture.capture import BadCapture, Capture, Channel, Span
from .session_archive import Archive, Scan, ini_keys, samplerate_of, scanned

NAME = "DSView session (.dsl)"
SUFFIXES = (".dsl",)

WHAT = "DSView session"
SALVAGE = "copy or save it again, or read the intact part with --salvage"


def recognises(path: Path, head: bytes) -> bool:
    return head[:4] == b"PK\3\4" and (path.suffix.casefold() == ".dsl" or head[30:36] == b"header")


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture; `rate` overrides the file's samplerate.

    salvage: True to keep the intact samples of a damaged file. Notes of the capture say what was left out.

    Raise BadCapture if the file is no zip archive, if the header is broken, or if no sample can be read; also for any
    other damage, unless `salvage` is True.
    """
    with path.open("rb") as file:
        archive = Archive(path, file, WHAT, salvage)
        keys = _header(path, archive.text("header"))
        probes = {int(match[1]): name for key, name in keys.items() if (match := re.fullmatch(r"probe(\d{1,4})", key))}
        folders = _folders(path, archive, probes, keys)
        notes = list(archive.notes)
        length = _count(keys, "total samples") or 8 * max(folder.size for folder in folders.values())
        scans = {probe: _scanned(archive, folder, salvage, notes) for probe, folder in folders.items()}
    there = max((scan.length for scan in scans.values()), default=0)
    if there < length and not salvage:
        raise BadCapture(path, "its blocks", f"{there} samples", f"{length} as the header states", SALVAGE)
    rate = samplerate_of(path, "header", keys.get("samplerate"), rate, notes)
    length = min(length, there)
    if not length:
        raise BadCapture(path, "its blocks", "no samples", "logic samples", "capture again")
    channels = tuple(_channel(probes[probe], probe, scan, length) for probe, scan in scans.items())
    if sum(len(channel.edges) for channel in channels) > limits.MOST_EDGES:
        raise BadCapture(path, "its blocks", f"over {limits.MOST_EDGES} edges", "fewer", "cut the capture")
    return Capture(path, rate, length, channels, notes=tuple(notes))


class Folder(NamedTuple):
    """The members with the samples of one channel: L-<number>/0 to L-<number>/<blocks - 1>.

    size: the number of unpacked bytes of all blocks.
    """

    number: int
    blocks: int
    size: int


def _scanned(archive: Archive, folder: Folder, salvage: bool, notes: list[str]) -> Scan:
    scan = Scan(archive.path, 1, {0: ""})
    for block in range(folder.blocks):
        before = scan.length, scan.rest
        if damage := scanned(archive, f"L-{folder.number}/{block}", scan, salvage, _samples):
            if not damage.cut:
                scan.cut(*before)
            notes.append(f"{damage.member} holds {damage.found}: its channel is dropped from sample {scan.length} on")
            break
    return scan


def _samples(block: bytes) -> bytes:
    """Return a byte for each bit of a block."""
    return np.unpackbits(np.frombuffer(block, np.uint8), bitorder="little").tobytes()


def _channel(name: str, probe: int, scan: Scan, length: int) -> Channel:
    """Return the channel of a scan up to `length` samples. After the last sample of the scan, the level is unknown."""
    (found,) = scan.channels()
    known = min(scan.length, length)
    unknown = (Span(known, length),) if known < length else ()
    return Channel(name, probe, found.initial, found.edges[: np.searchsorted(found.edges, known)], unknown)


def _folders(path: Path, archive: Archive, probes: dict[int, str], keys: dict[str, str]) -> dict[int, Folder]:
    """Return a dictionary from the numbers of the probes that have blocks to the folders with these blocks."""
    sizes: dict[int, int] = {}
    blocks = _count(keys, "total blocks") or 0
    for name, member in archive.members.items():
        if match := re.fullmatch(r"L-(\d{1,4})/(\d{1,9})", name, re.ASCII):
            sizes[int(match[1])] = sizes.get(int(match[1]), 0) + (member.size or 0)
            blocks = max(blocks, int(match[2]) + 1)
    if not sizes or not probes:
        raise BadCapture(
            path,
            "the archive",
            ("no block L-0/0" if probes else "no probe0"),
            "logic samples",
            "export .sr or VCD from DSView",
        )
    total = sum(sizes.values())
    if total > limits.MOST_BYTES:
        raise BadCapture(path, "its blocks", f"{total} bytes", f"at most {limits.MOST_BYTES}", "cut the capture")
    paired = {probe: probe for probe in sorted(probes) if probe in sizes}
    if len(paired) < len(sizes):
        paired = dict(zip(sorted(probes), sorted(sizes), strict=False))
    return {probe: Folder(number, blocks, sizes[number]) for probe, number in paired.items()}


def _count(keys: dict[str, str], key: str) -> int | None:
    """Return the number that the header states for `key`; None if the number is missing, 0 or invalid."""
    stated = keys.get(key, "")
    return int(stated) if re.fullmatch(r"[1-9]\d{0,17}", stated, re.ASCII) else None


def _header(path: Path, text: str) -> dict[str, str]:
    keys, version = ini_keys(text, "[header]"), ini_keys(text, "[version]").get("version", "")
    if version not in ("2", "3"):
        raise BadCapture(
            path,
            "header",
            (f"version {version[:20]!r}" if version else "no version"),
            "version 2 or 3",
            "export .sr or VCD from DSView",
        )
    if keys.get("device mode", "0") != "0":
        raise BadCapture(path, "header, device mode", keys["device mode"][:20], "0, logic", "capture logic channels")
    return keys
