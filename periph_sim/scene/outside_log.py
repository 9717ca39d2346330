"""The log of a session: a file goes in; what the outside did, instant by instant, comes out.

{"format": "periph-sim outside", "version": 1, "case": ..., "ticks_per_second": ..., "wires": [...],
 "file": ..., "set": [...],             the case's file, from the log's folder, and its changes; if it has one
 "controller": false}                   that file's [controller] gave way
[tick, {"SCL": 0}]                      of each instant, in order
{"end": tick, "sci_bytes": count}       the session was finished there; without it, the last instant is the end
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

FORMAT, VERSION = "periph-sim outside", 1


class BadLog(ValueError):
    """A file that is none of these logs, or is damaged, in one sentence with its line."""


@dataclass(frozen=True)
class Head:
    """What a log is of. file: of the case, from the log's folder; "" if it came from none. changes: of it.

    controller: whether the case had one, if its file has.
    """

    case: str
    ticks_per_second: int
    wires: tuple[str, ...]
    file: str = ""
    changes: tuple[str, ...] = ()
    controller: bool = True


class LogReader:
    """BadLog for a file that is none of these logs or is damaged."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.end = -1  # known once all instants were read, as is the next one
        self.sci_bytes = 0  # that the session sent to SCIs
        try:
            self._file = path.open(encoding="utf-8")
            first = self._file.readline(1 << 20)
        except OSError as error:
            raise BadLog(f"{path}: {error.strerror}; give the log of a session") from None
        except UnicodeDecodeError:
            raise self._bad(1, "it is no text", "the log of a session") from None
        self.head = self._head(first)

    def close(self) -> None:
        self._file.close()

    def instants(self) -> Iterator[tuple[int, dict[str, int]]]:
        """In order of time. `end` is set behind the last."""
        last, number = -1, 1
        with self._file:
            while True:
                number += 1
                value = self._line(number)
                if value is None:
                    break
                if self.end >= 0:
                    raise self._bad(number, "something behind the end", "nothing more")
                if isinstance(value, dict) and isinstance(value.get("end"), int) and value["end"] >= last:
                    self.end = value["end"]
                    count = value.get("sci_bytes")
                    self.sci_bytes = count if isinstance(count, int) else 0
                    continue
                if not (
                    isinstance(value, list)
                    and len(value) == 2
                    and isinstance(value[0], int)
                    and isinstance(value[1], dict)
                ):
                    raise self._bad(number, json.dumps(value), 'an instant, [tick, {"SCL": 0}], or {"end": tick}')
                if value[0] <= last:
                    raise self._bad(number, f"tick {value[0]} behind tick {last}", "instants in order of time")
                last = value[0]
                yield last, value[1]
        if self.end < 0:
            self.end = last + 1

    def _line(self, number: int) -> object:
        """The next value; None at the end. Half a line there is what a process that died had begun to write."""
        try:
            text = self._file.readline()
            return json.loads(text) if text.endswith("\n") else None
        except (json.JSONDecodeError, UnicodeDecodeError, RecursionError):
            raise self._bad(number, "a damaged line", "JSON") from None

    def _head(self, text: str) -> Head:
        try:
            value = json.loads(text)
        except (json.JSONDecodeError, RecursionError):
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
            value.get("controller") is not False,
        )

    def _bad(self, line: int, found: str, expected: str) -> BadLog:
        return BadLog(f"{self._path}, line {line}: found {found[:80]}, expected {expected}")
