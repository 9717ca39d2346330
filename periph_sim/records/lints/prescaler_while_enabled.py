"""I2CPSC written with another value while IRS = 1: the prescaler belongs to the module in reset."""

from __future__ import annotations

from collections.abc import Iterator

from ...f28335.i2c.register_map import I2CMDR, I2CPSC
from ..lint_finding import Fault, Options, accesses, held
from ..run import Run

SAYS = "IPSC changed while IRS = 1"
SOURCE = "SPRUG03B section 1.4 and table 12"
TEXT = "changes I2CPSC.IPSC while I2CMDR.IRS = 1; the module clock does not follow before IRS goes from 0 to 1"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    f = I2CPSC["IPSC"]
    for group in accesses(run, "W", I2CPSC):
        enabled = held(run, group, I2CMDR, "IRS")
        kept = run.values(group.unit, group.module, I2CPSC, f, group.rows)
        rows = group.rows[enabled & (kept != run.table.value[group.rows] & f.mask)]
        yield Fault(group.unit, rows, TEXT, SOURCE)
