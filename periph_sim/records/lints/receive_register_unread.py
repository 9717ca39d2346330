"""Bytes came in, but I2CDRR was never read; the place is the one that saw RRDY = 1 first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...core.records import Kind
from ...f28335.i2c.register_map import I2CDRR, I2CSTR
from ..lint_finding import Fault, Options
from ..run import Run

SAYS = "I2CDRR never read though RRDY rose"
SOURCE = "SPRUG03B table 10 (RRDY, RSFULL), table 19"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for unit, modules in run.units.items():
        for module in (module for module in modules if module.startswith("I2C")):
            rises = run.changes(unit, module, I2CSTR, I2CSTR["RRDY"])
            rises = rises[run.table.value[rises] == 1]
            if not len(rises) or len(run.accesses_of(unit, "R", module, I2CDRR.name)):
                continue
            reads = run.accesses_of(unit, "R", module, I2CSTR.name)
            saw = reads[run.table.value[reads] & I2CSTR["RRDY"].mask != 0]
            rows = saw if len(saw) else run.rows(Kind.ACCESS, unit)
            times = f"{len(rises)} time{'s' * (len(rises) != 1)}"
            yield Fault(unit, np.array(rows[:1]), f"{module}.I2CDRR is never read, though RRDY rose {times}", SOURCE)
