"""Conversion of the states of one line, in order of time, to a Channel: for readers of many changes.

positions, states 0, 1 or UNKNOWN --> Channel
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from .capture import Channel, Levels, Positions, Span, channel_of_edges
from .changes import UNKNOWN
from .grid import OffGrid, snap


def channel_of_states(name: str, index: int, at: Positions, states: Levels, length: int) -> Channel:
    """Return the same as `channel_of`, by array operations; `at` may repeat a position but never falls.

    Of several states at one position the last counts. An unknown stretch keeps the level before it.
    """
    if len(at):
        last = np.append(at[1:] != at[:-1], True)
        at, states = at[last], states[last]
    changed = np.append(True, states[1:] != states[:-1])[: len(at)]
    at, states = at[changed], states[changed]
    known = states != UNKNOWN
    levels, places = states[known], at[known]
    initial = int(levels[0]) if len(levels) else 1
    edges = places[np.diff(levels, prepend=np.uint8(initial)) != 0]
    ends = np.append(at[1:], length)[: len(at)]
    holes = list(zip(at[~known].tolist(), ends[~known].tolist(), strict=True))
    begin = int(at[0]) if len(at) else length
    if begin and holes and holes[0][0] == begin:
        holes[0] = (0, holes[0][1])
    elif begin:
        holes.insert(0, (0, begin))
    return channel_of_edges(name, index, initial, edges, tuple(Span(*hole) for hole in holes))


def quantized(ticks: Positions, per_second: Fraction, rate: Fraction) -> Positions:
    """Return the same as `snap`, by array operations where the arithmetic fits 64 bits. OffGrid as there."""
    period = per_second / rate
    top, bottom = period.denominator, period.numerator
    if not len(ticks) or 2 * max(int(ticks.max()), 1) * top + bottom >= 1 << 63:
        return np.array(snap(ticks.tolist(), per_second, rate), np.int64)
    samples = (2 * top * ticks + bottom) // (2 * bottom)
    off = ticks * top - samples * bottom  # in ticks / top
    beyond = np.flatnonzero(abs(off) > (0 if top == 1 else top))
    if len(beyond):
        which = int(beyond[0])
        raise OffGrid(which, Fraction(int(off[which]), top))
    return samples
