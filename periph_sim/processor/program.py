"""Interface between a processor and the program that it runs.

    Processor --run(until)--> program --reads, writes--> Bus
                 why  <------|         --interrupt due at a boundary--> Processor.take_interrupt --> enter(vector)

A program executes instructions: it advances `CpuTime.cycle`, makes its accesses in the cycles that the bus names, and
checks at each boundary between two instructions whether an interrupt is due. It keeps its position between two calls of
`run`: Python firmware in a greenlet, an instruction-set simulator in its registers and the pending access.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from ..core.state import State
from ..f28335.cpu.interrupts import CONTEXT_WORDS
from ..form.c_types import Text
from .polling import Spin
from .source_location import SourceLocation

NOTHING_SAVED = (0,) * CONTEXT_WORDS


class Stop(Enum):
    """Reason why a program stopped. It is run again at the cycle that it requested."""

    WAITS = "something else may act before the cycle that it has to reach"
    SLEEPS = "it sleeps at an instruction boundary"
    ENDED = "nothing is left to execute"


class Awaited(NamedTuple):
    """A description of a wait in progress. what: the registers or words that it reads.

    unanswered: the unmodelled register that it waits for, and how the case can answer; "" if there is none.
    memory: True if it reads no register, so that only a service routine can end it.
    """

    what: str
    unanswered: str = ""
    memory: bool = False


class UnansweredWait(NamedTuple):
    """A wait for an unmodelled register. since: the cycle at which it began. what, unanswered: see `Awaited`."""

    since: int
    what: str
    place: SourceLocation | None
    unanswered: str


class Program:
    """spin: the wait in progress. polls_skipped: number of passes of waits that were not executed.

    returned_at: the cycle at which main returned; None before.
    """

    STATE = State("spin polls_skipped", cycles="returned_at")

    def __init__(self) -> None:
        self.spin: Spin | None = None
        self.polls_skipped = 0
        self.returned_at: int | None = None

    @property
    def finished(self) -> bool:
        """True if main has returned."""
        return self.returned_at is not None

    def run(self, until: int) -> Stop | None:
        """Continue, and return the reason of the next stop; None if the program reports it itself (`Processor.stops`).

        until: nothing else can act before this cycle, the end of the present lease. An access with an effect ends the
        lease (`CpuTime.lease`). If `Processor.reach`, `rest`, `take_interrupt` or `iret` returns False, the program
        stops; the step is complete when it is run again.
        """
        raise NotImplementedError

    def awaited(self) -> Awaited:
        """Return what the wait in progress polls."""
        return Awaited("" if self.spin is None else self.spin.waits_for())

    def unanswered_wait(self) -> UnansweredWait | None:
        """Return the wait that reads unmodelled registers only, even while a service routine interrupts it."""
        return None

    def ending(self, at: Text) -> str:
        """Return the text of the note about the end of the program. at: `returned_at` as a time."""
        return f"main returned at {at}; from then on only service routines run"

    def place(self) -> SourceLocation | None:
        """Return the statement that is executed, or is next; None if it is unknown."""
        raise NotImplementedError

    def enter(self, vector: int) -> Text:
        """Enter the service routine at a vector, a code address. Return the place of its begin, "" if it is unknown.

        Raise FirmwareError if the vector has no routine.
        """
        raise NotImplementedError

    def context(self) -> Sequence[int]:
        """Return the 14 words that an interrupt saves, in the order of `frame_of`; the processor sets ST1 and IER."""
        return NOTHING_SAVED

    def restore(self, words: Sequence[int]) -> None:
        """Restore the context that IRET read from the stack."""

    def release(self) -> None:
        """Free the resources of a program that is not run again."""

    def kill(self, how: type[BaseException]) -> None:
        """End the program at its present position. how: the exception raised in Python firmware."""
        self.spin = None
