"""The log of a session, in which an outside party drives wires of a scene (`periph_sim.outside`).

For each instant, the log has the new levels of these wires, and the wires on which a byte begins. Each line is a JSON
value; the first line is the head of the log. `tick` counts from the start of the session.

{"format": "periph-sim outside", "version": 1, "case": ..., "ticks_per_second": ..., "wires": [...],
 "file": ..., "set": [...]}             if the case has a file: the path of the file, relative to the log's folder, and
                                        the `key=value` changes that were applied to the case
{"serial": "RX"}                        from the next instant on, the outside party sends bytes on this wire
[tick, {"SCL": 0}, ["RX"]]              an instant: new levels of wires; wires on which a byte begins, if there are any
{"end": tick}                           the end of the session; if missing, the end is one tick after the last instant
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from io import TextIOWrapper
from pathlib import Path
from typing import NamedTuple

import msgspec

from ..core.agent import Agent
from ..core.input_files import open_input
from ..core.kernel import Kernel
from ..core.phrases import counted, did_you_mean
from ..core.wire import Wire
from .context import SceneContext

FORMAT, VERSION = "periph-sim outside", 1
LONGEST_LINE = 1 << 20  # a line with this number of characters or more is rejected


class BadLog(ValueError):
    """Error: a file is not the log of a session, cannot be read, is damaged, or does not fit the case.

    The message is one sentence, with the line if a line is wrong.
    """


@dataclass(frozen=True)
class Head:
    """The first line of a log.

    file: the path of the case, relative to the folder of the log; "" if the case has no file.
    changes: the `key=value` texts that were applied to the case.
    """

    case: str
    ticks_per_second: int
    wires: tuple[str, ...]
    file: str = ""
    changes: tuple[str, ...] = ()


class Instant(NamedTuple):
    """The changes at one tick.

    levels: the new levels of the wires that the outside party changes.
    sent: a dictionary from a wire to the number of bytes that begin on the wire. The number 0 means that the outside
        party sends bytes on this wire from this tick on, but that none of them begins at this tick.
    """

    tick: int
    levels: dict[str, int]
    sent: Mapping[str, int]


class LogReader:
    """Reader of a session's log.

    The constructor and `instants` raise BadLog if the file is not the log of a session, or is damaged. The constructor
    raises it also if the file cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.end = -1  # the tick at which the log ends; -1 until all instants were read
        self.finished = False  # True if the log contains the end of the session
        self._lines = 1  # number of lines read so far
        self._cut = 0  # number of characters of an incomplete last line
        try:
            self._file = TextIOWrapper(open_input(path), encoding="utf-8")
            first = self._file.readline(LONGEST_LINE)
        except OSError as error:
            raise BadLog(f"{path}: {error.strerror}; give the log of a session") from None
        except UnicodeDecodeError:
            raise self._bad(1, "it is no text", "the log of a session") from None
        self.head = self._head(first)

    def close(self) -> None:
        self._file.close()

    @property
    def unfinished(self) -> str:
        """A sentence that says what is missing at the end of the log; "" if nothing is missing.

        Valid after all instants were read.
        """
        if self.finished:
            return ""
        cut = f", and of the line after it only {counted(self._cut, 'character')} remain" if self._cut else ""
        return (
            f"{self._path} has no end: its session was ended before it was finished, so the replay ends with line "
            f"{self._lines} of the log{cut}"
        )

    def instants(self) -> Iterator[Instant]:
        """Yield the instants in order of time, then set `end`.

        Raise BadLog for a wrong line, or if the log has neither an instant nor an end.
        """
        last, sent = -1, dict[str, int]()
        with self._file:
            while (value := self._line()) is not None:
                if self.finished:
                    raise self._bad(self._lines, "something after the end", "nothing more")
                if isinstance(value, dict) and isinstance(value.get("end"), int) and value["end"] >= last:
                    self.end, self.finished = value["end"], True
                elif isinstance(value, dict) and value.get("serial") in self.head.wires:
                    sent[value["serial"]] = 0
                else:
                    instant = self._instant(value, last)
                    last = instant.tick
                    yield instant._replace(sent={**sent, **instant.sent})
                    sent = {}
        if self.end < 0:
            self.end = last + 1
        if not self.end and not self.finished:
            raise self._bad(
                self._lines + 1, "nothing after the head", "what a session did; it ended before any time passed"
            )

    def _instant(self, value: object, last: int) -> Instant:
        """Return the instant in a line. Raise BadLog if the line is wrong or the instant is not after tick `last`."""
        try:
            tick, levels, begun = msgspec.convert(value, tuple[int, dict[str, int], list[str]])
        except msgspec.ValidationError:
            try:
                (tick, levels), begun = msgspec.convert(value, tuple[int, dict[str, int]]), []
            except msgspec.ValidationError:
                found, expected = json.dumps(value), 'an instant, [tick, {"SCL": 0}], or {"end": tick}'
                raise self._bad(self._lines, found, expected) from None
        if tick <= last:
            raise self._bad(self._lines, f"tick {tick} behind tick {last}", "instants in order of time")
        for name, level in levels.items():
            if name not in self.head.wires or level not in (0, 1):
                raise self._bad(self._lines, f"{name!r}: {level!r}", f"0 or 1 of {' or '.join(self.head.wires)}")
        if strange := [wire for wire in begun if wire not in self.head.wires]:
            raise self._bad(self._lines, f"a byte on {strange[0]!r}", f"one of {' or '.join(self.head.wires)}")
        return Instant(tick, levels, dict.fromkeys(begun, 1))

    def _line(self) -> object:
        """Return the JSON value in the next line; None at the end of the file, and for an incomplete last line."""
        try:
            text = self._file.readline(LONGEST_LINE)
            if len(text) == LONGEST_LINE:
                raise ValueError
            if not text.endswith("\n"):
                self._cut = len(text)
                return None
            value: object = json.loads(text)
        except (ValueError, RecursionError):
            # The line is not JSON, is not UTF-8, is too long, or has a number with more digits than Python accepts.
            raise self._bad(self._lines + 1, "a damaged line", "JSON") from None
        self._lines += 1
        return value

    def _head(self, text: str) -> Head:
        try:
            value = json.loads(text)
        except (ValueError, RecursionError):
            value = None
        if not isinstance(value, dict) or value.get("format") != FORMAT:
            raise self._bad(1, "no head", "the log of a session")
        if value.get("version") != VERSION:
            raise self._bad(1, f"version {value.get('version')!r}", f"version {VERSION}")
        case, per_second, wires = value.get("case"), value.get("ticks_per_second"), value.get("wires")
        if not (isinstance(case, str) and isinstance(per_second, int) and isinstance(wires, list)):
            raise self._bad(1, "a head without case, ticks_per_second and wires", "the log of a session")
        file, changes = value.get("file"), value.get("set")
        return Head(
            case,
            per_second,
            tuple(str(wire) for wire in wires),
            file if isinstance(file, str) else "",
            tuple(str(change) for change in changes) if isinstance(changes, list) else (),
        )

    def _bad(self, line: int, found: str, expected: str) -> BadLog:
        return BadLog(f"{self._path}, line {line}: found {found[:80]}, expected {expected}")


