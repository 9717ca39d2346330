"""IRS = 0 while the module takes part in a transfer: the byte under way is lost, and a master reads FF from then on."""

from __future__ import annotations

from collections.abc import Iterator

from ...f28335.i2c.register_map import I2CMDR, I2CSTR
from ..lint_finding import Fault, Options, accesses, held
from ..run import Run

SAYS = "IRS cleared in mid-transfer: as slave that is addressed (AAS = 1), or as master, with BB = 1"
SOURCE = "SPRUG03B section 1.3 and table 5 (IRS)"
TEXT = "clears IRS while the module takes part in a transfer (BB = 1): the byte under way is lost, and SDA is let go"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    for group in accesses(run, "W", I2CMDR):
        enabled = held(run, group, I2CMDR, "IRS")
        master = held(run, group, I2CMDR, "MST")
        addressed = held(run, group, I2CSTR, "AAS")
        busy = held(run, group, I2CSTR, "BB")
        clears = run.table.value[group.rows] & I2CMDR["IRS"].mask == 0
        rows = group.rows[enabled & clears & busy & (master | addressed)]
        yield Fault(group.unit, rows, TEXT, SOURCE)
