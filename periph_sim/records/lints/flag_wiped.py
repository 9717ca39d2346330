"""A flag of the current transfer that a write of I2CSTR clears although the firmware has never read it.

    i2c.I2CSTR.SCD = 1       writes back every 1 that it read, and so clears SDIR if it was 1
    i2c.I2CSTR.all = 0xFFFF  clears everything

A plain write that sets no bits but those of such flags is considered intentional. Nor is it a fault to clear a flag
left from an earlier transfer, the flag that a bit-field write names, any flag after the STOP, or ARDY, which only says
that registers may be loaded.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CSTR
from ..lint_finding import Fault, Options, accesses
from ..read_modify_write import read_modify_writes
from ..register_maps import one_clears
from ..run import Run

SAYS = "a flag of the present transfer cleared by a write of I2CSTR before the firmware ever looked at it"
SOURCE = "SPRUG03B table 10"
TEXT = "clears I2CSTR.{} along, {}: it rose in this transfer and the firmware has not looked at it"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    table = run.table
    for group in accesses(run, "W", I2CSTR):
        of = group.unit, group.module
        own = read_modify_writes(run, group.unit)
        reads = np.setdiff1d(run.accesses_of(group.unit, "R", group.module, I2CSTR.name), own.reads)
        starts = run.changes(*of, I2CSTR, I2CSTR["BB"])
        starts = starts[table.value[starts] == 1]
        stops = run.changes(*of, I2CSTR, I2CSTR["SCD"])
        stops = stops[table.value[stops] == 1]
        flags = sum(f.mask for f in one_clears(I2CSTR))
        for f in (f for f in one_clears(I2CSTR) if f.name != "ARDY"):
            changes = run.changes(*of, I2CSTR, f)
            falls = np.flatnonzero(table.value[changes] == 0)
            by, rose = run.made_by(changes[falls]), np.append(changes, -1)[falls - 1]
            looks = run.looking_at(reads, f)
            seen = np.append(looks, -1)[np.searchsorted(looks, by) - 1] > rose
            began = np.append(starts, np.iinfo(np.int64).max)[np.searchsorted(starts, by) - 1]
            here = (rose > began) & (np.append(stops, -1)[np.searchsorted(stops, by) - 1] < began)
            busy = run.values(*of, I2CSTR, I2CSTR["BB"], np.maximum(by, 0)) == 1
            named = np.array([name == f.name for name in table.texts("field", np.maximum(by, 0))], bool)
            meant = ~np.isin(by, own.writes) & (table.value[np.maximum(by, 0)] & ~flags == 0)
            rows = by[np.isin(by, group.rows) & ~seen & here & busy & ~named & ~meant]
            for plain, how in ((True, "by a plain write"), (False, "by a bit-field write of another flag")):
                some = rows[np.isin(rows, own.writes) != plain]
                yield Fault(group.unit, some, TEXT.format(f.name, how), SOURCE)
