"""File formats of captures: each format can be read to a `Capture`, or written from a `Capture`, or both.

A module in this folder that has a NAME is a format. The module defines

    NAME                                     the usual name of the format
    SUFFIXES                                 the usual ends of file names, with the dot; "/" for a folder

and also the definitions for reading, for writing, or for both:

    recognises(path, head)                   return True if a file that begins with the bytes `head` can be of this
                                             format; `head` is b"" for a folder
    read(path, rate=None, salvage=False)     return the Capture; raise BadCapture if it cannot be read

    write(capture, path)                     write the file (`path` is a temporary name); return notes on losses or None
    SAMPLES_ONLY = True                      set if positions must be samples, because the format has no times
    WRITTEN                                  the SUFFIXES that can be written; missing if all can be written

A new module in this folder needs no registration. `rate` is the sampling rate if the file states no rate or a wrong
rate; times in seconds are converted to samples of this rate. With `salvage`, a damaged file is read up to the damage,
and the notes of the Capture say what was left out. A format that cannot do this says so in the error.
"""

from __future__ import annotations

import errno
import importlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from os.path import isdir
from pathlib import Path
from typing import Protocol, cast

from ...core.discover import has_plugins, modules_with
from ...core.input_files import is_input, note_input, open_regular, similar_file
from ...core.phrases import did_you_mean
from ...core.registered import registered
from ...supervisor import remove_unless_complete
from ..capture.capture import BadCapture, Capture, Channel, Span, rate_of
from ..capture.sampling import on_samples, resampled

__all__ = ["BadCapture", "Capture", "Channel", "Format", "Span", "formats", "rate_of", "read", "whole", "write"]

HEAD = 4096  # number of bytes of a file that `recognises` receives

REFUSED = {  # for each suffix that cannot be read, a description and a remedy
    ".sal": ("a Saleae session, whose layout the vendor changes at will", "export CSV or binary from Logic 2"),
    ".logicdata": ("a Saleae Logic 1 session, whose layout is not published", "export CSV from Logic"),
    ".pvs": ("a PulseView setup without samples", "give the .sr file beside it"),
}


