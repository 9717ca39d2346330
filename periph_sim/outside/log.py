"""What the outside did, as a file: each instant goes in as it passes; a run that does it again comes out.

{"format": "periph-sim outside", "version": 1, "case": ..., "ticks_per_second": ..., "wires": [...]}
[tick, {"SCL": 0}]      of each instant, in order
{"end": tick}           the session was finished there; without it, the last instant is the end
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from .errors import OutsideError

FORMAT, VERSION = "periph-sim outside", 1


class LogWriter:
    """Each line is written as it is known, so that what was live is there whatever ends the process."""

    def __init__(self, path: Path, case: str, ticks_per_second: int, wires: tuple[str, ...]) -> None:
        try:
            self._file: TextIO = path.open("w", encoding="utf-8", newline="\n")
        except OSError as error:
            raise OutsideError(f"{path}: {error.strerror}; give the log another place") from None
        self._write(
            {"format": FORMAT, "version": VERSION, "case": case, "ticks_per_second": ticks_per_second, "wires": wires}
        )

    def instant(self, tick: int, levels: Mapping[str, int]) -> None:
        self._write([tick, dict(sorted(levels.items()))])

    def end(self, tick: int) -> None:
        self._write({"end": tick})
        self._file.close()

    def close(self) -> None:
        """Without an end: the session was not finished."""
        self._file.close()

    def _write(self, value: object) -> None:
        self._file.write(json.dumps(value) + "\n")
        self._file.flush()


@dataclass(frozen=True)
class Head:
    """What a log is of."""

    case: str
    ticks_per_second: int
    wires: tuple[str, ...]


class LogReader:
    """OutsideError, with the line, for a file that is none of these logs or is damaged."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.end = -1  # known once all instants were read
        try:
            self._file = path.open(encoding="utf-8")
            first = self._file.readline(1 << 20)
        except OSError as error:
            raise OutsideError(f"{path}: {error.strerror}; give the log of a session") from None
        except UnicodeDecodeError:
            raise self._bad(1, "it is no text", "the log of a session") from None
        self.head = self._head(first)

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
        return Head(case, per_second, tuple(str(wire) for wire in wires))

    def _bad(self, line: int, found: str, expected: str) -> OutsideError:
        return OutsideError(f"{self._path}, line {line}: found {found[:80]}, expected {expected}")
