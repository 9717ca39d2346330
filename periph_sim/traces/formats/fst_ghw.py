"""FST (GTKWave, Verilator, Icarus) and GHW (GHDL): binary waveforms of simulators. FST can also be written.

    file --> a separate process with the library `pywellen` --> positions and states --> Capture

Chosen, as for VCD: tick 0 is position 0; `L` is 0; `H` and `z` are 1; all other states are unknown; reals and strings
are ignored. Each bit of a vector is a channel `name[k]`, where k is 0 for the least significant bit, because the
library does not report declared ranges. The end of the capture is the last time in an FST file, and the last change in
a GHW file, which states no end.

VCD is not read with this library, because the library loses the end of a capture and the declared ranges of vectors.

FST is written by GTKWave's own library, `fstapi.c`, which `pylibfst` provides (the extra `fst`). This library creates
temporary files in the folder of its output, so the output is first written into a temporary folder.
"""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
from collections.abc import Iterable, Sequence
from fractions import Fraction
from importlib.util import find_spec
from itertools import groupby, takewhile
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from ..capture.capture import (
    MOST_POSITION,
    NO_SALVAGE,
    STATE_LETTERS,
    UNKNOWN,
    BadCapture,
    Capture,
    Channel,
    changes,
    channel_of_states,
)
from ..capture.sampling import on_grid, refuse_beyond, rescaled
from .vcd import OURS, STATES, channel_names, timescale_of

NAME = "FST or GHW waveform"
SUFFIXES = (".fst", ".ghw")
WRITTEN = (".fst",)

FST_HEAD = struct.Struct(">BQQQ")  # the first block: its type (0), its length, the first time, the last time
FST_LENGTH = 329
GHW_MARK = b"GHDLwave\n"
READER = Path(__file__).with_name("wellen_worker.py")
PATIENCE = 900  # maximum time in seconds to read a file; usually the reading process reaches its own limit earlier
ERROR = re.compile(r"^(?:[\w.]*(?:Error|Exception)): (.+)$", re.MULTILINE)
NO_END = "the format does not say where the run ends, so the last change is used"

# The state that each letter of a file means: 0, 1 or UNKNOWN. The index is the character code of the letter.
STATE_OF = np.array([STATES.get(code, UNKNOWN) for code in range(256)], np.uint8)


