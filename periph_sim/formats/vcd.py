"""Value change dumps (IEEE 1364, four-state): text in, edges at integer ticks out.

Read by words and not with pyvcd's reader, which goes byte by byte, refuses the spaces that sigrok's
users put into channel names and the non-ASCII letters in comments, and takes a file cut short for whole.

Chosen:
- Tick 0 of the file is position 0; before the first `#` levels are unknown, unless values precede it.
- `z` is high (an open-drain line let go); `x` and the VHDL states that say neither 0 nor 1 are unknown.
- A vector is a channel a bit, `name[k]`. Reals, strings, events and parameters are left out.
- A last `#N` with nothing behind it is the end: N positions. Else the last change is the last position.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import NoReturn

from .capture import BadCapture, Capture, channel_of
from .grid import OffGrid, snap

NAME = "value change dump (.vcd)"
SUFFIXES = (".vcd",)

LEVELS: dict[str, int | None] = {"0": 0, "1": 1, "l": 0, "h": 1, "z": 1, "x": None, "u": None, "w": None, "-": None}
SECONDS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}
NO_LEVELS = {"parameter", "real", "realtime", "real_parameter", "string", "event", "time"}
MOST_TICKS = 1 << 62
WIDEST = 1024  # bits of a vector


@dataclass
class Line:
    """The states of one scalar or one bit of a vector."""

    at: list[int] = field(default_factory=list)
    levels: list[int | None] = field(default_factory=list)


def recognises(path: Path, head: bytes) -> bool:
    return re.match(rb"\s*\$(date|version|timescale|comment|scope|var)\b", head) is not None


def read(path: Path, rate: Fraction | None = None) -> Capture:
    """The capture in ticks of the file's timescale, or in samples where `rate` is given."""
    with path.open(encoding="utf-8", errors="replace") as file:
        return _Reader(path).read(_words(file), rate)


def _words(lines: Iterator[str]) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(lines, 1):
        for word in line.split():
            yield number, word


class _Reader:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._per_second: Fraction | None = None
        self._scopes: list[str] = []
        self._names: list[tuple[str, Line]] = []
        self._lines: dict[str, list[Line]] = {}  # identifier -> its bits, most significant first
        self._now = 0
        self._timed = False  # a `#` has come
        self._moved = False  # a change has come since

    def read(self, words: Iterator[tuple[int, str]], rate: Fraction | None) -> Capture:
        for number, word in words:
            first = word[0]
            if first == "#":
                self._time(number, word)
            elif first in "01xXzZuUwWlLhH-":
                self._change(number, word[1:], first)
            elif first in "bB":
                self._change(number, self._next(words, number, word), word[1:])
            elif first in "rRsS":
                self._next(words, number, word)
            elif first == "$":
                self._command(number, word, words)
            else:
                self._bad(number, repr(word), "a time, a change or a $ command", "write the dump again")
        if not self._names:
            self._bad(0, "no one-bit variable", "at least one", "dump the lines of the bus")
        if not self._timed:
            self._bad(0, "no time", "changes after a #", "dump a run")
        return self._capture(rate)

    def _command(self, number: int, word: str, words: Iterator[tuple[int, str]]) -> None:
        if word in ("$dumpvars", "$dumpall", "$dumpon", "$dumpoff", "$end"):
            return
        body = []
        while (item := self._next(words, number, word)) != "$end":
            body.append(item)
        if word == "$timescale":
            self._timescale(number, "".join(body))
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
        if len(body) < 4 or not re.fullmatch(r"\d{1,4}", body[1]) or not 0 < int(body[1]) <= WIDEST:
            self._bad(number, f"$var {' '.join(body)}", f"type, width (to {WIDEST}), identifier and name", "mend it")
        kind, width, code = body[0], int(body[1]), body[2]
        name = " ".join(body[3:])
        if kind in NO_LEVELS:
            self._lines.setdefault(code, [])
            return
        lines = self._lines.setdefault(code, [Line() for _ in range(width)])
        if len(lines) != width:
            self._bad(number, f"{width} bits for identifier {code!r}", f"{len(lines)} as before", "mend it")
        scoped = ".".join([*filter(None, self._scopes), name])
        if width == 1:
            self._names.append((scoped, lines[0]))
            return
        match = re.search(r"\s*\[\s*(-?\d+)\s*:\s*(-?\d+)\s*\]$", scoped)
        msb, lsb = (int(match[1]), int(match[2])) if match else (width - 1, 0)
        stem = scoped[: match.start()] if match else scoped
        step = 1 if lsb >= msb else -1
        self._names.extend((f"{stem}[{msb + step * k}]", line) for k, line in enumerate(lines))

    def _time(self, number: int, word: str) -> None:
        if not word[1:].isdecimal() or len(word) > 20 or int(word[1:]) > MOST_TICKS:
            self._bad(number, repr(word), f"# and a number of ticks to {MOST_TICKS}", "write the dump again")
        now = int(word[1:])
        if self._timed and now < self._now:
            self._bad(number, f"time {now} after {self._now}", "times that rise", "write the dump again")
        if not self._timed:  # values before the first # hold from the start
            self._timed = True
        elif now == self._now:
            return
        self._now = now
        self._moved = False

    def _change(self, number: int, code: str, value: str) -> None:
        if code not in self._lines:
            self._bad(number, f"a change of {code!r}", "an identifier that a $var declares", "write the dump again")
        bits = self._lines[code]
        if not bits:
            return
        value = value.lower()
        lead = value[:1] if value[:1] in ("x", "z") else "0"
        value = value.rjust(len(bits), lead)
        if len(value) != len(bits) or any(c not in LEVELS for c in value):
            self._bad(number, f"value {value!r}", f"{len(bits)} of the states 0, 1, x and z", "write the dump again")
        for line, state in zip(bits, value, strict=True):
            line.at.append(self._now)
            line.levels.append(LEVELS[state])
        self._moved = True

    def _next(self, words: Iterator[tuple[int, str]], number: int, after: str) -> str:
        item = next(words, None)
        if item is None:
            self._bad(number, f"the end of the file after {after!r}", "the rest of it", "copy the file again")
        return item[1]

    def _capture(self, rate: Fraction | None) -> Capture:
        ticks = self._per_second
        length = self._now + 1 if self._moved or self._now == 0 else self._now
        sampled = False
        moments = sorted({at for _, line in self._names for at in line.at} | {self._now})
        place = {at: at for at in moments}
        if rate is not None:
            try:
                samples = snap(moments, ticks or rate, rate)
            except OffGrid as off:
                found = f"a change at #{moments[off.which]}"
                raise BadCapture(
                    self._path, "its times", found, f"times on the grid of {rate} Hz", "state the right rate or none"
                ) from off
            place = dict(zip(moments, samples, strict=True))
            length = place[self._now] + (1 if length > self._now else 0)
            sampled = True
        channels = tuple(
            channel_of(name, index, [place[at] for at in line.at], line.levels, length)
            for index, (name, line) in enumerate(self._names)
        )
        return Capture(self._path, rate or ticks, length, channels, sampled)

    def _bad(self, number: int, found: str, expected: str, way_out: str) -> NoReturn:
        raise BadCapture(self._path, f"line {number}" if number else "the file", found, expected, way_out)
