"""Lints of writes to register fields that have no effect."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...core.registers import CpuAccess
from ...f28335.i2c.register_map import I2CCNT, I2CMDR
from ..lint import Fault, Options, finds, held
from ..read_modify_write import pairs
from ..run import Group, Rows, Run

Bools = NDArray[np.bool_]
TRX_TEXT = "writes TRX as slave, whose direction the address tells: without effect"
COUNT_TEXT = "writes I2CCNT as slave: without effect on what it receives, and by default on what it sends"
LOST_TEXT = "writes {} with IRS = 0: lost, as the module is held in reset"
STT, STP, IRS, MST, TRX, FDF = (I2CMDR[name] for name in ("STT", "STP", "IRS", "MST", "TRX", "FDF"))


@finds("a write that sets a read-only field to what it does not hold")
def read_only(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes that try to change a read-only field.

    It is no fault to write 0, or to write back the value of the field, as the assignment to another field does.
    """
    value = run.table.value
    for group in run.accesses:
        fields = [f for f in group.register.fields if f.cpu is CpuAccess.R]
        if group.way != "W" or not fields:
            continue
        reads, writes = pairs(run, group)
        for f in fields:
            wanted = f.mask & value[group.rows]
            kept = f.mask & np.array(run.values(group.unit, group.module, group.register, f, group.rows)) << f.lsb
            at = np.searchsorted(group.rows, writes)
            # A read-modify-write writes back the value that it has read. If the hardware changed the read-only field
            # in between, these values differ, but the firmware did not try to change the field.
            kept[at] = value[reads] & f.mask
            rows = group.rows[(wanted != 0) & (wanted != kept)]
            if len(rows):
                name = f"{group.module}.{group.register.name}.{f.name}"
                yield Fault(group.unit, rows, f"writes {name}, which is read-only", group.register.source)


@finds("a write without effect: TRX or I2CCNT as slave, STT or STP with IRS = 0")
def without_effect(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes without effect: of TRX and I2CCNT as slave, of STT and STP while the module is in reset (IRS = 0).

    TRX sets the direction of a master and of the free data format. The direction of a slave comes from the R/W bit of
    the address byte, so TRX is a don't-care (table 7). Only bit-field writes of TRX are judged. I2CCNT does not limit
    the number of bytes that a slave receives; the manual does not say clearly whether it limits those that it sends.

    A write of TRX or I2CCNT is no fault if the module becomes master before the next change of TRX or the next write of
    I2CCNT, because the master uses the value.

    The lint does not read the options of the run. So it also yields the writes that have an effect with the option
    values `dxr_to_xsr_copy_point = "eager_if_trx"` (TRX) and `cnt_in_slave_tx = "counts_bytes"` (I2CCNT).
    """
    for group in run.accesses:
        if group.way != "W":
            continue
        if group.register is I2CCNT:
            until = np.append(group.rows[1:], len(run.table))
            yield Fault(group.unit, _as_slave(run, group, until), COUNT_TEXT, "SPRUG03B section 5.10 and table 18")
        if group.register is I2CMDR:
            yield from _of_mode(run, group)


def _of_mode(run: Run, group: Group) -> Iterator[Fault]:
    value = run.table.value[group.rows]
    named = np.array([name == TRX.name for name in run.table.texts("field", group.rows)], bool)
    others = run.changes(group.unit, group.module, I2CMDR, TRX)
    until = np.append(others, len(run.table))[np.searchsorted(others, group.rows + 1, "right")]
    plain = value & (MST.mask | FDF.mask) == 0
    yield Fault(group.unit, _as_slave(run, group, until, named & plain), TRX_TEXT, "SPRUG03B tables 5 and 7 (TRX)")
    enabled = held(run, group, I2CMDR, "IRS") | (value & IRS.mask != 0)
    for f in (STT, STP):
        rows = group.rows[~enabled & (value & f.mask != 0)]
        yield Fault(group.unit, rows, LOST_TEXT.format(f.name), f"SPRUG03B table 5 ({f.name})")


def _as_slave(run: Run, group: Group, until: Rows, chosen: Bools | bool = True) -> Rows:
    """Return the writes that were made while the module was slave, if it did not become master before row `until`.

    until: for each write of the group, a row.
    chosen: for each write of the group, True if it may be returned; or True for all.
    """
    rises = run.rises(group.unit, group.module, I2CMDR, MST)
    master_before = np.searchsorted(rises, until) > np.searchsorted(rises, group.rows)
    return group.rows[~held(run, group, I2CMDR, "MST") & ~master_before & chosen]
