"""A slave that treats XRDY = 1 as a read request: it loads I2CDXR although no master reads from it.

XRDY is 1 in idle, so firmware has to read SDIR or AAS too. The fault is judged by its result: the last read of XRDY
before a write of I2CDXR showed XRDY = 1 and SDIR = 0, and SDIR was still 0 at the write, as slave and not in FIFO mode.
Firmware that checks SDIR would not have written. Only reads of XRDY or of the whole register since the previous write
of I2CDXR count. A byte that is loaded without such a read is no fault of this kind, nor is a write after which the
firmware becomes master (its next write of I2CMDR has MST = 1). If the firmware itself cleared SDIR since it was
addressed, that is reported instead.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CDXR, I2CFFTX, I2CMDR, I2CSTR
from ..lint_finding import Fault, Options, accesses, held
from ..read_modify_write import read_modify_writes
from ..run import Group, Rows, Run

SAYS = "XRDY polled without SDIR or AAS being looked at: I2CDXR loaded as slave though SDIR was read as 0"
SOURCE = "SPRUG03B table 10 (XRDY, SDIR, AAS), table 8 (BCM)"
TEXT = "loads I2CDXR as slave on XRDY alone: its last look at it showed SDIR = 0, so no master was reading yet"
WIPED = (
    "loads I2CDXR as slave with SDIR = 0 though a master reads: the firmware itself cleared SDIR in this transfer, "
    "by writing I2CSTR at {}"
)


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in accesses(run, "W", I2CDXR):
        reads = run.accesses_of(group.unit, "R", group.module, I2CSTR.name)
        looks = run.looking_at(np.setdiff1d(reads, read_modify_writes(run, group.unit).reads), I2CSTR["XRDY"])
        last = np.append(looks, -1)[np.searchsorted(looks, group.rows) - 1]
        seen = np.where(last > np.append(-1, group.rows[:-1]), run.table.value[last], 0)
        modes = run.accesses_of(group.unit, "W", group.module, I2CMDR.name)
        mode_after = np.append(run.table.value[modes], 0)[np.searchsorted(modes, group.rows)]
        master = held(run, group, I2CMDR, "MST") | (mode_after & I2CMDR["MST"].mask != 0)
        slave = held(run, group, I2CMDR, "IRS") & ~master & ~held(run, group, I2CMDR, "FDF")
        alone = (seen & I2CSTR["XRDY"].mask != 0) & (seen & I2CSTR["SDIR"].mask == 0)
        alone &= ~held(run, group, I2CSTR, "SDIR")
        found = np.flatnonzero(alone & slave & ~held(run, group, I2CFFTX, "I2CFFEN"))
        rows, by = group.rows[found], _wiped_by(run, group)[found]
        if (by < 0).any():
            yield Fault(group.unit, rows[by < 0], TEXT, SOURCE)
        for spot, writes in run.by_place(np.unique(by[by >= 0])):
            yield Fault(group.unit, rows[np.isin(by, writes)], WIPED.format(spot), SOURCE)


def _wiped_by(run: Run, group: Group) -> Rows:
    """Return for each access the firmware's write that cleared SDIR since the module was addressed, or -1."""
    value = run.table.value
    changes = run.changes(group.unit, group.module, I2CSTR, I2CSTR["SDIR"])
    addressed = run.changes(group.unit, group.module, I2CSTR, I2CSTR["AAS"])
    last = np.append(changes, -1)[np.searchsorted(changes, group.rows) - 1]
    since = np.append(addressed, -1)[np.searchsorted(addressed, group.rows) - 1]
    writes = run.accesses_of(group.unit, "W", group.module, I2CSTR.name)
    by = np.where(last >= 0, run.made_by(last), -1)
    here = (last > since) & (since >= 0) & (value[last] == 0) & (value[since] == 1) & np.isin(by, writes)
    return np.where(here, by, -1)
