"""Records of what Python firmware does besides its accesses: spans and waits go in; records, where wanted, come out."""

from __future__ import annotations

from ...core.records import Kind, Recorder
from ...core.time import Clock
from .program import PythonProgram


class CodeRecords:
    """spans, waits: whether anybody wants records of them."""

    __slots__ = ("_clock", "_name", "_program", "_recorder", "spans", "waits")

    def __init__(self, clock: Clock, recorder: Recorder, program: PythonProgram) -> None:
        self.spans = recorder.wants(Kind.SPAN)
        self.waits = recorder.wants(Kind.WAIT)
        self._clock = clock
        self._recorder = recorder
        self._name = program.name
        self._program = program

    def span(self, cycle: int, name: str, begins: int) -> None:
        """A named stretch begins (1) or ends (0) at this cycle."""
        if self.spans:
            self._emit(Kind.SPAN, cycle, name, begins)

    def wait(self, cycle: int, what: str, begins: int) -> None:
        """A wait for `what` begins (1) or ends (0)."""
        if self.waits:
            self._emit(Kind.WAIT, cycle, what, begins)

    def _emit(self, kind: Kind, cycle: int, what: str, begins: int) -> None:
        topic = self._recorder.topic(kind, self._name, what)
        where = (self._program.place() or "") if begins and topic.told_whole else ""
        topic.emit(self._clock.tick(cycle), begins, where)
