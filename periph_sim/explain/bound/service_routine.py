"""What a service routine costs the code that it interrupts: a case with its host alone goes in, cycles come out.

    host --frames--> interrupts of a firmware that nobody asks --> entry, routine, IRET; how many a frame

The routine is straight-line code, so its cost in a run in which nothing else happens is its cost.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import ceil
from types import CodeType

from msgspec import Struct, field

from ...core.records import Kind, Record
from ...core.time import Timebase
from ...f28335.cpu.instruction_costs import IFR_DELAY
from ...processor.user_code import output_muted
from ...scene.case.model import Case
from ...scene.scene import Scene
from .branches import Decisions
from .code_trace import CodeTrace, Ran, firmware_stack
from .fifo_bound import READ, VECTOR, Receiver, receiver_of
from .program import Program
from .terms import BadBound, Term, total

FRAMES = 2


class ServiceRoutines(Struct, frozen=True, dict=True):
    """cost: ticks that one interrupt takes away, its terms. per_frame: interrupts a host frame. period, jitter: ticks
    of the host's frames, the period rounded down. bit: a bit of the host's line. vectors: of the interrupts. receiver:
    the FIFO that they serve; None where they serve none. seconds, events: of the run they were measured in."""

    terms: tuple[Term, ...]
    per_frame: int
    period: int
    jitter: int
    bit: int
    vectors: tuple[str, ...] = ()
    receiver: Receiver | None = None
    seconds: Fraction = Fraction(0)
    events: int = 0

    @cached_property
    def cost(self) -> int:
        return total(self.terms)

    @property
    def apart(self) -> int:
        """Ticks between the requests of two of them, at least: words that one takes do not ask for another."""
        frames = self.period - self.jitter
        if self.per_frame < 2:
            return frames
        return 0 if self.receiver is None else min(frames, self.receiver.level * self.receiver.character)

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
            what = "the service routines of host frames take all of the CPU's time, so nothing else ends"
            raise BadBound(f"{what}; shorten them or lengthen host.period")
        count = 0
        while (more := self.times(length + count * self.cost)) > count:
            count = more
        return count


NONE = ServiceRoutines((), 0, 1, 0, 0)


@output_muted()
def observe_handlers(case: Case, unit: str) -> ServiceRoutines:
    """Run the case without requests for two frames. BadBound if the routines of a frame do not end."""
    if case.host is None:
        return NONE
    plain = {"jitter": Fraction(0), "frames": FRAMES, "lose": (), "silent": (), "twice": ()}
    host = case.host.model_copy(update=plain)
    length, controller = host.first + (FRAMES + 1) * host.period, case.controller
    if controller is not None:  # it stays, since models may run at its pace, but asks when all is over
        controller = controller.model_copy(update={"first": 2 * length, "initialise": None})
    plainest = {"controller": controller, "host": host, "budget": (), "breaks": (), "fidelity": "edge"}
    quiet = case.model_copy(update=plainest)
    listener = _Listener(unit)
    kinds = (Kind.IRQ, Kind.ACCESS, Kind.SPAN)
    scene = Scene(quiet, lambda recorder, _: recorder.subscribe(kinds, listener.hear), end="most")
    scene.run(length)
    if listener.running:
        what = f"a service routine of {unit} that a host frame sets off is not over when the next frame comes"
        raise BadBound(f"{what}; shorten it or lengthen host.period")
    bit = scene.timebase.per_second / case.host.baud
    routines = listener.routines
    per_frame = -(-len(routines) // FRAMES)
    exact = [in_ticks(length, host.ppm, scene.timebase) for length in (host.period, case.host.jitter)]
    period, jitter = exact[0].__floor__(), exact[1].__ceil__()
    if not routines:
        return NONE
    options = scene.units[unit].plan.system
    cycle = scene.timebase.per_second / scene.units[unit].clock.hz
    beside = options.vector_fetch_waits.unrecorded() + options.idle_wake.unrecorded()
    to_entry = options.int_latency.unrecorded()
    entry = -int(-(to_entry + beside - IFR_DELAY) * cycle // 1)
    latency = f"int_latency {to_entry}, less {IFR_DELAY} to the IFR (SPRUFB0D 8)"
    if beside:
        latency += f", and {beside} of vector_fetch_waits and idle_wake"
    source = "its code, measured without requests; isr_prologue, isr_epilogue in it"
    handlers = [scene.units[unit].cpu.program.handlers[vector] for vector in {routine.vector for routine in routines}]
    unproven = "; ".join([*_uneven(routines, cycle), *_open(handlers, Program(scene.firmware[unit].main))])
    terms = (
        Term("interrupt entry", entry, latency),
        Term(
            "service routine and IRET",
            max(ceil(round(routine.length / cycle) * cycle) for routine in routines),
            source,
            unproven,
        ),
    )
    vectors = tuple(dict.fromkeys(routine.vector for routine in routines))
    receiver = None
    if vectors == (VECTOR,):
        reads = [routine.reads for routine in routines]
        receiver = receiver_of(scene.units[unit], scene.kernel.now, reads, scene.timebase.per_second)
    events = scene.kernel.events
    return ServiceRoutines(terms, per_frame, period, jitter, -int(-bit // 1), vectors, receiver, length, events)


def in_ticks(length: Fraction, ppm: Fraction, timebase: Timebase) -> Fraction:
    """Seconds of a clock that is off, in ticks."""
    return length * timebase.per_second / (1 + ppm / 1_000_000)


class _Routine(Struct):
    """One run of a service routine."""

    vector: str
    entered: int
    trace: CodeTrace
    length: int = 0

    @property
    def steps(self) -> list[tuple[int, str]]:
        """What it did when, in ticks from its entry on."""
        return [(mark.tick - self.entered, mark.what) for mark in self.trace.marks]

    def in_cycles(self, cycle: Fraction) -> list[tuple[int, str]]:
        """The same in cycles, and its end: ticks are rounded, and so differ by one where a cycle is no whole number."""
        return [(round(tick / cycle), what) for tick, what in (*self.steps, (self.length, "its end"))]

    @property
    def reads(self) -> list[int]:
        """When it read a word, in ticks from its entry on."""
        return [tick for tick, what in self.steps if what.endswith(READ)]


class _Listener(Struct):
    """Hears the records of a unit's service routines, none of which interrupts another."""

    unit: str
    routines: list[_Routine] = field(default_factory=list)
    running: bool = False

    def hear(self, record: Record) -> None:
        if record.where != self.unit:
            return
        if record.kind is Kind.IRQ:
            self.running = bool(record.value)
            if record.value:
                self.routines.append(_Routine(record.what, record.tick, CodeTrace(len(firmware_stack()))))
            elif self.routines:
                self.routines[-1].length = record.tick - self.routines[-1].entered
                self.routines[-1].trace.forget()
        elif self.running and not record.what.startswith("W "):  # a write of what was interrupted may land
            self.routines[-1].trace.note(record.tick, f"{record.text} {record.what}")


def _uneven(routines: list[_Routine], cycle: Fraction) -> list[str]:
    """Routines that did not do the same, in the same cycles, each time."""
    found = []
    for one, again in pairwise(routines):
        if one.vector == again.vector and one.in_cycles(cycle) != again.in_cycles(cycle):
            once, then = (round(routine.length / cycle) for routine in (one, again))
            found.append(f"{one.vector} took {once} cycles once and {then} another time")
    return found


def _open(handlers: list[Callable[[], None]], program: Program) -> list[str]:
    """What decides what these routines do, but for settings."""
    codes = [getattr(handler, "__code__", None) for handler in handlers]
    if not all(isinstance(code, CodeType) for code in codes):
        return ["a service routine is no Python function, so its source cannot be read"]
    return [str(found) for found in Decisions(program).open(Ran(code) for code in codes if isinstance(code, CodeType))]
