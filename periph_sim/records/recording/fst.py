"""FST for GTKWave and Surfer: the signals of a run (`run_signals`), registers as vectors, and what parties on the wires
say as text. Small, and quick to open; the extra `fst` brings the library that writes it.

Times are in picoseconds, rounded down from ticks.
"""

from __future__ import annotations

from fractions import Fraction
from typing import IO, Literal

from ...core.records import Kind, Record
from ...core.time import Timebase
from ...traces.formats.fst_ghw import TEXT, NoFstLibrary, Variable, fst_bytes, library
from ..record_text import on_the_bus
from . import BadRecording
from .run_signals import KINDS as OF_SIGNALS
from .run_signals import RunSignals, Signal

SUFFIX = ".fst"
MODE: Literal["wb"] = "wb"
KINDS = (*OF_SIGNALS, Kind.BUS, Kind.FRAME)

PICOSECONDS = 10**12
# Text signals with values such as "0x68 R ACK" and "0x55". Each value is kept until the next record.
SAID = {Kind.BUS: "bus.I2C.text", Kind.FRAME: "bus.UART.text"}


class FstFile:
    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        self._file = file
        self._run = RunSignals(timebase, modules)
        self._said: dict[str, list[tuple[int, str]]] = {name: [(0, "-")] for name in SAID.values()}

    def write(self, record: Record) -> None:
        if record.kind not in SAID:
            self._run.write(record)
        elif record.kind is Kind.BUS or record.what == "byte":
            self._said[SAID[record.kind]].append((self._time(record.tick), on_the_bus(record)))

    def close(self, now: int) -> None:
        variables = [self._variable(signal) for signal in self._run.signals(now)]
        variables += [Variable(name, TEXT, said) for name, said in self._said.items()]
        self._file.write(fst_bytes(Fraction(PICOSECONDS), variables, self._time(now)))

    def _variable(self, signal: Signal) -> Variable:
        at, values = signal.changes()
        letters = (f"{value:0{signal.width}b}" for value in values.tolist())
        return Variable(signal.name, signal.width, zip(map(self._time, at.tolist()), letters, strict=True))

    def _time(self, tick: int) -> int:
        return tick * PICOSECONDS // self._run.per_second


def open_writer(file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> FstFile:
    try:
        library()  # raise an error for a missing library before the run, not after it
    except NoFstLibrary as error:
        raise BadRecording(str(error)) from None
    return FstFile(file, timebase, modules)
