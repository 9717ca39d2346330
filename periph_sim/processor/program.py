"""What runs on a processor: the cycle up to which it may go, goes in; why it stopped, comes out.

    Processor --run(until)--> program --reads, writes--> Bus
                 why  <------|         --interrupt due at a boundary--> Processor.take --> enter(vector)

A program executes instructions: it counts `CpuTime.cycle` on, makes its accesses in the cycles that the bus names, and
asks at each boundary between two instructions whether an interrupt is due. It keeps its place between two calls of
`run`, wherever it stopped, by whatever means it has: Python firmware by a greenlet, an instruction-set simulator by its
registers and the access that is still to be made.
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
    """Why a program stopped. It is run again when the cycle has come that it asked for."""

    WAITS = "something else may act before the cycle that it is to reach"
    SLEEPS = "it sleeps at an instruction boundary"
    ENDED = "nothing is left to execute"


class UnansweredWait(NamedTuple):
    """A wait for what nothing models. since: the cycle at which it began. what, unanswered: see `Program`."""

    since: int
    what: str
    place: SourceLocation | None
    unanswered: str


class Program:
    """spin: the wait in progress. polls_skipped: passes of waits that were not made for real.

    returned_at: the cycle at which main returned, if it did.
    """

    STATE = State("spin polls_skipped", cycles="returned_at")

    def __init__(self) -> None:
        self.spin: Spin | None = None
        self.polls_skipped = 0
        self.returned_at: int | None = None

    @property
    def finished(self) -> bool:
        """Main has returned."""
        return self.returned_at is not None

    def run(self, until: int) -> Stop | None:
        """Go on from where it stopped, and say why it stops again; None where it does so itself (`Processor.stops`).

        until: before this cycle nothing else can act: the lease as it is now. An access that acts ends it
        (`CpuTime.lease`); `Processor.reach`, `rest`, `take` and `iret` say whether it is the cycle asked for already.
        Where they say no, the program stops, and finds that done when it is run again.
        """
        raise NotImplementedError

    def waits_for(self) -> str:
        """What the wait in progress looks at."""
        return "" if self.spin is None else self.spin.waits_for()

    def unanswered(self) -> str:
        """What it waits for that nothing models, and how the case can answer; "" if it does not."""
        return ""

    def unanswered_wait(self) -> UnansweredWait | None:
        """Return the wait for nothing but what nothing models, even if a service routine interrupts it."""
        return None

    def waits_for_memory(self) -> bool:
        """Whether the wait in progress reads no register, so that only a service routine can end it."""
        return False

    def ending(self, at: Text) -> str:
        """What a note says of a program that is over. at: `returned_at` as a time."""
        return f"main returned at {at}; from then on only service routines run"

    def place(self) -> SourceLocation | None:
        """The statement that is executed, or goes on next; None where nobody knows."""
        raise NotImplementedError

    def enter(self, vector: int) -> Text:
        """A service routine is entered at its vector, a code address. Returns where it begins, "" if nobody knows.

        FirmwareError if there is nothing.
        """
        raise NotImplementedError

    def context(self) -> Sequence[int]:
        """The 14 words that an interrupt saves, as `frame_of` orders them; ST1 and IER are the processor's."""
        return NOTHING_SAVED

    def restore(self, words: Sequence[int]) -> None:
        """The context that IRET brought back."""

    def let_go(self) -> None:
        """Nobody will run it again: what it holds is free."""

    def kill(self, how: type[BaseException]) -> None:
        """It ends where it stands. how: what is raised in it, if that is how it ends."""
        self.spin = None
