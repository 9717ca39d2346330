"""sigrok session for PulseView and sigrok-cli: wires, bus state, interrupts and spans as an analyser would show them.

Of the signals of a run (`run_signals`) those of one bit, registers aside: the first 64, wires first. The rate is the
fastest of `RATES` that keeps the file at `MOST_SAMPLES`.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import IO, Literal

from ...core.time import Timebase
from ...traces.capture.capture import Channel
from ...traces.capture.sampling import resampled
from ...traces.formats import sigrok_sr
from .run_signals import KINDS, RunSignals

__all__ = ["KINDS", "MODE", "SUFFIX", "open_writer"]

SUFFIX = ".sr"
MODE: Literal["wb"] = "wb"

RATES = [Fraction(mhz * 10**6) for mhz in (100, 50, 20, 10, 5, 2, 1)]
MOST_SAMPLES = 1 << 28  # 2.7 s at 100 MHz; packing them takes two to three seconds


class SrFile:
    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        self._file = file
        self._run = RunSignals(timebase, modules)
        self.write = self._run.write

    def close(self, now: int) -> None:
        lines = self._run.lines(now)
        shown = replace(lines, channels=tuple(_named_as_wire(c) for c in lines.channels[: sigrok_sr.MOST_WIDE]))
        sigrok_sr.write_to(self._file, resampled(shown, rate_for(Fraction(lines.length, self._run.per_second))))


def rate_for(seconds: Fraction) -> Fraction:
    """Return the samples per second for a run of this length."""
    return next((rate for rate in RATES if seconds * rate <= MOST_SAMPLES), RATES[-1])


def _named_as_wire(channel: Channel) -> Channel:
    """Return `SCL` for `wires.SCL`: decoders get their channels by name."""
    return replace(channel, name=channel.name.removeprefix("wires."))


def open_writer(file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> SrFile:
    return SrFile(file, timebase, modules)
