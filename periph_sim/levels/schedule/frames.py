"""The host's frames of many scenarios: inputs go in; when each ends, and its interrupt is latched, comes out.

paced by schedule   begin(n) = first + floor(n * period) + late(n)
paced by pause      begin(n) = begin(n - 1) + floor(period) + late(n)         late: drawn as `devices.host_pc` does
"""

from __future__ import annotations

import numpy as np

from .clock import Ints
from .draws import drawn
from .inputs import Inputs
from .lanes import FAR
from .structure import Structure


def begins(structure: Structure, inputs: Inputs) -> Ints:
    """int64[frames, scenarios], ticks, of all frames that begin in the longest run."""
    pause = structure.host.paced_by == "pause"
    period = inputs.frame.down(1)
    count = int((np.max(inputs.end) - np.min(inputs.host_first)) // np.min(period)) + 2
    count = max(count, 1)
    numbers = np.arange(count, dtype=np.int64)[:, None]
    due = inputs.host_first + (numbers * period if pause else inputs.frame.down(numbers))
    if not inputs.host_jitter:
        return due + np.zeros((1, inputs.scenarios), np.int64)
    late = drawn(inputs.seeds, inputs.host_jitter + 1, count, lambda seed: seed + 1)
    if pause:
        np.cumsum(late, axis=0, out=late)
    late += due
    return late


def latches(structure: Structure, inputs: Inputs, begun: Ints) -> Ints:
    """int64[frames + 1, scenarios], cycles; the last one never comes."""
    found = np.empty((len(begun) + 1, begun.shape[1]), np.int64)
    found[:-1] = structure.receiver.latch(inputs.clock, begun)
    found[-1] = FAR
    return found
