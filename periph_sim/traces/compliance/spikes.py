"""Removal of spikes from SCL and SDA, as the filter of an I2C input does it.

          _____   __________          ________________
    SCL        |_|            -->                       and one spike, two positions wide

A level that lasts no longer than a spike may last is removed. The rest keeps its place: of an edge that rings, the
last one counts. Definition of a spike: `limits.SPIKE`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..capture.capture import Channel, Positions
from .limits import LIMIT, SPIKES_TO, Mode
from .resolution import Resolution


def without_spikes(
    scl: Channel, sda: Channel, mode: Mode, resolution: Resolution
) -> tuple[Channel, Channel, Positions, Positions]:
    """Return (SCL, SDA, begins of spikes, their lengths). In Standard-mode, which has no filter, nothing is a spike.

    Only what surely is a spike at this resolution is one.
    """
    most = LIMIT["tSP"].bounds[mode].most
    none = np.zeros(0, np.int64)
    if most is None:
        return scl, sda, none, none
    short, long = resolution.surely_at_most(most), resolution.surely_at_most(SPIKES_TO * most)
    clock, clock_begins, clock_lengths = _filtered(scl, _lengths(scl) <= long)
    lengths = _lengths(sda)
    ends = sda.edges + lengths
    falls = np.append(clock.edges[clock.levels == 0], np.iinfo(np.int64).max)
    next_fall = falls[np.searchsorted(falls, sda.edges)]
    high = (clock.before(sda.edges) == 1) & (clock.at(sda.edges) == 1) & (ends < next_fall)
    data, data_begins, data_lengths = _filtered(sda, (lengths <= short) | high & (lengths <= long))
    begins = np.concatenate((clock_begins, data_begins))
    order = np.argsort(begins, kind="stable")
    return clock, data, begins[order], np.concatenate((clock_lengths, data_lengths))[order]


def _lengths(channel: Channel) -> Positions:
    """Return the duration of the level after each edge; the last one holds for ever."""
    return np.append(np.diff(channel.edges), np.iinfo(np.int64).max // 2)[: len(channel.edges)]


def _filtered(channel: Channel, short: NDArray[np.bool_]) -> tuple[Channel, Positions, Positions]:
    """Return the channel without the levels that are too short, and their begins and lengths."""
    if not short.any():
        return channel, channel.edges[:0], channel.edges[:0]
    edges, levels = channel.edges[~short], channel.levels[~short]
    before = np.concatenate((np.array([channel.initial], np.uint8), levels))[:-1]
    real = levels != before
    left = Channel(channel.name, channel.index, channel.initial, edges[real], levels[real], channel.unknown)
    return left, channel.edges[short], _lengths(channel)[short]
