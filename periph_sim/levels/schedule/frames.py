"""The host's frames of many scenarios: inputs go in; when each begins, and its interrupt is latched, comes out.

    paced by schedule   begin(n) = first + floor(n * period) + late(n)
    paced by pause      begin(n) = begin(n - 1) + floor(period) + late(n)         late: drawn as `devices.host_pc` does

Row by row, since a row of all scenarios stays in the CPU's cache, and all rows do not.
"""

from __future__ import annotations

import numpy as np

from .clock import Ints
from .draws import Drawn
from .inputs import Inputs
from .lanes import FAR
from .structure import Structure


def frames(structure: Structure, inputs: Inputs) -> tuple[Ints, Ints]:
    """(begins, latches) of all frames of the longest run.

    int64[frames, scenarios], ticks; int64[frames + 1, scenarios], cycles, the last of which never comes.
    """
    pause = structure.host.paced_by == "pause"
    period = inputs.frame.down(1)
    count = max(1, int((np.max(inputs.end) - np.min(inputs.host_first)) // np.min(period)) + 2)
    late = None
    if inputs.host_jitter:
        late = Drawn(inputs.seeds, inputs.host_jitter + 1, count, lambda seed: seed + 1)
    begun = np.empty((count, inputs.scenarios), np.int64)
    latches = np.empty((count + 1, inputs.scenarios), np.int64)
    before = inputs.host_first
    for number in range(count):
        row = begun[number]
        if pause:
            row[:] = before + period if number else before
            before = row
        else:
            np.add(inputs.host_first, inputs.frame.down(number), out=row)
        if late is not None:
            row += late.row(number)
        structure.receiver.latch(inputs.clock, row, latches[number])
    latches[-1] = FAR
    return begun, latches
