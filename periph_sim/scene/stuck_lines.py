"""Lines of the bus that stay low: a sentence for each report of such a line, and whether the run hangs.

controller agent; if there is none, StuckWatch, if `stuck` is measured --wire--> StuckLines --> sentences
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..processor.source_location import InstructionLocation, SourceLocation

if TYPE_CHECKING:
    from ..core.kernel import Kernel
    from ..core.time import Timebase
    from ..core.wire import Wire
    from ..devices.sensor_head import SensorHead
    from ..processor.dsp import Dsp


class StuckLines:
    """Sentences about lines that stayed low. head: the controller agent, or None."""

    def __init__(self, kernel: Kernel, timebase: Timebase, start: int, units: Mapping[str, Dsp]) -> None:
        self.sentences: list[str] = []
        self.head: SensorHead | None = None
        self._kernel = kernel
        self._timebase = timebase
        self._start = start
        self._units = units
        self._wire: Wire | None = None  # the line that was reported last; None without a controller agent
        self._after_rounds = 0  # number of rounds that were over at the last report

    def report(self, wire: Wire) -> None:
        who = " and ".join(wire.held_by()) or "no party"
        at = self._timebase.show(self._kernel.now - self._start)
        each = "; ".join(f"{name} {doing(dsp, self._timebase, self._start)}" for name, dsp in self._units.items())
        self.sentences.append(f"{wire.name} is held low by {who} at {at}: {each}")
        if self.head is not None:
            self._wire, self._after_rounds = wire, self.head.rounds

    def hangs(self) -> bool:
        """Return True if the controller still waits for the line that was reported last.

        This is so if it is still in the round of the report, and another party holds the line low. Return False if
        there is no controller agent.
        """
        wire, head = self._wire, self.head
        if wire is None or head is None or head.at_rest or head.rounds != self._after_rounds:
            return False
        return any(who != head.who for who in wire.held_by())


def doing(dsp: Dsp, timebase: Timebase, start: int) -> str:
    """Return a phrase that says what a unit's firmware does now. start: the tick from which times are counted."""
    if dsp.program.returned_at is not None:
        return "has returned from main"
    found = dsp.program.unanswered_wait()  # the wait in progress, even while a service routine interrupts it
    if found is not None:
        return waits(found.what, found.place, timebase.show(dsp.clock.tick(found.since) - start))
    spin = dsp.program.spin
    if spin is None:
        where = dsp.processor.causing_statement()
        at = "" if where is None else f" at {where.for_people()}"
        return f"waits in IDLE for an interrupt{at}" if dsp.core.idlestat else f"computes{at}"
    since = timebase.show(dsp.clock.tick(spin.since) - start)
    return waits(dsp.program.awaited().what, dsp.program.place(), since)


def waits(what: str, where: SourceLocation | None, since: str) -> str:
    """Return a phrase that says for what firmware waits, where, and since when.

    what: a phrase that names what the firmware waits for; "" if the firmware is in a loop that nothing ends.
    where: the place of the wait; shown only if it is an instruction of an image.
    since: the time at which the wait began, as text.
    """
    at = f" at {where}" if isinstance(where, InstructionLocation) else ""
    return f"{f'waits for {what}' if what else 'is in an endless loop'}{at} since {since}"
