"""Measured times against the limits: a verdict for each.

    Measures + LIMITS + Resolution --> one Row per limit --> a Report, see report.py

A time is measured with an error. It passes if all its possible true values keep the limit, fails if none does, and is
undecidable otherwise. A row fails if any of its times fails, else it is undecidable if any is, else it passes.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ..decode.i2c import Party
from .limits import LIMITS, Bounds, Limit, Mode
from .measure import PARTY, Flags, Measured, Measures
from .resolution import Resolution

PLACES = 3  # number of worst places that a row lists


class Verdict(Enum):
    PASS = "pass"
    FAIL = "fail"
    UNDECIDABLE = "undecidable at this sample rate"
    NOT_SEEN = "does not occur"
    NOT_JUDGED = "not judged: nothing was measured"  # verdict of a whole trace
    NO_LIMIT = "no limit in this mode"
    NOT_IN_CAPTURE = "not in a logic capture"


@dataclass(frozen=True)
class Occurrence:
    """A measured time that breaks its limit or may break it. at: the position where it begins. length: in positions."""

    at: int
    length: int
    party: Party | None


@dataclass(frozen=True)
class Row:
    """The verdict on one limit.

    least, most: the shortest and the longest time, in positions; None if nothing was measured.
    failed, undecided: numbers of times with this verdict.
    excused: the number of times beyond a maximum that does not apply to them.
    unsure: the number of undecided times that are beyond a limit which may not apply to them.
    worst: the worst places, the worst one first.
    """

    limit: Limit
    bounds: Bounds
    count: int
    least: int | None
    most: int | None
    verdict: Verdict
    failed: int = 0
    undecided: int = 0
    excused: int = 0
    unsure: int = 0
    worst: tuple[Occurrence, ...] = ()


def judge(measures: Measures, mode: Mode, resolution: Resolution) -> tuple[Row, ...]:
    """Return one row for each limit, in the order of the specification's table."""
    return tuple(_row(limit, measures, mode, resolution) for limit in LIMITS)


def _row(limit: Limit, measures: Measures, mode: Mode, resolution: Resolution) -> Row:
    found = measures.times.get(limit.symbol)
    bounds = limit.bounds[mode]
    if not limit.seen:
        return Row(limit, bounds, 0, None, None, Verdict.NOT_IN_CAPTURE)
    if bounds == Bounds():
        return Row(limit, bounds, 0, None, None, Verdict.NO_LIMIT)
    # A pulse that is shorter than a sample may lie between two samples.
    hidden = measures.blind or (limit.symbol == "tSP" and resolution.period > (bounds.most or 0))
    if found is None or not len(found.lengths):
        return Row(limit, bounds, 0, None, None, Verdict.UNDECIDABLE if hidden or measures.coarse else Verdict.NOT_SEEN)
    return _judged(limit, bounds, found, resolution, hidden, measures.coarse)


def _judged(limit: Limit, bounds: Bounds, found: Measured, resolution: Resolution, hidden: bool, coarse: bool) -> Row:
    lengths = found.lengths
    kept = np.ones(len(lengths), np.bool_)
    broken = np.zeros(len(lengths), np.bool_)
    excused = 0
    if bounds.least is not None:
        kept &= lengths >= resolution.surely_at_least(bounds.least)
        broken |= lengths <= resolution.surely_below(bounds.least)
    if bounds.most is not None:
        within = lengths <= resolution.surely_at_most(bounds.most)
        excused = int((found.excused & ~within).sum())
        kept &= within | found.excused
        if not (hidden or coarse):  # otherwise the time may be too long because edges in between were missed
            broken |= (lengths >= resolution.surely_above(bounds.most)) & ~found.excused
    unsure = int((broken & found.doubtful).sum())
    broken &= ~found.doubtful
    failed, undecided = int(broken.sum()), int((~kept & ~broken).sum())
    if failed:
        verdict, culprits = Verdict.FAIL, broken
    else:
        verdict = Verdict.UNDECIDABLE if undecided or hidden else Verdict.PASS
        culprits = ~kept
    worst = _worst(found, culprits, bounds, resolution)
    least, most = int(lengths.min()), int(lengths.max())
    return Row(limit, bounds, len(lengths), least, most, verdict, failed, undecided, excused, unsure, worst)


def _worst(found: Measured, culprits: Flags, bounds: Bounds, resolution: Resolution) -> tuple[Occurrence, ...]:
    """Return the worst of the times in the mask `culprits`: those furthest beyond the limit, or nearest to it."""
    which = np.flatnonzero(culprits)
    lengths = found.lengths[which]
    beyond = np.full(len(which), np.iinfo(np.int64).min)
    if bounds.least is not None:
        beyond = np.maximum(beyond, resolution.surely_at_least(bounds.least) - lengths)
    if bounds.most is not None:
        beyond = np.maximum(beyond, lengths - resolution.surely_at_most(bounds.most))
    order = which[np.argsort(-beyond, kind="stable")[:PLACES]]
    return tuple(
        Occurrence(int(found.begins[k]), int(found.lengths[k]), PARTY[int(found.party[k])]) for k in order.tolist()
    )
