"""Records of the spans and waits of Python firmware."""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.records import Kind, Recorder, Topic
from ...core.time import Clock
from ...form.c_types import Text
from ..operand import Operand
from ..polling import Poll, Spin
from .program import PythonProgram


@final
class Waited:
    """Operands that a kind of wait polls, in order, and the topic of its records. following: another kind of wait."""

    topic: Topic
    following: Waited | None

    def __init__(self, polls: list[Operand]) -> None:
        self.polls = polls

    def polled_by(self, spin: Spin) -> bool:
        """Return True if the present pass of this wait polled the same operands."""
        if spin.made != len(self.polls):
            return False
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            if read.operand is not self.polls[place]:
                return False
        return True


@final
class CodeRecords:
    """Makes the records of spans and waits of one program.

    spans, waits: True if any subscriber needs records of them.
    kept: True if a subscriber to records of waits or accesses may keep a reference to a wait.
    """

    def __init__(self, clock: Clock, recorder: Recorder, program: PythonProgram) -> None:
        self.spans = recorder.wants(Kind.SPAN)
        self.waits = recorder.wants(Kind.WAIT)
        self.kept: bool = recorder.makes_records(Kind.WAIT) or recorder.makes_records(Kind.ACCESS)
        self._clock = clock
        self._recorder = recorder
        self._name = program.name
        self._program = program
        self._waited: Waited | None = None  # the kinds of wait so far: the first of a chain

    def span(self, cycle: int, name: Text, begins: int) -> None:
        """Record that a named span begins (1) or ends (0) at this cycle."""
        if self.spans:
            self.record(self._recorder.topic(Kind.SPAN, self._name, name), cycle, begins)

    def wait(self, cycle: int, what: Text, begins: int) -> None:
        """Record that a wait for `what` begins (1) or ends (0)."""
        if self.waits:
            self.record(self._recorder.topic(Kind.WAIT, self._name, what), cycle, begins)

    def waited_for(self, spin: Spin) -> Topic:
        """Return the topic of waits that poll the same operands as this one."""
        waited = self._waited
        while waited is not None and not waited.polled_by(spin):
            waited = waited.following
        if waited is None:
            waited = Waited(spin.polls)
            waited.topic = self._recorder.topic(Kind.WAIT, self._name, spin.waits_for() or "nothing")
            waited.following, self._waited = self._waited, waited
        return waited.topic

    def record(self, topic: Topic, cycle: int, begins: int) -> None:
        """Make a record of this topic."""
        where = (self._program.place() or "") if begins and topic.places else ""
        topic.emit(self._clock.tick(cycle), begins, where)
