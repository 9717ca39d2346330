"""Value change dumps (IEEE 1364, four-state), read as edges at integer ticks, and written.

    lines of bytes --> one array of positions and one of states per bit --> Channel

pyvcd's reader is not used: it takes 3.5 times as long, accepts truncated files, and rejects non-ASCII letters in
comments and spaces in channel names, which sigrok's users write. wellen, which reads FST for us, is not used either: it
loses the end of a capture and the declared ranges of vectors, and its errors state no line.

Chosen:
- Tick 0 of the file is position 0. Values before the first `#` are at tick 0. Before its first value, a level is
  unknown.
- `z` is high (a released open-drain line), as is `H`; `L` is low; `x` and the VHDL states U, W and - are unknown.
- Each bit of a vector is a channel, `name[k]`. Reals, strings, events and parameters are ignored.
- A last `#N` without changes after it is the end, so that the length is N positions. Otherwise the last change is at
  the last position.
- With salvage, the changes before an error are kept if at least one variable and one time precede the error.
- Files are written by pyvcd, in the coarsest timescale in which a sample period is a whole number of ticks. Rates such
  as 24 MHz have no such timescale; then times are rounded so finely that a reader that knows the rate gets the same
  samples.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from itertools import count
from pathlib import Path
from typing import IO, NoReturn

import numpy as np

from ..capture.capture import MOST_POSITION, STATE_LETTERS, UNKNOWN, BadCapture, Capture, changes, channel_of_states
from ..capture.sampling import decimals_for, on_grid, rate_text, rescaled
from ..capture.size_limits import MOST_EDGES

SECONDS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}  # number of decimals of a second for each unit
# If a sample period cannot be a whole number of ticks, times are rounded to ticks. A sample period then has at least
# this number of ticks, so that the error of rounding is small.
ROUNDED_TO = 1000
OURS, SCOPE = "periph-sim", "capture"  # the name of the writer in our files, and their scope, which `read` removes


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture. Return notes on rounded times and on names that were changed.

    Raise BadCapture if the capture has no rate, has a rate that is too high, or is too long.
    """
    with path.open("w", encoding="utf-8", newline="\n") as file:
        return write_to(file, capture)


def write_to(file: IO[str], capture: Capture, scope: tuple[str, ...] = (SCOPE,)) -> tuple[str, ...]:
    """Write a capture to an open file. Return notes on rounded times and on names that were changed.

    scope: the names of the nested scopes in which all variables are declared, the outermost first.

    Raise BadCapture as `write` does.
    """
    from vcd import VCDWriter

    scale, per_second, notes = timescale_of(capture)
    at, which, states = changes(capture)
    names = channel_names(capture)
    renamed = [f"{c.name!r} {name}" for c, name in zip(capture.channels, names, strict=True) if c.name != name]
    if renamed:
        notes.append(f"names that VCD cannot hold were changed: {', '.join(renamed)}")
    first = len(names)
    times = rescaled(np.append(at, capture.length), per_second / (capture.rate or per_second)).tolist()
    if times[-1] > MOST_POSITION:
        raise BadCapture(
            Path(file.name), "its length", f"{times[-1]} ticks of {scale}", f"at most {MOST_POSITION}", "cut a window"
        )
    with VCDWriter(file, timescale=scale, date="", version=OURS) as writer:
        lines = [
            writer.register_var((*scope, *scopes), name, "wire", size=1, init=STATE_LETTERS[state])
            for (*scopes, name), state in zip((name.split(".") for name in names), states.tolist(), strict=False)
        ]
        rows = zip(times[first:-1], which[first:].tolist(), states[first:].tolist(), strict=True)
        for time, line, state in rows:
            writer.change(lines[line], time, STATE_LETTERS[state])
        writer.close(times[-1])
    return tuple(notes)


def timescale_of(capture: Capture) -> tuple[str, Fraction, list[str]]:
    """Return the timescale, such as `10 ns`, its ticks per second, and a list with a note if times must be rounded.

    Raise BadCapture if the capture has no rate, or a rate that is too high.
    """
    decimals, exact = decimals_for(capture, 0, ROUNDED_TO, ", or a whole number of femtoseconds a sample")
    unit, size = next((unit, size) for unit, size in SECONDS.items() if size >= decimals)
    scale = f"{10 ** (size - decimals)} {unit}"
    if exact:
        return scale, Fraction(10**decimals), []
    assert capture.rate is not None
    said = f"a sample of {rate_text(capture.rate)} is no whole number of ticks, so times are rounded to {scale}; "
    return scale, Fraction(10**decimals), [said + "a reader that uses that rate gets the same samples"]


