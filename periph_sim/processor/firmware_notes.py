"""Notes on the firmware of one CPU, which are counted and recorded.

A note with the code "duty" states that the firmware has violated a rule of the manuals. With `strict`, it is an error.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import final

from ..core.chip import Note
from ..core.kernel import Kernel
from ..core.records import Kind, Recorder
from ..core.state import State
from ..core.time import Clock
from ..form.c_types import Text
from .source_location import SourceLocation
from .user_code import FirmwareError


@final
class FirmwareNotes:
    """The notes on the firmware of one CPU.

    counts: for each note, the number of its occurrences.
    first_at: for each note, the tick of its first occurrence.
    places: for each note, the statement of its first occurrence, if the statement is known.
    strict: True if a note with the code "duty" ends the run.
    placed: True if posted writes keep the statement that issued them until they land.
    """

    STATE = State("counts places", ticks="first_at")

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        strict: bool,
        place: Callable[[], SourceLocation | None],
    ) -> None:
        """place: returns the statement that causes the present action; None if it is unknown."""
        self.counts: dict[Note, int] = {}
        self.first_at: dict[Note, int] = {}
        self.places: dict[Note, SourceLocation] = {}
        self.strict = self.placed = strict
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._name = name
        self._place = place
        self._start = kernel.now  # the tick at which the run begins

    def move_from(self, cycle: int, notes: list[Note]) -> None:
        """Count and record the notes in a list, and empty the list."""
        for note in notes:
            self.note(cycle, note)
        notes.clear()

    def note(self, cycle: int, note: Note) -> None:
        """Count and record a note. If `strict`, raise FirmwareError for the code "duty"."""
        tick = self._clock.tick(cycle)
        self.raise_if_strict(note, self._name, max(tick, self._kernel.now))
        if note not in self.counts:
            self.first_at[note] = tick
            where = self._place()
            if where is not None:
                self.places[note] = where
        self.counts[note] = self.counts.get(note, 0) + 1
        if self._recorder.wants(Kind.NOTE):
            self._recorder.emit(tick, Kind.NOTE, self._name, note.code, self.counts[note], note.text)

    def raise_if_strict(self, note: Note, who: Text, tick: int) -> None:
        """If `strict`, raise FirmwareError for the code "duty", and set the kernel's time to `tick`.

        who: the module or unit that makes the note. tick: the present instant of the CPU, which may run ahead.
        """
        if self.strict and note.code == "duty":
            self._kernel.now = tick
            at = self._clock.timebase.show(tick - self._start)
            where = self._place()
            place = "" if where is None else f", {where.for_people()}"
            raise FirmwareError(f"{who}{place}, at {at}: {note.text} [{note.source}]")
