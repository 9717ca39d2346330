"""A case's [outside] with a log: who moved its wires while it was live moves them again, in the same ticks.

    log --instant by instant--> event --> pins --> wires

The log is read through once before the run, so that a damaged one is refused; then as time goes on, so that memory does
not grow with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from ..core.kernel import Agent, Kernel
from ..core.suggest import did_you_mean
from ..core.wire import Wire
from .case.model import Case
from .outside_log import BadLog, LogReader

WHO = "outside"  # in records, and where somebody asks who holds a line

Instant = tuple[int, dict[str, int]]


class LoggedOutside(Agent):
    """sci_bytes: that the session sent to SCIs. start: the tick from which those of the log count."""

    def __init__(self, kernel: Kernel, wires: Mapping[str, Wire], path: Path, start: int, sci_bytes: int) -> None:
        self.sci_bytes = sci_bytes
        self._kernel = kernel
        self._pins = {name: wire.attach(WHO) for name, wire in wires.items()}
        self._start = start
        self._reader = LogReader(path)
        self._instants: Iterator[Instant] = self._reader.instants()
        self._levels: dict[str, int] = {}
        self._plan()

    def act(self, tag: int) -> None:
        for name, level in self._levels.items():
            self._pins[name].drive(level)
        self._plan()

    def _plan(self) -> None:
        tick, self._levels = next(self._instants, (-1, {}))
        if tick >= 0:
            self._kernel.ask(self._start + tick, self)
        else:
            self._reader.close()


def logged_outside(
    case: Case, kernel: Kernel, wires: Mapping[str, Wire], start: int, ticks_per_second: int
) -> LoggedOutside:
    """BadCase, with its line, for a log that cannot be had, is damaged, or is of other wires or clocks."""
    assert case.outside is not None and case.outside.log is not None
    path = case.folder / case.outside.log
    try:
        reader = LogReader(path)
        reader.close()
        if reader.head.ticks_per_second != ticks_per_second:
            found = f"has {reader.head.ticks_per_second} ticks a second, and this case {ticks_per_second}"
            raise BadLog(f"{path}: it {found}; replay it with the case it is of")
        for name in reader.head.wires:
            if name not in case.outside.wires:
                raise BadLog(f"{path}: it moves {name}; {did_you_mean(name, case.outside.wires)}")
        status = path.stat()
        sci_bytes = _checked(path, status.st_mtime_ns, status.st_size)
    except BadLog as error:
        raise case.mistake(str(error), "outside", "log") from None
    return LoggedOutside(kernel, {name: wires[name] for name in reader.head.wires}, path, start, sci_bytes)


@lru_cache(maxsize=16)
def _checked(path: Path, written: int, size: int) -> int:
    """The bytes that it sent to SCIs, once all of it was read. written, size: another file is another log."""
    reader = LogReader(path)
    for tick, levels in reader.instants():
        for name, level in levels.items():
            if name not in reader.head.wires or level not in (0, 1):
                raise BadLog(f"{path}: {name!r} at tick {tick} is {level!r}; expected 0 or 1 of one of its wires")
    return reader.sci_bytes
