"""What a service routine costs the code that it interrupts: a case with its host alone goes in, cycles come out.

    host --frames--> interrupts of a firmware that nobody asks --> entry, routine, IRET; how many a frame

The routine is straight-line code, so its cost in a run in which nothing else happens is its cost.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..board.scene import Scene
from ..case.model import Case
from ..core.records import Kind, Record
from ..f28335.cpu_costs import IFR_DELAY
from .terms import BadBound, Term

FRAMES = 2


@dataclass(frozen=True)
class Handlers:
    """cost: ticks that one interrupt takes away, its terms. per_frame: interrupts a host frame. period, jitter: ticks
    of the host's frames. bit: a bit of the host's line."""

    terms: tuple[Term, ...]
    per_frame: int
    period: int
    jitter: int
    bit: int

    @property
    def cost(self) -> int:
        return sum(term.ticks for term in self.terms)

    def times(self, length: int) -> int:
        """How often at most one begins in a window of so many ticks, its ends included."""
        return self.per_frame * ((length + self.jitter) // self.period + 1) if self.per_frame else 0

    def within(self, length: int) -> int:
        """How often at most one takes time away from what needs `length` ticks without it.

        The window begins with the routine that runs as the work begins, if one does, and grows with each. BadBound if
        there is no end of them.
        """
        if not self.per_frame:
            return 0
        if self.per_frame * self.cost >= self.period:
            raise BadBound("the host's interrupts take all of the CPU's time, so there is no bound")
        count = 0
        while (more := self.times(length + count * self.cost)) > count:
            count = more
        return count


NONE = Handlers((), 0, 1, 0, 0)


def observe_handlers(case: Case, unit: str) -> Handlers:
    """Run the case without its controller for two frames. BadBound if the routines of a frame do not end."""
    if case.host is None:
        return NONE
    host = case.host.model_copy(update={"jitter": case.host.jitter * 0, "frames": FRAMES, "lose": ()})
    quiet = case.model_copy(update={"controller": None, "host": host, "budget": (), "breaks": ()})
    entered: list[int] = []
    lengths: list[int] = []

    def hear(record: Record) -> None:
        if record.where == unit:
            if record.value:
                entered.append(record.tick)
            elif entered:
                lengths.append(record.tick - entered[-1])

    scene = Scene(quiet, lambda recorder, _: recorder.subscribe([Kind.IRQ], hear))
    scene.run(host.first + (FRAMES + 1) * host.period)
    if len(lengths) != len(entered):
        raise BadBound(f"{unit}: a service routine that a host frame sets off does not end before the next one")
    bit = scene.timebase.per_second / case.host.baud
    per_frame = -(-len(entered) // FRAMES)
    period, jitter = (scene.timebase.ticks(length, "nearest") for length in (host.period, case.host.jitter))
    if not entered:
        return NONE
    options = scene.units[unit].plan.system
    cycle = scene.timebase.per_second / scene.sysclk(unit)
    entry = -int(-(options.int_latency - IFR_DELAY) * cycle // 1)
    terms = (
        Term("interrupt entry", entry, f"int_latency {options.int_latency}, less {IFR_DELAY} to the IFR (SPRUFB0D 8)"),
        Term("service routine and IRET", max(lengths), "its code, measured with no controller; context_save in it"),
    )
    return Handlers(terms, per_frame, period, jitter, -int(-bit // 1))