def channel_names(capture: Capture) -> list[str]:
    """Return names that VCD can hold, in the order of the channels.

    A series of blanks, and a `$` at the beginning of a part, are replaced by `_`. A name with an empty part between
    dots is replaced by `channel_` and the index. If several names are equal, numbers are appended to all except the
    first.
    """
    names: list[str] = []
    for channel in capture.channels:
        parts = [re.sub(r"\s+|^\$", "_", part.strip()) for part in channel.name.split(".")]
        name = ".".join(parts) if all(parts) else f"channel_{channel.index}"
        same = (f"{name}_{number}" for number in count(2))
        names.append(name if name not in names else next(other for other in same if other not in names))
    return names


NAME = "value change dump (.vcd)"
SUFFIXES = (".vcd",)

STATES = {
    ord(letter): state for letters, state in (("0lL", 0), ("1hHzZ", 1), ("xXuUwW-", UNKNOWN)) for letter in letters
}
TIME, COMMAND = ord("#"), ord("$")
NO_LEVELS = {"parameter", "real", "realtime", "real_parameter", "string", "event", "time"}
WIDEST = 1024  # maximum number of bits of a vector
MOST_LINES = 1 << 18  # maximum number of bits of all declared variables
LONGEST = 1 << 20  # maximum number of bytes of a line


Line = tuple["array[int]", bytearray]  # positions and states of one scalar or one bit of a vector


