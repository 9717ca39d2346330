"""A case's [outside] with a log: who moved its wires while it was live moves them again, in the same ticks.

    log --instant by instant--> event --> pins --> wires

The log is read through once before the run, so that a damaged one is refused; then as time goes on, so that memory does
not grow with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from ..core.agent import Agent
from ..core.kernel import Kernel
from ..core.suggest import did_you_mean
from ..core.wire import Wire
from .context import SceneContext
from .outside_log import BadLog, Instant, LogReader

WHO = "outside"  # name of the party in records and in messages about who holds a line


class LoggedOutside(Agent):
    """start: the tick from which those of the log count. on_sent: called with a wire and how many bytes begin on it.

    unfinished: what is missing at the end of the log; see `LogReader`.
    """

    def __init__(self, kernel: Kernel, wires: Mapping[str, Wire], path: Path, start: int) -> None:
        self._kernel = kernel
        self._pins = {name: wire.attach(WHO) for name, wire in wires.items()}
        self._start = start
        self._reader = LogReader(path)
        self._instants: Iterator[Instant] = self._reader.instants()
        self._next: Instant | None = None
        self.on_sent: Callable[[str, int], None] = lambda wire, count: None
        self.unfinished = ""
        self._plan()

    def act(self, tag: int) -> None:
        assert self._next is not None
        for wire, count in self._next.sent.items():
            self.on_sent(wire, count)
        for name, level in self._next.levels.items():
            self._pins[name].drive(level)
        self._plan()

    def _plan(self) -> None:
        self._next = next(self._instants, None)
        if self._next is not None:
            self._kernel.schedule(self._start + self._next.tick, self)
        else:
            self._reader.close()


def logged_outside(context: SceneContext, wires: Mapping[str, Wire]) -> LoggedOutside:
    """Return the agent that replays the log of [outside].

    Raise BadCase, with its line, if the log is unreadable, damaged, or of other wires or clocks.
    """
    case, ticks_per_second = context.case, context.timebase.per_second
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
        unfinished = _checked(path, status.st_mtime_ns, status.st_size)
    except BadLog as error:
        raise case.mistake(str(error), "outside", "log") from None
    logged = LoggedOutside(context.kernel, {name: wires[name] for name in reader.head.wires}, path, context.start)
    logged.unfinished = unfinished
    return logged


@lru_cache(maxsize=16)
def _checked(path: Path, written: int, size: int) -> str:
    """Return what is missing at the end of a log. BadLog if it is damaged. written, size: part of the cache's key."""
    reader = LogReader(path)
    for _ in reader.instants():
        pass
    return reader.unfinished
