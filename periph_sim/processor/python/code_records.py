"""Records of what Python firmware does besides its accesses: spans and waits go in; records, where wanted, come out."""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING, final

from ...core.records import Kind, Recorder, Topic
from ...core.time import Clock
from ...form.c_types import Text
from ..operand import Operand
from ..polling import Spin
from .program import PythonProgram

if TYPE_CHECKING:
    from ..polling import Poll


@final
class Waited:
    """What the passes of a wait polled, in order, and the records of such waits. following: another kind of wait."""

    __slots__ = ("following", "polls", "topic")

    topic: Topic
    following: Waited | None

    def __init__(self, polls: list[Operand]) -> None:
        self.polls = polls

    def polled_by(self, spin: Spin) -> bool:
        """Whether the present pass of this wait did."""
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
    """spans, waits: whether anybody wants records of them. kept: whether anybody who is told of them, or of accesses,
    may keep a wait.
    """

    __slots__ = ("_clock", "_name", "_program", "_recorder", "_waited", "kept", "spans", "waits")

    kept: bool

    def __init__(self, clock: Clock, recorder: Recorder, program: PythonProgram) -> None:
        self.spans = recorder.wants(Kind.SPAN)
        self.waits = recorder.wants(Kind.WAIT)
        self.kept = recorder.tells_records(Kind.WAIT) or recorder.tells_records(Kind.ACCESS)
        self._clock = clock
        self._recorder = recorder
        self._name = program.name
        self._program = program
        self._waited: Waited | None = None  # each kind of wait so far: the first of a chain

    def span(self, cycle: int, name: Text, begins: int) -> None:
        """A named stretch begins (1) or ends (0) at this cycle."""
        if self.spans:
            self.tell(self._recorder.topic(Kind.SPAN, self._name, name), cycle, begins)

    def wait(self, cycle: int, what: Text, begins: int) -> None:
        """A wait for `what` begins (1) or ends (0)."""
        if self.waits:
            self.tell(self._recorder.topic(Kind.WAIT, self._name, what), cycle, begins)

    def waited_for(self, spin: Spin) -> Topic:
        """The records of waits that poll what this one does."""
        waited = self._waited
        while waited is not None and not waited.polled_by(spin):
            waited = waited.following
        if waited is None:
            waited = Waited(spin.polls)
            waited.topic = self._recorder.topic(Kind.WAIT, self._name, spin.waits_for() or "nothing")
            waited.following, self._waited = self._waited, waited
        return waited.topic

    def tell(self, topic: Topic, cycle: int, begins: int) -> None:
        """A record of this topic."""
        where = (self._program.place() or "") if begins and topic.places else ""
        topic.emit(self._clock.tick(cycle), begins, where)