def recognises(path: Path, head: bytes) -> bool:
    return re.match(rb"\s*\$(date|version|timescale|comment|scope|var)\b", head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture in ticks of the file's timescale, or in samples of `rate` if it is given.

    salvage: True to keep the changes before an error. A note of the capture says what was left out.

    Raise BadCapture with the line of an error.
    """
    with path.open("rb") as file:
        lines = iter(partial(file.readline, LONGEST), b"")
        return _Reader(path, lines, salvage).read(rate)


class _Reader:
    def __init__(self, path: Path, lines: Iterator[bytes], salvage: bool) -> None:
        self._path = path
        self._numbered = enumerate(lines, 1)
        self._salvage = salvage
        self._notes: tuple[str, ...] = ()
        self._words: list[bytes] = []  # the remaining words of the line in reverse order
        self._per_second: Fraction | None = None
        self._scopes: list[str] = []
        self._ours = False
        self._names: list[tuple[str, Line]] = []
        self._lines: dict[bytes, list[Line]] = {}  # maps each identifier to its bits, most significant bit first
        self._now = 0
        self._timed = False  # True if a time (`#`) was read
        self._moved = False  # True if a change was read after the last time

    def read(self, rate: Fraction | None) -> Capture:
        try:
            self._parse()
        except BadCapture as error:
            if not self._salvage or not self._names or not self._timed:
                raise
            self._notes = (f"read up to tick {self._now}: {str(error).removeprefix(f'{self._path}, ')}",)
        if not self._names:
            self._bad(0, "no one-bit variable", "at least one", "dump the lines of the bus")
        if not self._timed:
            self._bad(0, "no time", "changes after a #", "dump a run")
        return self._capture(rate)

    def _parse(self) -> None:
        changes = 0  # an upper bound of the number of changes so far
        for number, text in self._numbered:
            if len(text) == LONGEST and not text.endswith(b"\n"):
                self._bad(number, f"a line of more than {LONGEST} bytes", "shorter ones", "write the dump again")
            words = text.split()
            self._words = words[::-1]
            while self._words:
                self._word(number, self._words.pop())
            changes += len(words)
            if changes > MOST_EDGES:
                self._bad(number, f"more than {MOST_EDGES} changes", "a shorter run", "dump fewer lines")

    def _word(self, number: int, word: bytes) -> None:
        first = word[0]
        if first == TIME:
            self._time(number, word)
        elif first in STATES:  # some writers put a blank before the identifier
            self._change(number, word[1:] or self._next(number, word), word[:1])
        elif first in b"bB":
            self._change(number, self._next(number, word), word[1:])
        elif first in b"rRsS":
            self._next(number, word)
        elif first == COMMAND:
            self._command(number, _text(word))
        else:
            self._bad(number, repr(_text(word)), "a time, a change or a $ command", "write the dump again")

    def _command(self, number: int, word: str) -> None:
        if word in ("$dumpvars", "$dumpall", "$dumpon", "$dumpoff", "$end"):
            return
        body = []
        while (item := self._next(number, word.encode())) != b"$end":
            body.append(_text(item))
        if word == "$timescale":
            self._timescale(number, "".join(body))
        elif word == "$version":
            self._ours = body == [OURS]
        elif word == "$scope":
            self._scopes.append(body[-1] if body else "")
        elif word == "$upscope" and self._scopes:
            self._scopes.pop()
        elif word == "$var":
            self._var(number, body)

    def _timescale(self, number: int, text: str) -> None:
        match = re.fullmatch(r"(1|10|100)([munpf]?s)", text)
        if not match:
            self._bad(number, f"timescale {text!r}", "1, 10 or 100 of s, ms, us, ns, ps or fs", "mend it")
        else:
            self._per_second = Fraction(10 ** SECONDS[match[2]], int(match[1]))

    def _var(self, number: int, body: list[str]) -> None:
        if len(body) < 4 or not re.fullmatch(r"\d{1,4}", body[1]) or int(body[1]) > WIDEST:
            self._bad(number, f"$var {' '.join(body)}", f"type, width (to {WIDEST}), identifier and name", "mend it")
        kind, width, code = body[0], int(body[1]), body[2].encode()
        name = re.sub(r"\s+(\[-?\d+\])$", r"\1", " ".join(body[3:]))
        if kind in NO_LEVELS or not width:
            self._lines.setdefault(code, [])
            return
        if len(self._names) + width > MOST_LINES:
            self._bad(number, f"more than {MOST_LINES} bits", "fewer lines", "dump the lines of the bus only")
        lines = self._lines.setdefault(code, [(array("q"), bytearray()) for _ in range(width)])
        if len(lines) != width:
            self._bad(number, f"{width} bits for identifier {body[2]!r}", f"{len(lines)} as before", "mend it")
        scopes = self._scopes[1:] if self._ours and self._scopes[:1] == [SCOPE] else self._scopes
        scoped = ".".join([*filter(None, scopes), name])
        if width == 1:
            self._names.append((scoped, lines[0]))
            return
        match = re.search(r"\s*\[\s*(-?\d{1,9})\s*:\s*(-?\d{1,9})\s*\]$", scoped)
        msb, lsb = (int(match[1]), int(match[2])) if match else (width - 1, 0)
        stem = scoped[: match.start()] if match else scoped
        step = 1 if lsb >= msb else -1
        self._names.extend((f"{stem}[{msb + step * k}]", line) for k, line in enumerate(lines))

    def _time(self, number: int, word: bytes) -> None:
        digits = word[1:]
        now = int(digits) if digits.isdigit() and len(digits) < 20 else -1
        if not 0 <= now <= MOST_POSITION:
            found = repr(_text(word))
            self._bad(number, found, f"# and a number of ticks to {MOST_POSITION}", "write the dump again")
        if self._timed and now < self._now:
            self._bad(number, f"time {now} after {self._now}", "times that rise", "write the dump again")
        if not self._timed or now > self._now:  # values before the first `#` are at tick 0
            self._timed = True
            self._now = now
            self._moved = False

    def _change(self, number: int, code: bytes, value: bytes) -> None:
        if code not in self._lines:
            found = f"a change of {_text(code)!r}"
            self._bad(number, found, "an identifier that a $var declares", "write the dump again")
        bits = self._lines[code]
        if not bits:
            return
        if len(value) < len(bits):
            value = value.rjust(len(bits), value[:1] if value[:1] in (b"x", b"X", b"z", b"Z") else b"0")
        if len(value) != len(bits) or any(letter not in STATES for letter in value):
            found = f"value {_text(value)!r}"
            self._bad(number, found, f"{len(bits)} of the states 0, 1, x and z", "write the dump again")
        for (at, states), letter in zip(bits, value, strict=True):
            at.append(self._now)
            states.append(STATES[letter])
        self._moved = True

    def _next(self, number: int, after: bytes) -> bytes:
        while not self._words:
            item = next(self._numbered, None)
            if item is None:
                found = f"the end of the file after {_text(after)!r}"
                self._bad(number, found, "the rest of it", "copy the file again")
            self._words = item[1].split()[::-1]
        return self._words.pop()

    def _capture(self, rate: Fraction | None) -> Capture:
        ticks = self._per_second
        length = self._now + 1 if self._moved or self._now == 0 else self._now
        lines = [np.array(at, np.int64) for _, (at, _) in self._names]
        if rate is not None:
            lines, last = on_grid(self._path, lines, self._now, ticks or rate, rate, "a change at #{}")
            length = last + (1 if length > self._now else 0)
        channels = tuple(
            channel_of_states(name, index, at, np.frombuffer(states, np.uint8), length)
            for index, (at, (name, (_, states))) in enumerate(zip(lines, self._names, strict=True))
        )
        return Capture(self._path, rate or ticks, length, channels, rate is not None, self._notes)

    def _bad(self, number: int, found: str, expected: str, way_out: str) -> NoReturn:
        raise BadCapture(self._path, f"line {number}" if number else "the file", found, expected, way_out)


def _text(word: bytes) -> str:
    return word.decode(errors="replace")
