"""Writes that change nothing on this chip: TRX and I2CCNT as slave, STT and STP while the module is held in reset.

TRX sets the direction of a master and of the free data format; the direction of a slave comes from the address. I2CCNT
does not limit a slave-receiver; for a slave-transmitter the guide is ambiguous (option `cnt_in_slave_tx`). A write that
a later use as master may need is no fault.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CCNT, I2CMDR
from ..lint_finding import Fault, Options, held
from ..run import Group, Rows, Run

SAYS = "a write without effect: TRX or I2CCNT as slave, STT or STP with IRS = 0"
TRX_TEXT = "writes TRX as slave, whose direction the address tells: without effect"
COUNT_TEXT = "writes I2CCNT as slave: without effect on what it receives, and by default on what it sends"
LOST_TEXT = "writes {} with IRS = 0: lost, as the module is held in reset"
STT, STP, IRS, MST, TRX, FDF = (I2CMDR[name] for name in ("STT", "STP", "IRS", "MST", "TRX", "FDF"))


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in run.accesses:
        if group.way != "W":
            continue
        if group.register is I2CCNT:
            rows = group.rows[
                _slave(run, group) & ~_master_before(run, group, np.append(group.rows[1:], len(run.table)))
            ]
            yield Fault(group.unit, rows, COUNT_TEXT, "SPRUG03B section 5.10 and table 18")
        if group.register is I2CMDR:
            yield from _of_mode(run, group)


def _of_mode(run: Run, group: Group) -> Iterator[Fault]:
    named = np.array([name == TRX.name for name in run.table.texts("field", group.rows)], bool)
    others = run.changes(group.unit, group.module, I2CMDR, TRX)
    until = np.append(others, len(run.table))[np.searchsorted(others, group.rows + 1, "right")]
    plain = run.table.value[group.rows] & (MST.mask | FDF.mask) == 0
    rows = group.rows[named & plain & _slave(run, group) & ~_master_before(run, group, until)]
    yield Fault(group.unit, rows, TRX_TEXT, "SPRUG03B tables 5 and 6 (TRX)")
    enabled = held(run, group, I2CMDR, "IRS") | (run.table.value[group.rows] & IRS.mask != 0)
    for f in (STT, STP):
        rows = group.rows[~enabled & (run.table.value[group.rows] & f.mask != 0)]
        yield Fault(group.unit, rows, LOST_TEXT.format(f.name), f"SPRUG03B table 5 ({f.name})")


def _slave(run: Run, group: Group) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return ~held(run, group, I2CMDR, "MST")


def _master_before(run: Run, group: Group, until: Rows) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return True for each write after which the module becomes master before the row beside it."""
    changes = run.changes(group.unit, group.module, I2CMDR, MST)
    rises = changes[run.table.value[changes] == 1]
    return np.searchsorted(rises, until) > np.searchsorted(rises, group.rows)
