"""Formats that hold every record of a run, .psr and .jsonl."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import IO

from ...core.records import Kind, Record
from ...core.time import Timebase
from ...traces.formats.psr import write_table
from ...traces.formats.record_table import Columns
from ..record_text import bus_byte, on_the_bus
from . import RecordingWriter

VERSION = 2  # of .jsonl


class PsrWriter(RecordingWriter):
    """Records by column: the whole run as typed arrays in one zip file; layout in `traces/formats/psr.py`.

    The arrays grow by 44 bytes per record, and are written when the run is over.
    """

    SUFFIX, MODE = ".psr", "wb"

    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        super().__init__(file, timebase, modules)
        self._modules = modules
        self._columns = self.sink = Columns()
        self.write = self._columns.add

    def close(self, now: int) -> None:
        table = self._columns.table(Fraction(self._per_second), now, self._modules)
        write_table(replace(table, clocks=self.clocks), self._file)


class JsonlWriter(RecordingWriter):
    """Records as text, one JSON array per line: number, tick, kind, where, what, value, text, cause, field.

    The first line says the version and how many ticks a second has. The value of an address or a byte on the bus, and
    of a UART frame, is text as people write it: "0x21 R ACK", "0x11 ACK", "0x55"; that of a START or STOP is null.
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
