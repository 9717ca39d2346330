"""I2CPSC written with another value while IRS = 1: the prescaler belongs to the module in reset."""

from __future__ import annotations

from collections.abc import Iterator

from ...f28335.i2c.register_map import I2CMDR, I2CPSC
from ..lint_finding import Fault, Options
from ..run import Run

SAYS = "IPSC changed while IRS = 1"
SOURCE = "SPRUG03B section 1.4 and table 12"
TEXT = "changes I2CPSC.IPSC while I2CMDR.IRS = 1; the module clock does not follow before IRS goes from 0 to 1"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    f = I2CPSC["IPSC"]
    for group in run.accesses:
        if group.way == "W" and group.register is I2CPSC:
            enabled = run.values(group.unit, group.module, I2CMDR, I2CMDR["IRS"], group.rows) == 1
            held = run.values(group.unit, group.module, I2CPSC, f, group.rows)
            rows = group.rows[enabled & (held != run.table.value[group.rows] & f.mask)]
            if len(rows):
                yield Fault(group.unit, rows, TEXT, SOURCE)