class Format(Protocol):
    """The definitions of a format.

    A format that cannot be read has no `recognises` and `read`. A format that cannot be written has no `write`.
    """

    NAME: str
    SUFFIXES: tuple[str, ...]

    def recognises(self, path: Path, head: bytes) -> bool: ...

    def read(self, path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture: ...

    def write(self, capture: Capture, path: Path) -> tuple[str, ...] | None: ...


def _with_plugins(shipped: dict[str, Format], installed: bool) -> dict[str, Format]:
    """Return the formats `shipped` and the formats of plugins.

    The plugins are those of the project in the current folder and, if `installed` is True, of installed distributions.
    """
    if not installed and not has_plugins(Path()):
        return shipped
    return dict(registered("plugins").known_formats(shipped, installed))


def formats(installed: bool = False) -> dict[str, Format]:
    """Return a dictionary from the name of each format's module to the format, including the formats of plugins.

    installed: True to include the plugins of installed distributions.
    """
    shipped = modules_with("NAME", __name__, __path__)
    return _with_plugins({name: cast(Format, module) for name, module in shipped.items()}, installed)


def readers(installed: bool = False) -> dict[str, Format]:
    """Return a dictionary from the names of modules to the formats that can be read. installed: as for `formats`."""
    return {name: found for name, found in formats(installed).items() if hasattr(found, "read")}


def writers(installed: bool = False) -> dict[str, Format]:
    """Return a dictionary from suffixes to the formats that can be written with them. installed: as for `formats`."""
    able = [found for found in formats(installed).values() if hasattr(found, "write")]
    return {suffix: writer for writer in able for suffix in getattr(writer, "WRITTEN", writer.SUFFIXES)}


def read(path: str | Path, rate: Fraction | None = None, *, salvage: bool = False) -> Capture:
    """Read the capture in a file or folder.

    The content of the file determines its format. The suffix only determines which formats are tried first, and, if it
    has only one format, which format reports an error if no format recognises the content. A file with a suffix in
    REFUSED is always rejected.

    rate: the sampling rate, if the file states no rate or a wrong one; None to use the rate of the file.
    salvage: True to read a damaged file up to the damage, if the format allows this.

    Raise BadCapture, with the problem and a remedy, if the file cannot be read; ValueError if `rate` is not positive.
    """
    path = note_input(Path(path))
    suffix = "/" if isdir(path) else path.suffix.casefold()
    if rate is not None and rate <= 0:
        raise ValueError(f"the sampling rate is {rate} Hz; expected more than 0")
    if suffix in REFUSED:
        found, way_out = REFUSED[suffix]
        raise BadCapture(path, "its name", found, _known(), way_out)
    head = _head(path)
    likely = _readers_of(suffix)
    for candidate in likely:
        if candidate.recognises(path, head):
            return candidate.read(path, rate, salvage)
    for installed in (False, True):  # installed plugins are tried last, because finding them takes long
        for candidate in readers(installed).values():
            if candidate not in likely and candidate.recognises(path, head):
                return candidate.read(path, rate, salvage)
    if len(likely) == 1:
        return likely[0].read(path, rate, salvage)
    raise BadCapture(path, "its first bytes", repr(head[:24]) if head else "nothing", _known(), "export one of these")


def _readers_of(suffix: str) -> list[Format]:
    """Return the readable formats of a suffix, including those of the project's plugins.

    Only modules whose source contains the suffix are imported, because most imports take long.
    """
    found: list[Format] = []
    for file in sorted(Path(__file__).parent.glob("*.py")):
        if file.stem != "__init__" and f'"{suffix}"' in file.read_text(encoding="utf-8"):
            module = importlib.import_module(f"{__name__}.{file.stem}")
            if hasattr(module, "read") and suffix in getattr(module, "SUFFIXES", ()):
                found.append(cast(Format, module))
    plugins = _with_plugins({}, False).values()
    return [*found, *(one for one in plugins if hasattr(one, "read") and suffix in one.SUFFIXES)]


def write(capture: Capture, path: str | Path, *, rate: Fraction | None = None) -> tuple[str, ...]:
    """Write a capture in the format of the suffix. Return notes on the differences between the file and the capture.

    rate: the rate to which the capture is resampled first. If the rate is None and the format has only samples, the
        capture is resampled to the lowest rate that loses no edge.

    Raise BadCapture, without creating a file, if the capture cannot be written; ValueError if `rate` is not positive.
    """
    path = Path(path)
    writer = _writer_of(path)
    if rate is not None and rate <= 0:
        raise ValueError(f"the sampling rate is {rate} Hz; expected more than 0")
    ready = ready_for(path, capture if rate is None else resampled(capture, rate))
    with atomic_write(path) as unfinished:
        try:
            lost = writer.write(ready, unfinished)
        except BadCapture as error:
            if str(error).startswith(str(unfinished)):
                raise BadCapture(path, error.place, error.found, error.expected, error.way_out) from None
            raise
        except OSError as error:
            raise BadCapture(
                path, "writing", (error.strerror or "an error").lower(), "room for the file", "give another path"
            ) from error
    return (*ready.notes[len(capture.notes) :], *(lost or ()))


def ready_for(path: Path, capture: Capture) -> Capture:
    """Return the capture in samples if the format of `path` has only samples; otherwise return it unchanged.

    Raise BadCapture if no format has this suffix, or if the conversion to samples fails (see `on_samples`).
    """
    return on_samples(capture) if getattr(_writer_of(path), "SAMPLES_ONLY", False) else capture


def _writer_of(path: Path) -> Format:
    able, name = writers(), path.name.casefold()
    if not any(name.endswith(known) for known in able):
        able = writers(installed=True)
    # The longest known suffix is used, because a suffix may have two dots.
    suffix = max((known for known in able if name.endswith(known)), key=len, default=None)
    if suffix is None:
        raise BadCapture(
            path, "its name", repr(path.suffix), f"one of {', '.join(able)}", did_you_mean(path.suffix, able)
        )
    return able[suffix]


def _head(path: Path) -> bytes:
    if isdir(path):
        return b""
    try:
        with open_regular(path) as file:
            return file.read(HEAD)
    except OSError as error:
        raise BadCapture(
            path,
            "the file",
            (error.strerror or "an error").lower(),
            "a file that can be read",
            similar_file(path) or "check its name",
        ) from error


def _known() -> str:
    return ", ".join(f.NAME for f in readers().values())


NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yield a temporary path with the same suffix.

    The file at the temporary path replaces the file at `path` when the block ends without an error. If the block raises
    an error, the temporary file is removed and the file at `path` is unchanged. Links are followed. A device or pipe,
    such as /dev/stdout, is not replaced; instead the bytes are copied to the device when the block ends.

    Raise BadCapture if no file can be created, if the disk is full, or if the present command has read the file at
    `path`, because an output never replaces an input.
    """
    # Both modules are imported here, because only writing needs them.
    import shutil
    import tempfile

    whole = Path(os.path.realpath(path)) if path.is_symlink() else path
    replaced = whole.is_file() or not path.exists()
    if path.is_dir():
        raise _refused(path, IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR)))
    _refuse_input(whole)
    try:
        folder = whole.parent if replaced else None
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{path.stem}.", suffix=path.suffix)
    except OSError as error:
        raise _refused(path, error) from None
    os.close(handle)
    remove_unless_complete(name)
    try:
        try:
            yield Path(name)
        except OSError as error:
            if error.errno in NO_ROOM:
                raise _refused(path, error) from None
            raise
        _refuse_input(whole)
        try:
            if replaced:
                os.chmod(name, 0o666 & ~_umask())
                os.replace(name, whole)
            else:
                with open(name, "rb") as source, open(path, "wb") as target:
                    shutil.copyfileobj(source, target)
                os.unlink(name)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise _refused(path, error) from None
    except BaseException:
        os.unlink(name)
        raise


def _refuse_input(path: Path) -> None:
    if is_input(path):
        raise BadCapture(
            path,
            "its place",
            "a file that this command reads",
            "a file that is no input",
            "give the output another path",
        )


def _refused(path: Path, error: OSError) -> BadCapture:
    found = (error.strerror or "an error").lower()
    return BadCapture(path, "its place", found, "a place that can be written to", "give another path")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
