"""I2COAR written with another value while the module is on and the bus is busy."""

from __future__ import annotations

from collections.abc import Iterator

from ...f28335.i2c.register_map import I2CMDR, I2COAR, I2CSTR
from ..lint_finding import Fault, Options, accesses, held
from ..run import Run

SAYS = "own address changed in mid-transfer (BB = 1, IRS = 1)"
SOURCE = "SPRUG03B section 4 and table 17"
TEXT = "changes I2COAR while I2CSTR.BB = 1: which address the transfer under way is compared with is not documented"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    f = I2COAR["OAR"]
    for group in accesses(run, "W", I2COAR):
        busy = held(run, group, I2CSTR, "BB")
        enabled = held(run, group, I2CMDR, "IRS")
        kept = run.values(group.unit, group.module, I2COAR, f, group.rows)
        rows = group.rows[busy & enabled & (kept != run.table.value[group.rows] & f.mask)]
        yield Fault(group.unit, rows, TEXT, SOURCE)