WHO = "outside"  # name of the party in records and in messages about who holds a line


class LoggedOutside(Agent):
    """Outside party that drives the wires as recorded in the log of a session.

    start: the tick of the scene that corresponds to tick 0 of the log.
    on_sent: a callback that receives a wire and a number of bytes, as in `Instant.sent`.
    unfinished: a sentence that says what is missing at the end of the log; "" if nothing is missing.
    """

    def __init__(self, kernel: Kernel, wires: Mapping[str, Wire], path: Path, start: int) -> None:
        self._kernel = kernel
        self._pins = {name: wire.attach(WHO) for name, wire in wires.items()}
        self._start = start
        self._reader = LogReader(path)
        self._instants: Iterator[Instant] = self._reader.instants()
        self._next: Instant | None = None
        self.on_sent: Callable[[str, int], None] = lambda wire, count: None
        self.unfinished = ""
        self._plan()

    def act(self, tag: int) -> None:
        assert self._next is not None
        for wire, count in self._next.sent.items():
            self.on_sent(wire, count)
        for name, level in self._next.levels.items():
            self._pins[name].drive(level)
        self._plan()

    def _plan(self) -> None:
        self._next = next(self._instants, None)
        if self._next is not None:
            self._kernel.schedule(self._start + self._next.tick, self)
        else:
            self._reader.close()


def logged_outside(context: SceneContext, wires: Mapping[str, Wire]) -> LoggedOutside:
    """Return the agent that replays the log of [outside].

    Raise BadCase if the log is unreadable or damaged, drives a wire that is not in [outside], or has another number of
    ticks per second than the case.
    """
    case, ticks_per_second = context.case, context.timebase.per_second
    assert case.outside is not None and case.outside.log is not None
    path = case.folder / case.outside.log
    try:
        reader = LogReader(path)
        reader.close()
        if reader.head.ticks_per_second != ticks_per_second:
            found = f"has {reader.head.ticks_per_second} ticks a second, and this case {ticks_per_second}"
            raise BadLog(f"{path}: it {found}; replay it with the case it is of")
        for name in reader.head.wires:
            if name not in case.outside.wires:
                raise BadLog(f"{path}: it moves {name}; {did_you_mean(name, case.outside.wires)}")
        status = path.stat()
        unfinished = _checked(path, status.st_mtime_ns, status.st_size)
    except BadLog as error:
        raise case.mistake(str(error), "outside", "log") from None
    logged = LoggedOutside(context.kernel, {name: wires[name] for name in reader.head.wires}, path, context.start)
    logged.unfinished = unfinished
    return logged


@lru_cache(maxsize=16)
def _checked(path: Path, written: int, size: int) -> str:
    """Return a sentence that says what is missing at the end of a log, or "". Raise BadLog if the log is damaged.

    written, size: the modification time and the size of the file. If they have changed since an earlier call, the file
        is read again; otherwise the result comes from a cache.
    """
    reader = LogReader(path)
    for _ in reader.instants():
        pass
    return reader.unfinished