def recognises(path: Path, head: bytes) -> bool:
    return head.startswith(GHW_MARK) or _fst_end(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture in ticks of the file, or in samples if `rate` is given.

    Raise BadCapture if the file has errors.

    salvage: True to say in the error for a damaged file that no part of it can be read.
    """
    with path.open("rb") as file:
        end = _fst_end(file.read(FST_HEAD.size))
    head, signals = _signals(path, salvage)
    if not head["variables"]:
        raise BadCapture(path, "the file", "no line of one bit", "at least one", "dump the lines of the bus")
    ticks = _ticks(head)
    last = max((int(at[-1]) for at, _ in signals if len(at)), default=0)
    if max(last, end or 0) > MOST_POSITION:
        raise BadCapture(
            path, "its times", f"tick {max(last, end or 0)}", f"at most {MOST_POSITION}", "dump a shorter run"
        )
    length = end if end is not None and end > last else last + 1
    if rate is not None:
        refuse_beyond(path, length, ticks or rate, rate)
        lines, last = on_grid(path, [at for at, _ in signals], last, ticks or rate, rate, "a change at tick {}")
        signals = [(at, letters) for at, (_, letters) in zip(lines, signals, strict=True)]
        length = max(last + 1, int(-(-length * rate // (ticks or rate))))
    channels: list[Channel] = []
    for name, width, place in head["variables"]:
        at, letters = signals[place]
        for bit in range(width):
            own = name if width == 1 else f"{name}[{width - 1 - bit}]"
            channels.append(channel_of_states(own, len(channels), at, STATE_OF[letters[:, bit]], length))
    notes = () if end is not None else (NO_END,)
    return Capture(path, rate or ticks, length, tuple(channels), rate is not None, notes)


def _fst_end(head: bytes) -> int | None:
    if len(head) < FST_HEAD.size:
        return None
    block, length, _, end = FST_HEAD.unpack_from(head)
    return int(end) if (block, length) == (0, FST_LENGTH) else None


def _signals(
    path: Path, salvage: bool
) -> tuple[dict[str, Any], list[tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]]]:
    """Read a file in a separate process.

    Return a head with names and timescale, and for each signal the positions of changes and the states after them. A
    state consists of one letter per bit.

    salvage: True to say in the error for a damaged file that no part of it can be read.
    """
    if find_spec("pywellen") is None:
        raise BadCapture(
            path, "the file", "no reader of FST and GHW", "the library pywellen", "pip install 'periph-sim[waves]'"
        )
    command = [sys.executable, "-P", str(READER), str(path.absolute())]
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        raise BadCapture(
            path, "the file", "no end of reading it", f"one within {PATIENCE} s", "dump fewer signals"
        ) from None
    if done.returncode:
        said = ERROR.findall(done.stderr.decode(errors="replace"))
        found = f"an error of its reader ({said[-1] if said else 'aborted'})"
        way_out = "dump it again, or as VCD" + (NO_SALVAGE if salvage else "")
        raise BadCapture(path, "the file", found, "an undamaged waveform of kinds that it knows", way_out)
    first, _, _ = done.stdout.partition(b"\n")
    head = json.loads(first)
    signals = []
    begin = len(first) + 1
    for _ in range(head["signals"]):
        count, width = map(int, np.frombuffer(done.stdout, np.uint64, 2, begin))
        at = np.frombuffer(done.stdout, np.uint64, count, begin + 16)
        letters = np.frombuffer(done.stdout, np.uint8, count * width, begin + 16 + 8 * count).reshape(count, width)
        begin += 16 + (8 + width) * count
        if len(at) and (int(at.max()) > MOST_POSITION or (np.diff(at.astype(np.int64)) < 0).any()):
            raise BadCapture(path, "its times", "a time that falls or is too late", "times that rise", "dump it again")
        signals.append((at.astype(np.int64), letters))
    return head, signals


def _ticks(head: dict[str, Any]) -> Fraction | None:
    """Return the number of ticks per second; None if the file states no timescale."""
    if not head["factor"] or head["exponent"] is None:
        return None
    factor, exponent = int(head["factor"]), int(head["exponent"])
    return Fraction(10**-exponent, factor) if exponent <= 0 else Fraction(1, factor * 10**exponent)


TEXT = 0  # the width of a variable whose values are texts


class Variable(NamedTuple):
    """A variable to be written.

    name: the name with its scopes, such as `dsp.I2C_A.I2CSTR`.
    width: the number of bits, or TEXT.
    changes: pairs of a time and a value in order of time; the first pair is at time 0. A value consists of `width`
        letters 0, 1 or x; if `width` is TEXT, a value is any text.
    """

    name: str
    width: int
    changes: Iterable[tuple[int, str]]


def library() -> Any:
    """Return the module `pylibfst`. Raise ImportError, which says how to install the module, if it is missing."""
    try:
        import pylibfst
    except ImportError:
        raise ImportError("FST is written by pylibfst, which is not installed: pip install 'periph-sim[fst]'") from None
    return pylibfst


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture as FST. Return a note if times were rounded.

    Raise BadCapture if the capture has no rate or a rate that is too high for the format, or if `pylibfst` is missing.
    """
    try:
        library()
    except ImportError as error:
        raise BadCapture(path, "its format", "no library for it", "one", str(error)) from None
    _, per_second, notes = timescale_of(capture)
    names, notes = channel_names(capture), list(notes)
    at, which, states = changes(capture)
    times = rescaled(np.append(at, capture.length), per_second / (capture.rate or per_second))
    variables = []
    for number, name in enumerate(names):
        rows = which == number
        letters = [STATE_LETTERS[state] for state in states[rows].tolist()]
        variables.append(Variable(name, 1, zip(times[:-1][rows].tolist(), letters, strict=True)))
    path.write_bytes(fst_bytes(per_second, variables, int(times[-1])))
    return tuple(notes)


def fst_bytes(per_second: Fraction, variables: Sequence[Variable], end: int) -> bytes:
    """Return the bytes of an FST file with these variables.

    per_second: the number of units of time per second, a power of ten.
    end: the time at which the waveforms end.
    """
    fst = library()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "x.fst"
        _write(fst.lib, fst.ffi.NULL, path, per_second, variables, end)
        return path.read_bytes()


def _write(lib: Any, null: Any, path: Path, per_second: Fraction, variables: Sequence[Variable], end: int) -> None:
    file = lib.fstWriterCreate(str(path).encode(), 1)
    lib.fstWriterSetTimescale(file, 1 - len(str(int(per_second))))
    lib.fstWriterSetDate(file, b"")  # the date is empty, so that equal runs give equal files
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
    """Declare variables and return their handles.

    Scopes are nested in the file, so the variables of a scope are declared together.
    """
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
