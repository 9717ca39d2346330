"""Glitch filter: removes pulses that are too short from a Channel.

    shortest = 3     __-_______----____        __________----____
                     __--_-____----____   -->  __________----____
                     __--_-----___-____        ______----________   the last edge of a bounce stays

A pulse is dropped with both its edges, from left to right; of a run of short pulses that leaves the line at
the other level, the last edge stays. The levels before the first edge and after the last are no pulses: their
lengths are unknown.
"""

from __future__ import annotations

import numpy as np

from ..capture.capture import Channel, channel_of_edges


def without_glitches(line: Channel, shortest: int) -> Channel:
    """Return the line without pulses of fewer than `shortest` positions, high or low. It must be known throughout."""
    if shortest <= 1 or len(line.edges) < 2:
        return line
    near = np.diff(line.edges) < shortest  # edge n and n + 1 bound a short pulse
    if not near.any():
        return line
    first = np.concatenate(([True], ~near))  # edges that begin a run of edges close to each other
    last = np.concatenate((~near, [True]))
    begins, ends = np.flatnonzero(first), np.flatnonzero(last)
    kept = ends[(ends - begins) & 1 == 0]
    return channel_of_edges(line.name, line.index, line.initial, line.edges[kept])
