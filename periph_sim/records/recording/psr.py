"""Records of periph_sim by column: the whole run as typed arrays in one zip file; layout in `traces/formats/psr.py`.

records as they happen --> growing arrays, 44 bytes per record --> written when the run is over
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import IO, Literal

from ...core.records import RECORDED
from ...core.time import Timebase
from ...traces.formats.psr import write_table
from ...traces.formats.record_table import Clocks, Columns

SUFFIX = ".psr"
MODE: Literal["wb"] = "wb"
KINDS = RECORDED


class PsrWriter:
    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        self._file = file
        self._per_second = Fraction(timebase.per_second)
        self._modules = modules
        self.clocks: Clocks = {}
        self.sink = Columns()
        self.write = self.sink.add

    def close(self, now: int) -> None:
        table = self.sink.table(self._per_second, now, self._modules)
        write_table(replace(table, clocks=self.clocks), self._file)


def open_writer(file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> PsrWriter:
    return PsrWriter(file, timebase, modules)
