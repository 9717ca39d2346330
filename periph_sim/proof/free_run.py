"""A run for closed tables, in which each start of a round or frame is chosen while the scene is at rest.

start(tick) --> round --> settle: nothing is in progress, and instants of the round are long past --> state, digest

The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any
from weakref import ref

from ..core.chip import NEVER
from ..core.records import RecordCallback
from ..processor.image.data_marks import DataMarks
from ..scene.scene import Scene
from .normal_state import LONG_PAST, NormalState, NotComparable, differences, normal_state
from .record_digests import RoundDigest
from .stretch import CoveredCase

DUE = "something is still due a second after the start of a round, such as a timer"
NAMED = 4  # maximum number of attributes that are named if a state does not repeat
CHECKS = 10  # the scene advances to the end of a round in steps of `FreeRun.long` divided by this number


class NotClosed(Exception):
    """Error: the case cannot have a closed table. The message is a phrase that says why."""


class FreeRun:
    """A run whose starts are chosen one by one.

    At each rest, the free words of the stack are cleared, so that states differ only in the words that are in use. If
    the firmware then reads a free word before it has written it, NotClosed is raised.

    scene: the scene. Only this object may advance it.
    frames, rounds: the ticks of the starts so far, counted from the start of the run.
    records: the digest of the records since the last start.
    long: the number of ticks after which an instant is long past, so that it has no effect any more.
    """

    def __init__(
        self,
        covered: CoveredCase,
        ignored: Sequence[str],
        keep_values: bool,
        rests_first: bool,
        records: RoundDigest | None = None,
        on_request: RecordCallback | None = None,
    ) -> None:
        """Advance to the first rest.

        ignored: the ignored attributes.
        keep_values: True to keep all values of the budgets.
        rests_first: True to rest before any start; False to run the first start of the case, and then rest. In a case
            with rounds and frames, the first round and the first frame are run.
        records: receives the records of rounds; None for a new RoundDigest.
        on_request: is called with the records of the PIE's request flags; None for no calls.

        Raise NotClosed if the scene does not reach a rest, if the first start of the case is at the start of the run,
        or, with `rests_first`, if it is before the first rest.
        """
        self.records = records or RoundDigest()
        self.scene: Scene = covered.free_scene(self.records, keep_values, on_request)
        self.frames: list[int] = []
        self.rounds: list[int] = []
        self._ignored = ignored
        (self._dsp, *_) = self.scene.units.values()
        program: Any = self._dsp.program
        self._program = program  # the program of an image
        self._free: range = range(0)  # the addresses of the words of the stack that were free at the last rest
        if self.scene.host is not None:
            program.cpu.marks = DataMarks()
        # The reference is weak: a reference from the compiled CPU to this object would keep both alive for ever.
        self._program.cpu.reads_unwritten = partial(_read_unwritten, ref(self))
        self.long = self.scene.timebase.per_second // LONG_PAST
        firsts = covered.phases.first_starts()
        first = self.scene.start + min(firsts.values())
        if rests_first:
            self.settle()
            if self.now >= first:
                at = 1000 * (self.now - self.scene.start) / self.scene.timebase.per_second
                what = "the first start is free, and must come after the firmware has been at rest for 2 ms"
                raise NotClosed(f"{what}: make `first` more than {at:.4f} ms")
            return
        if first == self.scene.start:
            raise NotClosed("the first start is at the start of the run; make `first` later")
        self.scene.advance(first - 1)
        self.records.begin_free()
        self.start(**{each: self.scene.start + tick for each, tick in firsts.items()})
        self.settle()

    @property
    def now(self) -> int:
        return self.scene.kernel.now

    @property
    def ticks_per_cycle(self) -> int:
        """The present length of a cycle in ticks."""
        clock = self._dsp.clock
        cycle = clock.cycle_at(self.now)
        return clock.tick(cycle + 1) - clock.tick(cycle)

    def state(self) -> NormalState:
        """Return the present normal state. Raise NotClosed if a part of the scene has none."""
        try:
            return normal_state(self.scene, self._ignored)
        except NotComparable as error:
            raise NotClosed(str(error)) from None

    def not_repeating(self, before: NormalState, after: NormalState) -> NotClosed:
        """Return the error for a rest without an orbit. before, after: its states one period apart, which differ."""
        polls = self._program.cpu.polls
        if polls.asleep and not polls.reads_modules:
            place = self._program.place()
            return NotClosed(
                f"the firmware waits at {place} without reading a register, and such waits are not compared"
            )
        names = differences(before, after)
        more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
        return NotClosed(f"the state does not repeat while the firmware waits: {', '.join(names[:NAMED])}{more}")

    def start(self, frames: int | None = None, rounds: int | None = None, count_from: int | None = None) -> None:
        """Start a frame at tick `frames`, a round at tick `rounds`, or both, and advance to the later start.

        count_from: the tick from which the digest counts the times of records; None for the earlier start.
        """
        scene, starts = self.scene, [start for start in (frames, rounds) if start is not None]
        self.records.begin(min(starts) if count_from is None else count_from)
        if rounds is not None:
            self.rounds.append(rounds - scene.start)
            assert scene.head is not None
            scene.head.start_round(rounds)
        if frames is not None:
            assert scene.host is not None
            self.frames.append(frames - scene.start)
            scene.host.start_frame(frames)
            self._program.cpu.marks.frame_begins()
        scene.advance(max(starts))

    def settle(self) -> None:
        """Advance to a rest: to a cycle at which no event is due, and at which instants of the round are long past.

        Raise NotClosed if there is no rest within a second, or if the firmware has accessed one of CLOCK_REGISTERS
        since the first start.
        """
        scene, until = self.scene, self.now + self.scene.timebase.per_second
        while not self.is_over():
            self._step(self.long // CHECKS, until, "a round lasts longer than a second")
        self._step(2 * self.long, until, "a round lasts longer than a second")  # the firmware may go on after the round
        while scene.kernel.next_time() < NEVER:
            while scene.kernel.next_time() < NEVER:
                self._step(self.long, until, DUE)
            self._step(2 * self.long, until, DUE)  # makes the instants of the last events long past
        self.next_cycle()
        self._free = self._program.forget_stack()
        if not (self.frames or self.rounds):
            self.records.accessed = ""  # before the first start, accesses are allowed: start-up code sets up the clocks
        if self.records.accessed:
            what = f"the firmware accesses {self.records.accessed} after the first start"
            raise NotClosed(f"{what}, and the effects are not in the table; let it start after the start-up")

    @property
    def data_use(self) -> str:
        """The first use of the data of a frame that decides what the firmware does, as text; "" for none."""
        marks = self._program.cpu.marks
        if marks is None or marks.found is None:
            return ""
        return f"{marks.found.how} at {self._program.place_at(marks.found.address)}"

    def next_cycle(self) -> None:
        """Advance to the next tick at which a cycle begins."""
        clock = self._dsp.clock
        self.scene.advance(clock.tick(clock.cycle_at(self.now + 1)))

    def _step(self, ticks: int, until: int, otherwise: str) -> None:
        """Advance by some ticks. If tick `until` is over already, raise NotClosed with the message `otherwise`."""
        if self.now > until:
            raise NotClosed(otherwise)
        self.scene.advance(self.now + ticks)

    def is_over(self) -> bool:
        """Return True if no round and no frame is in progress."""
        scene = self.scene
        return (scene.head is None or scene.head.at_rest) and (scene.host is None or not scene.host.is_sending)

    def read_unwritten(self, address: int) -> None:
        """Handle a read of a word that was not written yet. Raise NotClosed if it is a free word of the stack."""
        if address in self._free:
            what = f"{self._program.place()} reads {address:#06x} on the stack"
            raise NotClosed(f"{what}, which it has not written since the last rest")
        self._program.read_unwritten(address)


def _read_unwritten(run: ref[FreeRun], address: int) -> None:
    """Call `read_unwritten` of a run, if the run still exists."""
    found = run()
    if found is not None:
        found.read_unwritten(address)
