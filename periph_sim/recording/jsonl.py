"""Our own records, one JSON array a line: number, tick, kind, where, what, value, text, cause.

The first line says the version and how many ticks a second has.
"""

from __future__ import annotations

import json
from typing import IO, Literal

from ..core.records import Kind, Record
from ..core.time import Timebase

SUFFIX = ".jsonl"
MODE: Literal["w"] = "w"
KINDS = tuple(Kind)
VERSION = 1


class JsonlWriter:
    def __init__(self, file: IO[str], timebase: Timebase) -> None:
        self._file = file
        head = {"periph-sim": VERSION, "ticks_per_second": timebase.per_second, "columns": list(Record._fields)}
        file.write(json.dumps(head) + "\n")

    def write(self, record: Record) -> None:
        row = (record.number, record.tick, record.kind.value, *record[3:])
        self._file.write(json.dumps(row) + "\n")

    def close(self, now: int) -> None:
        """Nothing is left to write."""


def open_writer(file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> JsonlWriter:
    return JsonlWriter(file, timebase)
