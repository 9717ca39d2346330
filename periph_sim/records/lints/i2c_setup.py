"""Lints of the I2C module's settings, changed at a time at which they must not change."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...core.registers import Register
from ...f28335.i2c.register_map import I2CMDR, I2COAR, I2CPSC, I2CSTR
from ..lint import Fault, Options, accesses, finds, held
from ..run import Group, Run

OWN_ADDRESS = (
    "changes I2COAR while I2CSTR.BB = 1: which address the transfer under way is compared with is not documented"
)
PRESCALER = "changes I2CPSC.IPSC while I2CMDR.IRS = 1; the module clock does not follow before IRS goes from 0 to 1"
RESET = "clears IRS while the module takes part in a transfer (BB = 1): the byte under way is lost, and SDA is let go"


@finds("own address changed in mid-transfer (BB = 1, IRS = 1)")
def own_address_in_transfer(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of another value into I2COAR while the module is on and the bus is busy."""
    for group in accesses(run, "W", I2COAR):
        rows = group.rows[held(run, group, I2CSTR, "BB") & _changed_while_on(run, group, I2COAR, "OAR")]
        yield Fault(group.unit, rows, OWN_ADDRESS, "SPRUG03B section 4 and table 17")


@finds("IPSC changed while IRS = 1")
def prescaler_while_enabled(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of another value into I2CPSC while IRS = 1: the prescaler may change in reset only."""
    for group in accesses(run, "W", I2CPSC):
        rows = group.rows[_changed_while_on(run, group, I2CPSC, "IPSC")]
        yield Fault(group.unit, rows, PRESCALER, "SPRUG03B section 1.4 and table 12")


@finds("IRS cleared in mid-transfer: as slave that is addressed (AAS = 1), or as master, with BB = 1")
def reset_in_transfer(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of IRS = 0 while the module takes part in a transfer.

    The byte under way is lost, and a master reads FF afterwards.
    """
    for group in accesses(run, "W", I2CMDR):
        enabled = held(run, group, I2CMDR, "IRS")
        takes_part = held(run, group, I2CMDR, "MST") | held(run, group, I2CSTR, "AAS")
        busy = held(run, group, I2CSTR, "BB")
        clears = run.table.value[group.rows] & I2CMDR["IRS"].mask == 0
        rows = group.rows[enabled & clears & busy & takes_part]
        yield Fault(group.unit, rows, RESET, "SPRUG03B section 1.3 and table 5 (IRS)")


def _changed_while_on(run: Run, group: Group, register: Register, name: str) -> NDArray[np.bool_]:
    """Return True for each write of another value into a field while IRS = 1."""
    f = register[name]
    kept = run.values(group.unit, group.module, register, f, group.rows)
    changed: NDArray[np.bool_] = kept != run.table.value[group.rows] & f.mask
    return changed & held(run, group, I2CMDR, "IRS")
