"""Notes on the firmware of one CPU, as records and counts; with `strict`, violated duties as errors."""

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

    counts: the number of occurrences of each note.
    first_at: the tick of the first occurrence.
    places: the statement of the first occurrence, if it is known.
    strict: True if a violated duty ends the run.
    placed: True if writes keep the place that issued them until they land, which costs little in an image.
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
        """place: returns the statement that causes the present action; None if there is none."""
        self.counts: dict[Note, int] = {}
        self.first_at: dict[Note, int] = {}
        self.places: dict[Note, SourceLocation] = {}
        self.strict = self.placed = strict
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._name = name
        self._place = place

    def move_from(self, cycle: int, notes: list[Note]) -> None:
        """Move all notes of a machine here."""
        for note in notes:
            self.note(cycle, note)
        notes.clear()

    def note(self, cycle: int, note: Note) -> None:
        """Count and record a note."""
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
        """Raise FirmwareError for a violated duty if `strict`. who: the module that noted it at this tick."""
        if self.strict and note.code == "duty":
            at = self._clock.timebase.show(tick)
            where = self._place()
            place = "" if where is None else f", {where.for_people()}"
            raise FirmwareError(f"{who}{place}, at {at}: {note.text} [{note.source}]")
