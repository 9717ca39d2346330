"""All channels of a capture as one list of changes in order of time, for writers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .capture import Capture, Channel, Levels, Positions

UNKNOWN = 2


class Changes(NamedTuple):
    """From `at[i]` on, channel number `which[i]` is at `states[i]`: 0, 1 or UNKNOWN. Sorted by both."""

    at: Positions
    which: NDArray[np.int64]
    states: Levels


def changes(capture: Capture) -> Changes:
    """Merge the channels. The first `len(channels)` entries are the states at position 0; the others are changes."""
    each = [_states(channel, capture.length) for channel in capture.channels]
    at = np.concatenate([np.empty(0, np.int64), *(positions for positions, _ in each)])
    states = np.concatenate([np.empty(0, np.uint8), *(values for _, values in each)])
    which = np.repeat(np.arange(len(each)), [len(positions) for positions, _ in each])
    order = np.lexsort((which, at))
    return Changes(at[order], which[order], states[order])


def _states(channel: Channel, length: int) -> tuple[Positions, Levels]:
    """Return one channel's positions, from 0 on, and the state from each on; no state repeats."""
    begins = np.array([span.begin for span in channel.unknown], np.int64)
    ends = np.array([span.end for span in channel.unknown if span.end < length], np.int64)
    at = np.unique(np.concatenate([np.zeros(1, np.int64), channel.edges, begins, ends]))
    states = channel.at(at)
    hole = np.searchsorted(begins, at, side="right") - 1
    spans = np.array([span.end for span in channel.unknown] or [0], np.int64)
    states[(hole >= 0) & (at < spans[hole])] = UNKNOWN
    kept = np.append(True, states[1:] != states[:-1])
    return at[kept], states[kept]
