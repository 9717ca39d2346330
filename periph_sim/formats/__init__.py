"""Trace files: a path goes in, a `Capture` comes out, whatever wrote the file.

One file of this folder is one format. It defines

    NAME                      what people call it
    SUFFIXES                  the usual ends of its file names, with the dot; "/" for a folder
    recognises(path, head)    whether a file that begins with these bytes can be one (b"" for a folder)
    read(path, rate=None)     the Capture; BadCapture in one sentence if it cannot be had

and is found by being there. `rate` states the sampling rate where the file does not, or says it
wrong; times given in seconds are put on its grid.
"""

from __future__ import annotations

import importlib
import pkgutil
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Protocol, cast

from .capture import BadCapture, Capture, Channel, Span, rate_of

__all__ = ["BadCapture", "Capture", "Channel", "Format", "Span", "formats", "rate_of", "read"]

HEAD = 4096  # bytes of a file that `recognises` is shown

REFUSED = {  # by suffix: what it is, and the way out
    ".sal": ("a Saleae session, whose layout the vendor changes at will", "export CSV or binary from Logic 2"),
    ".logicdata": ("a Saleae Logic 1 session, whose layout is not published", "export CSV from Logic"),
    ".dsl": ("a DSView session", "export VCD or .sr from DSView"),
    ".pvs": ("a PulseView setup without samples", "give the .sr file beside it"),
    ".fst": ("a binary waveform", "convert it with fst2vcd"),
    ".ghw": ("a binary waveform", "let GHDL write a VCD"),
}


class Format(Protocol):
    """What a file of this folder must define to be a format."""

    NAME: str
    SUFFIXES: tuple[str, ...]

    def recognises(self, path: Path, head: bytes) -> bool: ...

    def read(self, path: Path, rate: Fraction | None = None) -> Capture: ...


@cache
def formats() -> dict[str, Format]:
    """Every format of this folder, by the name of its file."""
    found: dict[str, Format] = {}
    for entry in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{entry.name}")
        if hasattr(module, "NAME"):
            found[entry.name] = cast(Format, module)
    return found


def read(path: str | Path, rate: Fraction | None = None) -> Capture:
    """The capture in a file or folder; BadCapture says what is wrong with it and the way out.

    The content decides; the suffix only says which formats are asked first, and which one complains
    when none knows the content.
    """
    path = Path(path)
    suffix = "/" if path.is_dir() else path.suffix.casefold()
    if rate is not None and rate <= 0:
        raise ValueError(f"the sampling rate is {rate} Hz; expected more than 0")
    if suffix in REFUSED:
        found, way_out = REFUSED[suffix]
        raise BadCapture(path, "its name", found, _known(), way_out)
    head = _head(path)
    likely = [f for f in formats().values() if suffix in f.SUFFIXES]
    for candidate in [*likely, *(f for f in formats().values() if f not in likely)]:
        if candidate.recognises(path, head):
            return candidate.read(path, rate)
    if len(likely) == 1:
        return likely[0].read(path, rate)
    raise BadCapture(path, "its first bytes", repr(head[:24]) if head else "nothing", _known(), "export one of these")


def _head(path: Path) -> bytes:
    if path.is_dir():
        return b""
    try:
        with path.open("rb") as file:
            return file.read(HEAD)
    except OSError as error:
        raise BadCapture(
            path, "the file", (error.strerror or "an error").lower(), "a file that can be read", "check its name"
        ) from error


def _known() -> str:
    return ", ".join(f.NAME for f in formats().values())
