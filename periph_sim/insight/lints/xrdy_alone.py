"""A slave that takes XRDY = 1 for a master's wish to read: it loads I2CDXR though nobody reads from it.

XRDY is 1 in idle, so SDIR or AAS has to be looked at too. A record of a read has the whole register and not the field
that the firmware looked at; so this is judged by what follows: the last read of I2CSTR before a write of I2CDXR showed
XRDY = 1 and SDIR = 0, and SDIR was 0 still, as slave and not in FIFO mode. Firmware that had looked at SDIR would not
have written. A write after which it makes itself master (its next write of I2CMDR has MST = 1) is none.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...core.registers import Register
from ...f28335.i2c_map import I2CDXR, I2CFFTX, I2CMDR, I2CSTR
from ..finding import Fault, Options
from ..run import Group, Run

SAYS = "XRDY polled without SDIR or AAS being looked at: I2CDXR loaded as slave though SDIR was read as 0"
SOURCE = "SPRUG03B table 10 (XRDY, SDIR, AAS), table 8 (BCM)"
TEXT = "loads I2CDXR as slave on XRDY alone: the last read of I2CSTR showed SDIR = 0, so no master was reading yet"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in run.accesses:
        if group.way != "W" or group.register is not I2CDXR:
            continue
        reads = run.accesses_of(group.unit, "R", group.module, I2CSTR.name)
        if not len(reads):
            continue
        place = np.searchsorted(reads, group.rows) - 1
        seen = np.where(place >= 0, run.table.value[reads[place]], 0)
        modes = run.accesses_of(group.unit, "W", group.module, I2CMDR.name)
        mode_after = np.append(run.table.value[modes], 0)[np.searchsorted(modes, group.rows)]
        master = _held(run, group, I2CMDR, "MST") | (mode_after & I2CMDR["MST"].mask != 0)
        slave = _held(run, group, I2CMDR, "IRS") & ~master & ~_held(run, group, I2CMDR, "FDF")
        alone = (seen & I2CSTR["XRDY"].mask != 0) & (seen & I2CSTR["SDIR"].mask == 0)
        alone &= ~_held(run, group, I2CSTR, "SDIR")
        rows = group.rows[alone & slave & ~_held(run, group, I2CFFTX, "I2CFFEN")]
        if len(rows):
            yield Fault(group.unit, rows, TEXT, SOURCE)


def _held(run: Run, group: Group, register: Register, name: str) -> NDArray[np.bool_]:
    """Whether a field was 1 at each of these accesses."""
    held: NDArray[np.bool_] = run.values(group.unit, group.module, register, register[name], group.rows) == 1
    return held
