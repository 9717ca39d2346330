"""I2CDXR written again in the same transfer while the byte before still waits in it (XRDY = 0): that byte is lost.

In FIFO mode XRDY does not tell whether a byte can be taken; there nothing is judged.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CDXR, I2CFFTX, I2CMDR, I2CSTR
from ..lint_finding import Fault, Options
from ..run import Run

SAYS = "I2CDXR written twice in a transfer with XRDY = 0 in between"
SOURCE = "SPRUG03B table 10 (XRDY), table 20"
TEXT = "writes I2CDXR while XRDY = 0: the byte written before was not taken yet, and is overwritten"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in run.accesses:
        if group.way != "W" or group.register is not I2CDXR or not len(group.rows):
            continue
        before = np.append(-1, group.rows[:-1])
        of = group.unit, group.module
        waits = run.values(*of, I2CSTR, I2CSTR["XRDY"], group.rows) == 0
        plain = run.values(*of, I2CFFTX, I2CFFTX["I2CFFEN"], group.rows) == 0
        enabled = run.values(*of, I2CMDR, I2CMDR["IRS"], group.rows) == 1
        ready = run.changes(*of, I2CSTR, I2CSTR["XRDY"])
        others = [run.changes(*of, I2CSTR, I2CSTR[name]) for name in ("AAS", "BB")]
        news = np.sort(np.concatenate([ready[run.table.value[ready] == 1], *others]))
        still = np.searchsorted(news, group.rows) == np.searchsorted(news, before)
        rows = group.rows[(before >= 0) & waits & plain & enabled & still]
        if len(rows):
            yield Fault(group.unit, rows, TEXT, SOURCE)
