"""Lints of I2CDRR and I2CDXR: bytes that are read too early or never, or overwritten."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...core.counted import counted
from ...core.records import Kind
from ...f28335.i2c.register_map import I2CDRR, I2CDXR, I2CFFRX, I2CFFTX, I2CMDR, I2CSTR
from ..lint import Fault, Options, accesses, finds, held
from ..run import Run

EARLY = "reads I2CDRR while RRDY = 0: no byte came since it was read last"
OVERWRITTEN = "writes I2CDXR while XRDY = 0: the byte written before was not taken yet, and is overwritten"


@finds("I2CDRR read with RRDY = 0: no byte came since the read before")
def receive_register_early(run: Run, options: Options) -> Iterator[Fault]:
    """Yield reads of I2CDRR without a byte in it: none ever came, or the last one was read before."""
    for group in accesses(run, "R", I2CDRR):
        changes = run.changes(group.unit, group.module, I2CSTR, I2CSTR["RRDY"])
        last = np.append(changes, -1)[np.searchsorted(changes, group.rows) - 1]
        empty = ~held(run, group, I2CSTR, "RRDY")
        # A byte whose RRDY was cleared by a write, or by a reset, may be read still.
        by_read = (last < 0) | np.isin(run.made_by(last), group.rows)
        plain = ~held(run, group, I2CFFRX, "RXFFRST")
        enabled = held(run, group, I2CMDR, "IRS")
        rows = group.rows[empty & by_read & plain & enabled]
        yield Fault(group.unit, rows, EARLY, "SPRUG03B table 10 (RRDY), table 19")


@finds("I2CDRR never read though RRDY rose")
def receive_register_unread(run: Run, options: Options) -> Iterator[Fault]:
    """Yield the access that first saw RRDY = 1, of a unit that received bytes and never read I2CDRR."""
    for unit, modules in run.units.items():
        for module in (module for module in modules if module.startswith("I2C")):
            rises = run.rises(unit, module, I2CSTR, I2CSTR["RRDY"])
            if not len(rises) or len(run.accesses_of(unit, "R", module, I2CDRR.name)):
                continue
            reads = run.accesses_of(unit, "R", module, I2CSTR.name)
            saw = reads[run.table.value[reads] & I2CSTR["RRDY"].mask != 0]
            rows = saw if len(saw) else run.rows(Kind.ACCESS, unit)
            text = f"{module}.I2CDRR is never read, though RRDY rose {counted(len(rises), 'time')}"
            yield Fault(unit, np.array(rows[:1]), text, "SPRUG03B table 10 (RRDY, RSFULL), table 19")


@finds("I2CDXR written twice in a transfer with XRDY = 0 in between")
def transmit_register_overwritten(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of I2CDXR while the byte before, of the same transfer, still waits in it (XRDY = 0) and is lost.

    In FIFO mode XRDY does not tell whether a byte can be taken; there nothing is judged.
    """
    for group in accesses(run, "W", I2CDXR):
        before = np.append(-1, group.rows[:-1])
        of = group.unit, group.module
        waits = ~held(run, group, I2CSTR, "XRDY")
        plain = ~held(run, group, I2CFFTX, "I2CFFEN")
        enabled = held(run, group, I2CMDR, "IRS")
        others = [run.changes(*of, I2CSTR, I2CSTR[name]) for name in ("AAS", "BB")]
        news = np.sort(np.concatenate([run.rises(*of, I2CSTR, I2CSTR["XRDY"]), *others]))
        still = np.searchsorted(news, group.rows) == np.searchsorted(news, before)
        rows = group.rows[(before >= 0) & waits & plain & enabled & still]
        yield Fault(group.unit, rows, OVERWRITTEN, "SPRUG03B table 10 (XRDY), table 20")
