"""Writer of FST, the compressed waveform of GTKWave and Surfer: from variables with their changes to a file.

The library is GTKWave's own, `fstapi.c`, as `pylibfst` provides it: the extra `fst`. It keeps temporary files beside
the one that it writes, and so gets its own folder.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import groupby, takewhile
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from ..capture.capture import BadCapture, Capture
from ..capture.changes import changes
from .vcd_writer import LETTERS, OURS, channel_names, timescale_of, to_ticks

TEXT = 0  # the width of a variable whose values are texts


class Variable(NamedTuple):
    """name: with its scopes, `dsp.I2C_A.I2CSTR`. changes: (time, value) in order, from time 0 on, values as
    `width` letters of 0, 1, x, or as text."""

    name: str
    width: int
    changes: Iterable[tuple[int, str]]


class NoFstLibrary(ImportError):
    """`pylibfst` is not installed."""


def library() -> Any:
    """Return `pylibfst`. NoFstLibrary explains how to install it."""
    try:
        import pylibfst
    except ImportError:
        raise NoFstLibrary(
            "FST is written by pylibfst, which is not installed: pip install 'periph-sim[fst]'"
        ) from None
    return pylibfst


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture. Return notes on losses. BadCapture if positions have no time, or one that is too fine."""
    try:
        library()
    except NoFstLibrary as error:
        raise BadCapture(path, "its format", "no library for it", "one", str(error)) from None
    _, per_second, notes = timescale_of(capture)
    names, notes = channel_names(capture), list(notes)
    at, which, states = changes(capture)
    times = np.array(to_ticks(at.tolist(), per_second / (capture.rate or per_second)), np.int64)
    end = to_ticks([capture.length], per_second / (capture.rate or per_second))[0]
    variables = []
    for number, name in enumerate(names):
        rows = which == number
        letters = [LETTERS[state] for state in states[rows].tolist()]
        variables.append(Variable(name, 1, zip(times[rows].tolist(), letters, strict=True)))
    path.write_bytes(fst_bytes(per_second, variables, end))
    return tuple(notes)


def fst_bytes(per_second: Fraction, variables: Sequence[Variable], end: int) -> bytes:
    """Return the file. per_second: times a second, a power of ten. end: the end time."""
    fst = library()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "x.fst"
        _write(fst.lib, fst.ffi.NULL, path, per_second, variables, end)
        return path.read_bytes()


def _write(lib: Any, null: Any, path: Path, per_second: Fraction, variables: Sequence[Variable], end: int) -> None:
    file = lib.fstWriterCreate(str(path).encode(), 1)
    lib.fstWriterSetTimescale(file, 1 - len(str(int(per_second))))
    lib.fstWriterSetDate(file, b"")  # equal runs give equal files
    lib.fstWriterSetVersion(file, OURS.encode())
    handles = _declared(lib, null, file, [(one.name, one.width) for one in variables])
    events = [(time, number, value.encode()) for number, one in enumerate(variables) for time, value in one.changes]
    for time, changed in groupby(sorted(events, key=itemgetter(0)), key=itemgetter(0)):
        lib.fstWriterEmitTimeChange(file, time)
        for _, number, value in changed:
            if variables[number].width == TEXT:
                lib.fstWriterEmitVariableLengthValueChange(file, handles[number], value, len(value))
            else:
                lib.fstWriterEmitValueChange(file, handles[number], value)
    lib.fstWriterEmitTimeChange(file, end)
    lib.fstWriterClose(file)


def _declared(lib: Any, null: Any, file: Any, variables: Sequence[tuple[str, int]]) -> list[int]:
    """Declare variables and return their handles. Those of one scope are declared together, since scopes are nested."""
    handles = [0] * len(variables)
    inside: list[str] = []
    for number in sorted(range(len(variables)), key=lambda number: variables[number][0].split(".")[:-1]):
        name, width = variables[number]
        *scopes, name = name.split(".")
        same = sum(1 for _ in takewhile(lambda both: both[0] == both[1], zip(inside, scopes, strict=False)))
        for _ in inside[same:]:
            lib.fstWriterSetUpscope(file)
        for scope in scopes[same:]:
            lib.fstWriterSetScope(file, lib.FST_ST_VCD_MODULE, scope.encode(), null)
        inside = scopes
        kind = lib.FST_VT_GEN_STRING if width == TEXT else lib.FST_VT_VCD_WIRE
        handles[number] = lib.fstWriterCreateVar(file, kind, lib.FST_VD_IMPLICIT, width, name.encode(), 0)
    return handles
