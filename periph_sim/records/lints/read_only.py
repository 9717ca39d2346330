"""Writes that try to change a read-only field, which has no effect.

A write that writes back the value of the field, as every bit-field assignment does, is no fault; nor is a write of 0.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...core.registers import Cpu
from ..lint_finding import Fault, Options
from ..lost_flags import pairs
from ..run import Run

SAYS = "a write that sets a read-only field to what it does not hold"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    value = run.table.value
    for group in run.accesses:
        fields = [f for f in group.register.fields if f.cpu is Cpu.R]
        if group.way != "W" or not fields:
            continue
        reads, writes = pairs(run, group)
        for f in fields:
            wanted = f.mask & value[group.rows]
            held = f.mask & np.array(run.values(group.unit, group.module, group.register, f, group.rows)) << f.lsb
            at = np.searchsorted(group.rows, writes)
            held[at] = value[reads] & f.mask  # a field that changes between read and write is given back as it was read
            rows = group.rows[(wanted != 0) & (wanted != held)]
            if len(rows):
                name = f"{group.module}.{group.register.name}.{f.name}"
                yield Fault(group.unit, rows, f"writes {name}, which is read-only", group.register.source)
