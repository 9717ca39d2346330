"""Reconstruction of skipped polls next to a change, from the recorded passes of a wait.

A pass is one execution of the body of a polling loop. A recording contains only the first and the last passes of a
skipped wait; the time between them is a gap in the recording. All passes are equally long, so the skipped polls follow
each other at a constant period. The recorded passes show this period. If the first read after the gap fits the period,
the gap is assumed to be a skipped wait, and the polls on both sides of a change are reconstructed.

    first pass, . . . . . . [change] . , last pass
                          ^before    ^after
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from .run import Rows, Run

NDBool = NDArray[np.bool_]
Number = TypeVar("Number", np.int64, np.bool_)

SHORTEST_PASS, LONGEST_PASS = 4, 400  # minimum and maximum cycles of a pass of a polling loop
MOST_READS = 3  # maximum number of reads of one register in a pass
# The length of a pass is assumed to be the most frequent length of the recorded passes. The assumption is used only if
# the lengths of enough recorded passes are multiples of it: more than the share PASSES_AGREE if a pass has one read,
# more than MORE_AGREE if it has several. Besides, at least the share GAPS_AGREE of the changes must be in gaps that fit
# the assumed length.
PASSES_AGREE, MORE_AGREE, GAPS_AGREE = 0.75, 0.6, 0.75
# If no recorded pass is at most LONGEST_PASS long, all are gaps, and the loop is assumed to have one read per pass. The
# greatest common divisor of the gaps is then the length of a pass, if there are at least FEW_GAPS gaps.
FEW_GAPS = 3


class Polls(NamedTuple):
    """The reconstructed polls next to changes in skipped waits.

    ticks: the ticks of the polls, each once and in order: the last skipped poll before a change in the same gap, and
        the first skipped poll at or after the change.
    unplaced: an entry for each gap in which a change occurred, and whose polls could not be reconstructed. The entry is
        the index, in the argument `reads` of `skipped_polls`, of the last read before the gap.
    """

    ticks: Rows
    unplaced: Rows


def skipped_polls(run: Run, unit: str, reads: Rows, waits: NDBool, changes: Rows, looking: NDBool) -> Polls:
    """Return the polls in skipped waits that are next to a change.

    reads: rows of the reads of one register at one place.
    waits: for each read, True if it and the next read in `reads` belong to the same wait.
    changes: rows of the changes to consider.
    looking: for each read, True if it read the fields that changed. A loop may also have reads of other fields; the
        polls of these reads are not returned.
    """
    clock = run.clock(unit)
    begins = clock.numbers(run.table.tick[reads])  # in cycles, because a cycle need not be a whole number of ticks
    gaps = np.where(waits, np.diff(begins, append=begins[-1:]), 0)
    places = np.searchsorted(reads, changes) - 1
    inside = (places >= 0) & (places < len(reads) - 1)
    changes, places = changes[inside], places[inside]
    inside = waits[places]
    changes, places = changes[inside], places[inside]
    if not len(changes):
        return Polls(changes, changes)
    best: tuple[int, int, NDBool] | None = None
    for in_pass in range(1, MOST_READS + 1):
        period = _period(begins, waits, gaps, in_pass)
        if not period:
            continue
        fits: NDBool = np.zeros(len(reads), bool)
        for back in range(in_pass):
            fits |= waits & _within(waits, back) & ((begins + gaps - _shifted(begins, back)) % period == 0)
        if best is None or fits[places].sum() > best[2][places].sum():
            best = in_pass, period, fits
    if best is None or best[2][places].mean() < GAPS_AGREE:
        return Polls(changes[:0], np.unique(places[gaps[places] > 0]))
    in_pass, period, fits = best
    unplaced = np.unique(places[~fits[places] & (gaps[places] > period)])
    chosen = fits[places] & (gaps[places] > period // in_pass)
    changes, places = changes[chosen], places[chosen]
    at = clock.numbers(run.table.tick[changes])
    ends = begins[places] + gaps[places]
    before, after = np.full(len(at), -1), ends.copy()
    for back in range(in_pass):
        anchor = _shifted(begins, back)[places]
        theirs = _within(waits, back)[places] & _shifted(looking, back)[places]
        last = anchor + (at - 1 - anchor) // period * period
        before = np.where(theirs & (last > anchor), np.maximum(before, last), before)
        after = np.where(theirs, np.minimum(after, last + period), after)
    after = np.where(after == ends, -1, after)
    numbers = np.unique(np.concatenate([before, after]))
    return Polls(np.array([clock.tick(number) for number in numbers[numbers >= 0].tolist()], np.int64), unplaced)


def _period(begins: Rows, waits: NDBool, gaps: Rows, in_pass: int) -> int:
    """Return the length of one pass of the polling loop in cycles.

    Return 0 if the recording does not show the length, or if it is not between SHORTEST_PASS and LONGEST_PASS.

    begins: the cycle of each read of the loop.
    waits: for each read, True if it and the next read belong to the same wait.
    gaps: for each read, the number of cycles to the next read of the same wait; 0 if there is none.
    in_pass: the assumed number of reads in a pass.
    """
    whole = _within(waits, in_pass)
    lengths = (begins - _shifted(begins, in_pass))[whole]
    short = lengths[(lengths > 0) & (lengths <= LONGEST_PASS)]
    if len(short):
        values, counts = np.unique(short, return_counts=True)
        period = int(values[np.argmax(counts)])
        alike = float((short % period == 0).mean()) > (PASSES_AGREE if in_pass == 1 else MORE_AGREE)
        return period if alike and period >= SHORTEST_PASS else 0
    if in_pass == 1 and (gaps > 0).sum() >= FEW_GAPS:
        period = int(np.gcd.reduce(gaps[gaps > 0]))
        return period if SHORTEST_PASS <= period <= LONGEST_PASS else 0
    return 0


def _shifted(column: NDArray[Number], back: int) -> NDArray[Number]:
    """Return the column shifted by `back` places towards the end. The first value is repeated at the start."""
    return column if not back else np.concatenate([column[:1].repeat(min(back, len(column))), column[:-back]])


def _within(waits: NDBool, back: int) -> NDBool:
    """Return, for each read, True if the `back` reads before it belong to the same wait."""
    found = np.ones(len(waits), bool)
    for step in range(1, back + 1):
        found &= np.concatenate([np.zeros(min(step, len(waits)), bool), waits[:-step]])
    return found
