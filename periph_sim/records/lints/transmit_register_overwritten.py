"""I2CDXR written again in the same transfer while the byte before still waits in it (XRDY = 0): that byte is lost.

In FIFO mode XRDY does not tell whether a byte can be taken; there nothing is judged.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CDXR, I2CFFTX, I2CMDR, I2CSTR
from ..lint_finding import Fault, Options, accesses, held
from ..run import Run

SAYS = "I2CDXR written twice in a transfer with XRDY = 0 in between"
SOURCE = "SPRUG03B table 10 (XRDY), table 20"
TEXT = "writes I2CDXR while XRDY = 0: the byte written before was not taken yet, and is overwritten"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in accesses(run, "W", I2CDXR):
        before = np.append(-1, group.rows[:-1])
        of = group.unit, group.module
        waits = ~held(run, group, I2CSTR, "XRDY")
        plain = ~held(run, group, I2CFFTX, "I2CFFEN")
        enabled = held(run, group, I2CMDR, "IRS")
        ready = run.changes(*of, I2CSTR, I2CSTR["XRDY"])
        others = [run.changes(*of, I2CSTR, I2CSTR[name]) for name in ("AAS", "BB")]
        news = np.sort(np.concatenate([ready[run.table.value[ready] == 1], *others]))
        still = np.searchsorted(news, group.rows) == np.searchsorted(news, before)
        rows = group.rows[(before >= 0) & waits & plain & enabled & still]
        yield Fault(group.unit, rows, TEXT, SOURCE)
