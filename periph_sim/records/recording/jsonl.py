"""Records of periph_sim as text, one JSON array per line: number, tick, kind, where, what, value, text, cause, field.

The first line says the version and how many ticks a second has. The value of an address or a byte on the bus, and of a
UART frame, is text as people write it: "0x21 R ACK", "0x11 ACK", "0x55"; that of a START or STOP is null.
"""

from __future__ import annotations

import json
from typing import IO, Literal

from ...core.records import RECORDED, Kind, Record
from ...core.time import Timebase
from ..record_text import bus_byte, on_the_bus

SUFFIX = ".jsonl"
MODE: Literal["w"] = "w"
KINDS = RECORDED
VERSION = 2


class JsonlWriter:
    def __init__(self, file: IO[str], timebase: Timebase) -> None:
        self._file = file
        head = {"periph-sim": VERSION, "ticks_per_second": timebase.per_second, "columns": list(Record._fields)}
        file.write(json.dumps(head) + "\n")

    def write(self, record: Record) -> None:
        row = (record.number, record.tick, record.kind.value, record.where, record.what, _value(record), *record[6:])
        self._file.write(json.dumps(row) + "\n")

    def close(self, now: int) -> None:
        """Do nothing, since every record is already written."""


def _value(record: Record) -> int | str | None:
    if record.kind is Kind.FRAME:
        return None if record.what == "begin" else on_the_bus(record)
    if record.kind is not Kind.BUS:
        return record.value
    carried = bus_byte(record)
    return None if carried is None else str(carried)


def open_writer(file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> JsonlWriter:
    return JsonlWriter(file, timebase)
