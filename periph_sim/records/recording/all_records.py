"""Formats that contain every record of a run, .psr and .jsonl."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import IO

from ...core.records import Kind, Record
from ...core.time import Timebase
from ...traces.formats.psr import write_table
from ...traces.formats.record_table import Clocks, Columns
from ..record_text import bus_byte, on_the_bus
from . import RecordingWriter

VERSION = 2  # version of the .jsonl format


class PsrWriter(RecordingWriter):
    """Writer of .psr: the whole run in a zip file, as one typed array for each column.

    `traces/formats/psr.py` describes the layout. The arrays are kept in memory, 44 bytes per record, and written when
    the run is over.
    """

    SUFFIX, MODE = ".psr", "wb"

    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        super().__init__(file, timebase, modules)
        self._modules = modules
        self._columns = self.sink = Columns()
        self.write = self._columns.add

    def close(self, now: int, clocks: Clocks) -> None:
        write_table(self._columns.table(Fraction(self._per_second), now, self._modules, clocks), self._file)


class JsonlWriter(RecordingWriter):
    """Writer of .jsonl: one JSON array per line with number, tick, kind, where, what, value, text, cause and field.

    The first line is an object with the version, the number of ticks per second and the names of the columns. The value
    of a record is a number, except in BUS and FRAME records:

        BUS address                 "0x21 R ACK"
        BUS byte                    "0x11 ACK"
        FRAME byte, end, error      "0x55"
        FRAME cut, collision        "cut", "collision"
        all others, such as START   null
    """

    SUFFIX = ".jsonl"

    def __init__(self, file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        super().__init__(file, timebase, modules)
        head = {"periph-sim": VERSION, "ticks_per_second": timebase.per_second, "columns": list(Record._fields)}
        file.write(json.dumps(head) + "\n")

    def write(self, record: Record) -> None:
        row = (record.number, record.tick, record.kind.value, record.where, record.what, _value(record), *record[6:])
        self._file.write(json.dumps(row) + "\n")


FORMATS = (PsrWriter, JsonlWriter)


def _value(record: Record) -> int | str | None:
    if record.kind is Kind.FRAME:
        return None if record.what == "begin" else on_the_bus(record)
    if record.kind is not Kind.BUS:
        return record.value
    carried = bus_byte(record)
    return None if carried is None else str(carried)
