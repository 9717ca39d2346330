"""The host's frames of many scenarios: inputs go in; when each begins, and its interrupt is latched, comes out.

    paced by schedule   begin(n) = first + floor(n * period) + late(n)
    paced by pause      begin(n) = begin(n - 1) + floor(period) + late(n)         late: drawn as `devices.host_pc` does

Row by row, since a row of all scenarios stays in the CPU's cache, and all rows do not.
"""

from __future__ import annotations

import numpy as np

from .draws import Drawn
from .inputs import Inputs
from .lanes import FAR
from .stored import Stored
from .structure import Structure


def count_of(inputs: Inputs) -> int:
    """Frames that any of the scenarios may have."""
    period = np.min(inputs.frame.down(1))
    return max(1, int((np.max(inputs.end) - np.min(inputs.host_first)) // period) + 2)


def frames(structure: Structure, inputs: Inputs) -> tuple[Stored, Stored]:
    """(begins in ticks, latches in cycles) of all frames of the longest run, and a latch that never comes."""
    pause = structure.host.paced_by == "pause"
    period = inputs.frame.down(1)
    count = count_of(inputs)
    late = None
    if inputs.host_jitter:
        late = Drawn(inputs.seeds, inputs.host_jitter + 1, count, lambda seed: seed + 1)
    last = max(int(np.max(inputs.end)), int(np.max(inputs.host_first)))  # the first frame is there in any case
    last += inputs.clock.most(int(inputs.cost[1].max()))  # models that are begun are worked out to their end
    longest = last + 2 * int(np.max(period)) + inputs.line.end + inputs.host_jitter * (count + 1)
    begun = Stored(count, inputs.scenarios, longest)
    latches = Stored(count + 1, inputs.scenarios, longest)  # cycles are no more than ticks
    row, latch = np.zeros(inputs.scenarios, np.int64), np.empty(inputs.scenarios, np.int64)
    for number in range(count):
        if pause:
            row += period if number else inputs.host_first
        else:
            np.add(inputs.host_first, inputs.frame.down(number), out=row)
        if late is not None:
            row += late.row(number)
        begun.put(number, row)
        latches.put(number, structure.receiver.latch(inputs.clock, row, latch))
    latches.put_far(count, FAR)
    return begun, latches
