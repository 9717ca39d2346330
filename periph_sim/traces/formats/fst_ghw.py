"""FST (GTKWave, Verilator, Icarus) and GHW (GHDL): binary waveforms of simulators, read as edges at integer ticks.

`fst_writer` writes FST.

    file --> a separate process with the library `pywellen` --> positions and states --> Capture

Chosen as for VCD: tick 0 is position 0; `z` is high; states other than 0 and 1 are unknown; a vector is a channel
for each bit, `name[k]` counted from its width (the library does not report declared ranges); reals and strings are
ignored. The end is the last time that an FST file names; GHW has none, so there it is the last change.

VCD is not read this way: the library loses the end of a capture, and declared ranges of vectors.
"""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from ..capture.capture import BadCapture, Capture, Channel, Positions
from ..capture.changes import UNKNOWN
from ..capture.grid import OffGrid
from ..capture.line_states import channel_of_states, quantized
from .fst_writer import write

__all__ = ["NAME", "SUFFIXES", "WRITTEN", "read", "recognises", "write"]

NAME = "FST or GHW waveform"
SUFFIXES = (".fst", ".ghw")
WRITTEN = (".fst",)

FST_HEAD = struct.Struct(">BQQQ")  # block type 0, its length, first and last time
FST_LENGTH = 329
GHW_MARK = b"GHDLwave\n"
READER = Path(__file__).with_name("wellen_worker.py")
PATIENCE = 900  # seconds; the reader itself ends at its limit of processor time
MOST_TICKS = 1 << 62
ERROR = re.compile(r"^(?:[\w.]*(?:Error|Exception)): (.+)$", re.MULTILINE)
NO_END = "the format does not say where the run ends, so the last change is used"

STATE_OF = np.full(256, UNKNOWN, np.uint8)  # by letter
for _letters, _state in ((b"0lL", 0), (b"1hHzZ", 1)):
    STATE_OF[list(_letters)] = _state


def recognises(path: Path, head: bytes) -> bool:
    return head.startswith(GHW_MARK) or _fst_end(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture in ticks of the file, or in samples if `rate` is given. BadCapture for a file with errors."""
    with path.open("rb") as file:
        end = _fst_end(file.read(FST_HEAD.size))
    head, signals = _signals(path)
    if not head["variables"]:
        _bad(path, "the file", "no line of one bit", "at least one", "dump the lines of the bus")
    ticks = _ticks(head)
    last = max((int(at[-1]) for at, _ in signals if len(at)), default=0)
    if max(last, end or 0) > MOST_TICKS:
        _bad(path, "its times", f"tick {max(last, end or 0)}", f"at most {MOST_TICKS}", "dump a shorter run")
    length = end if end is not None and end > last else last + 1
    if rate is not None:
        moments = np.unique(np.concatenate([np.array([last], np.int64), *(at for at, _ in signals)]))
        samples = _samples(path, moments, ticks or rate, rate)
        signals = [(samples[np.searchsorted(moments, at)], letters) for at, letters in signals]
        length = max(int(samples[-1]) + 1, int(-(-length * rate // (ticks or rate))))
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


def _signals(path: Path) -> tuple[dict[str, Any], list[tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]]]:
    """Return (names and timescale, positions and letters of each signal) from the process that reads the file."""
    command = [sys.executable, "-P", str(READER), str(path.absolute())]
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        _bad(path, "the file", "no end of reading it", f"one within {PATIENCE} s", "dump fewer signals")
    if done.returncode:
        said = ERROR.findall(done.stderr.decode(errors="replace"))
        found = f"an error of its reader ({said[-1] if said else 'aborted'})"
        _bad(path, "the file", found, "an undamaged waveform of kinds that it knows", "dump it again, or as VCD")
    first, _, _ = done.stdout.partition(b"\n")
    head = json.loads(first)
    signals = []
    begin = len(first) + 1
    for _ in range(head["signals"]):
        count, width = map(int, np.frombuffer(done.stdout, np.uint64, 2, begin))
        at = np.frombuffer(done.stdout, np.uint64, count, begin + 16)
        letters = np.frombuffer(done.stdout, np.uint8, count * width, begin + 16 + 8 * count).reshape(count, width)
        begin += 16 + (8 + width) * count
        if len(at) and (int(at.max()) > MOST_TICKS or (np.diff(at.astype(np.int64)) < 0).any()):
            _bad(path, "its times", "a time that falls or is too late", "times that rise", "dump it again")
        signals.append((at.astype(np.int64), letters))
    return head, signals


def _ticks(head: dict[str, Any]) -> Fraction | None:
    """Return ticks a second, None if the file does not state them."""
    if not head["factor"] or head["exponent"] is None:
        return None
    factor, exponent = int(head["factor"]), int(head["exponent"])
    return Fraction(10**-exponent, factor) if exponent <= 0 else Fraction(1, factor * 10**exponent)


def _samples(path: Path, moments: Positions, ticks: Fraction, rate: Fraction) -> Positions:
    try:
        return quantized(moments, ticks, rate)
    except OffGrid as off:
        found = f"a change at tick {moments[off.which]}"
        raise BadCapture(
            path, "its times", found, f"times on the grid of {rate} Hz", "state the right rate or none"
        ) from off


def _bad(path: Path, place: str, found: str, expected: str, way_out: str) -> NoReturn:
    raise BadCapture(path, place, found, expected, way_out)
