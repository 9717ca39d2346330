"""I2CDRR read without a byte in it: none ever came, or the last one was read before."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CDRR, I2CFFRX, I2CMDR, I2CSTR
from ..lint_finding import Fault, Options, accesses, held
from ..run import Run

SAYS = "I2CDRR read with RRDY = 0: no byte came since the read before"
SOURCE = "SPRUG03B table 10 (RRDY), table 19"
TEXT = "reads I2CDRR while RRDY = 0: no byte came since it was read last"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in accesses(run, "R", I2CDRR):
        of = group.unit, group.module
        changes = run.changes(*of, I2CSTR, I2CSTR["RRDY"])
        last = np.append(changes, -1)[np.searchsorted(changes, group.rows) - 1]
        empty = ~held(run, group, I2CSTR, "RRDY")
        # A byte whose RRDY was cleared by a write, or by a reset, may be read still.
        by_read = (last < 0) | np.isin(run.made_by(last), group.rows)
        plain = ~held(run, group, I2CFFRX, "RXFFRST")
        enabled = held(run, group, I2CMDR, "IRS")
        rows = group.rows[empty & by_read & plain & enabled]
        yield Fault(group.unit, rows, TEXT, SOURCE)
