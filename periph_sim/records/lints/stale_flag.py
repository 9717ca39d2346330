"""A wait in the middle of a transfer that ends at once, because its flag rose before the transfer began.

Only reads that name the flag are judged; recordings of Python firmware contain them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...f28335.i2c.register_map import I2CSTR
from ..lint_finding import Fault, Options, accesses
from ..read_modify_write import read_modify_writes
from ..run import Run

SAYS = "a look at SCD, RRDY, ARDY or NACK that sees a 1 from before the present transfer"
SOURCE = "SPRUG03B table 10"
TEXT = "sees I2CSTR.{} = 1, which rose before this transfer began and was never cleared"
FLAGS = ("SCD", "RRDY", "ARDY", "NACK")


def faults(run: Run, options: Options) -> Iterator[Fault]:
    table = run.table
    for group in accesses(run, "R", I2CSTR):
        of = group.unit, group.module
        looks = np.setdiff1d(group.rows, read_modify_writes(run, group.unit).reads)
        starts = run.changes(*of, I2CSTR, I2CSTR["BB"])
        starts = starts[table.value[starts] == 1]
        for name in FLAGS:
            f = I2CSTR[name]
            named = np.array([text == name for text in table.texts("field", looks)], bool)
            rows = looks[named & (table.value[looks] & f.mask != 0)]
            rises = run.changes(*of, I2CSTR, f)
            rises = rises[table.value[rises] == 1]
            rose = np.append(rises, -1)[np.searchsorted(rises, rows) - 1]
            began = np.append(starts, -1)[np.searchsorted(starts, rows) - 1]
            busy = run.values(*of, I2CSTR, I2CSTR["BB"], rows) == 1
            rows = rows[busy & (rose < began)]
            yield Fault(group.unit, rows, TEXT.format(name), SOURCE)
