"""The lint of interrupts: groups of the PIE that are not acknowledged."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...core.records import Kind
from ...f28335.pie.register_map import LINES, PIEACK
from ..lint import Fault, Options, finds
from ..run import Run

TEXT = "{} is served, and PIEACK bit {} is not written afterwards: no interrupt of group {} comes any more"


@finds("a service routine after which PIEACK is never written for its group")
def group_not_acknowledged(run: Run, options: Options) -> Iterator[Fault]:
    """Yield entries of service routines that no write of PIEACK follows: their group never interrupts again."""
    for unit in run.units:
        acknowledges = run.accesses_of(unit, "W", "PIE", PIEACK.name)
        for vector, (group, _) in LINES.items():
            rows = run.rows(Kind.IRQ, unit, vector)
            entries, ends = rows[run.table.value[rows] != 0], rows[run.table.value[rows] == 0]
            of_group = acknowledges[run.table.value[acknowledges] >> group - 1 & 1 == 1]
            unanswered = entries[entries > of_group.max(initial=-1)]
            left = np.array([entry for entry in unanswered.tolist() if (ends > entry).any()], np.int64)
            yield Fault(unit, left, TEXT.format(vector, group - 1, group), "SPRUFB0D section 8.3 and table 115")
