"""Choice of the phases to run: every cycle near the firmware's writes, and steps of several cycles elsewhere.

    interrupts of a frame at phase p:             p + delay          (the delays are observed in a few rounds)
    writes of registers in a round:               -----w---w--w-----
    phases at which an interrupt is near a write: --fffffffffffff---  run cycle by cycle

If an interrupt comes during a wait or a computation, and its service routine ends before the next event, then a
difference of one cycle does not change the order of events. Near a write, a difference of one cycle can change it.
The choice of phases is not part of any claim: reports say which phases were run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

from ..core.records import Kind, Record
from .stretch import RUN_ERRORS, CoveredCase

BEFORE, AFTER = 400, 60  # "near": an interrupt comes at most 400 cycles before a write, or 60 after it
# If more than MAX_NEAR phases are near a write, the writes are not considered. Some firmware writes registers at each
# edge of the bus.
MAX_NEAR = 100_000
OBSERVED = 8  # number of phases at which a round with a frame is observed; they are evenly spaced
# Two entries of service routines, in two rounds, count as the same one if their times since the start of the frame
# differ by less than SAME cycles.
SAME = 400
WRITE = "W "  # the texts of records of writes begin with this


class Observed:
    """The writes and interrupts of a few rounds that were run. All times are in cycles.

    writes: the times of all writes of registers, each from the start of its round.
    delays: the times from the start of a frame to the entries of service routines. Rounds without any such entry are
        ignored, and an entry counts only if all other rounds have an entry at about the same time.
    """

    def __init__(self, covered: CoveredCase) -> None:
        phases, count = covered.phases, covered.phases.count
        chosen = [number * count // OBSERVED for number in range(OBSERVED)]
        kinds, records = [Kind.ACCESS, Kind.IRQ], list[Record]()
        scene = covered.scene_of(
            *phases.inputs(chosen), covered.case.seed, lambda recorder, _: recorder.subscribe(kinds, records.append)
        )
        with suppress(*RUN_ERRORS):  # after an error, the rounds before it are used
            scene.run()
        starts = phases.starts([*chosen, chosen[-1]])
        self.writes: set[int] = set()
        entries: list[list[int]] = [[] for _ in chosen]
        for record in records:
            number = sum(start <= record.tick for start in starts) - 1
            if record.kind is Kind.ACCESS and record.what.startswith(WRITE) and record.tick >= phases.due(0):
                self.writes.add(phases.cycles_after_due(record.tick))
            elif record.kind is Kind.IRQ and record.text and 0 <= number < OBSERVED:
                entries[number].append((record.tick - starts[number]) // phases.cycle)
        first, *others = [one for one in entries if one] or entries
        self.delays = [one for one in first if all(any(abs(one - each) < SAME for each in other) for other in others)]

    def near(self, count: int) -> set[int]:
        """Return the phases at which an interrupt of a frame is near a write. count: the number of all phases."""
        middles = [write - delay for write in self.writes for delay in self.delays]
        return {at % count for middle in middles for at in range(middle - BEFORE, middle + AFTER + 1)}


def chosen_phases(covered: CoveredCase, step: int, bounds: tuple[int, int]) -> tuple[list[int], int]:
    """Return the phases to run, in ascending order, and how many of them are near a write.

    Phases near a write are searched only if `step` is above 1, and the case has both frames and rounds. If there are
    more than MAX_NEAR of them, they are not chosen, and the number is 0.

    step: the distance between the other phases, in cycles.
    bounds: the first and the last phase that may be run. Both are chosen.
    """
    first, last = bounds
    near: set[int] = set()
    if step > 1 and covered.phases.is_relative:
        near = {phase for phase in Observed(covered).near(covered.phases.count) if first <= phase <= last}
    if len(near) > MAX_NEAR:
        near = set()
    return sorted({*near, *range(first, last + 1, step), last}), len(near)


def parts_of(phases: Sequence[int], size: int) -> Iterator[list[int]]:
    """Yield the phases in order, in lists of at most `size` phases."""
    for first in range(0, len(phases), size):
        yield list(phases[first : first + size])
