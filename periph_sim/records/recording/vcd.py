"""VCD for GTKWave, Surfer, sigrok and scripts: wires, bus state, registers and their fields, interrupts, spans of
firmware; see `run_signals`.

Chosen:
- Bits only, a register as `I2CSTR[15]` to `I2CSTR[0]`: sigrok up to 0.5.2 reads nothing after a change of a vector,
  and readers such as vcdvcd find no changes of strings. `.fst` has vectors and texts.
- Times in nanoseconds, exact where a tick is whole ones, as at 100 MHz, else rounded up: at 150 MHz a tick is 1/3 ns,
  which no timescale divides, and sigrok makes a sample for each unit of time, so it does not finish with
  picoseconds. `.psr` is exact, `.fst` has picoseconds.
"""

from __future__ import annotations

from fractions import Fraction
from typing import IO, Literal

from ...core.time import GHZ, Timebase
from ...traces.capture.sampling import resampled
from ...traces.formats.vcd import write_to
from .run_signals import KINDS, RunSignals

__all__ = ["KINDS", "MODE", "SUFFIX", "open_writer"]

SUFFIX = ".vcd"
MODE: Literal["w"] = "w"


class VcdFile:
    def __init__(self, file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        self._file = file
        self._run = RunSignals(timebase, modules)
        self.write = self._run.write

    def close(self, now: int) -> None:
        write_to(self._file, resampled(self._run.bits(now), Fraction(GHZ)), scope=())


def open_writer(file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> VcdFile:
    return VcdFile(file, timebase, modules)
