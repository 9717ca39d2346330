"""Lints of the I2C module: its flags, the bytes in I2CDRR and I2CDXR, and its settings."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...core.phrases import counted
from ...core.records import Kind
from ...core.registers import Register
from ...f28335.i2c.register_map import I2CDRR, I2CDXR, I2CFFRX, I2CFFTX, I2CMDR, I2COAR, I2CPSC, I2CSTR
from ..lint import Fault, Options, accesses, finds, held
from ..read_modify_write import read_modify_writes
from ..register_maps import one_clears
from ..run import Group, Rows, Run

SOURCE = "SPRUG03B table 10"
WIPED = "clears I2CSTR.{} along, {}: it rose in this transfer and the firmware has not looked at it"
STALE = "sees I2CSTR.{} = 1, which rose before this transfer began and was never cleared"
XRDY_SOURCE = "SPRUG03B table 10 (XRDY, SDIR, AAS), table 8 (BCM)"
XRDY_ALONE = "loads I2CDXR as slave on XRDY alone: its last look at it showed SDIR = 0, so no master was reading yet"
SDIR_WIPED = (
    "loads I2CDXR as slave with SDIR = 0 though a master reads: the firmware itself cleared SDIR in this transfer, "
    "by writing I2CSTR at {}"
)


@finds("a flag of the present transfer cleared by a write of I2CSTR before the firmware ever looked at it")
def flag_wiped(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of I2CSTR that clear a flag that rose in the current transfer and that firmware has not read since.

    A read that belongs to a read-modify-write does not count as a read by firmware.

    Examples:
        i2c.I2CSTR.SCD = 1       writes back every 1 that it read, and so clears SDIR if it was 1
        i2c.I2CSTR.all = 0xFFFF  clears every flag that is cleared by writing 1

    These writes are no fault:
    - a plain write of a value with ones only at flags that are cleared by writing 1; it is considered intentional
    - a bit-field write that clears the flag that it names
    - a write that clears a flag left from an earlier transfer
    - a write after the STOP of the transfer
    - a write that clears ARDY, which only says that registers may be loaded
    """
    table = run.table
    for group in accesses(run, "W", I2CSTR):
        of = group.unit, group.module
        own = read_modify_writes(run, group.unit)
        reads = np.setdiff1d(run.accesses_of(group.unit, "R", group.module, I2CSTR.name), own.reads)
        starts, stops = run.rises(*of, I2CSTR, I2CSTR["BB"]), run.rises(*of, I2CSTR, I2CSTR["SCD"])
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
                yield Fault(group.unit, some, WIPED.format(f.name, how), SOURCE)


@finds("a look at SCD, RRDY, ARDY or NACK that sees a 1 from before the present transfer")
def stale_flag(run: Run, options: Options) -> Iterator[Fault]:
    """Yield reads during a transfer that see a flag which rose before this transfer began.

    Firmware that waits for the flag then mistakes an old event for a new one. The flags are SCD, RRDY, ARDY and NACK.
    Only reads of a single flag that belong to no read-modify-write are judged. In Python firmware and C sources, these
    are reads such as `i2c.I2CSTR.SCD`. In a program image, they are `TBIT loc16,#bit`, and `AND AX,loc16,#mask` with a
    mask that selects one flag.
    """
    table = run.table
    for group in accesses(run, "R", I2CSTR):
        of = group.unit, group.module
        looks = np.setdiff1d(group.rows, read_modify_writes(run, group.unit).reads)
        starts = run.rises(*of, I2CSTR, I2CSTR["BB"])
        for name in ("SCD", "RRDY", "ARDY", "NACK"):
            f = I2CSTR[name]
            named = np.array([text == name for text in table.texts("field", looks)], bool)
            rows = looks[named & (table.value[looks] & f.mask != 0)]
            rises = run.rises(*of, I2CSTR, f)
            rose = np.append(rises, -1)[np.searchsorted(rises, rows) - 1]
            began = np.append(starts, -1)[np.searchsorted(starts, rows) - 1]
            busy = run.values(*of, I2CSTR, I2CSTR["BB"], rows) == 1
            rows = rows[busy & (rose < began)]
            yield Fault(group.unit, rows, STALE.format(name), SOURCE)


@finds("XRDY polled without SDIR or AAS being looked at: I2CDXR loaded as slave though SDIR was read as 0")
def xrdy_alone(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of I2CDXR by slave firmware that mistakes XRDY = 1 for a read request: no master reads from it.

    XRDY is also 1 while the module is idle, so firmware must read SDIR or AAS as well. A slave's write of I2CDXR is a
    fault if the last read of XRDY before the write showed XRDY = 1 and SDIR = 0, and SDIR was still 0 at the write:
    firmware that checks SDIR would not have written. A read of the whole register is also a read of XRDY.

    These writes are no fault:
    - a write without a read of XRDY since the previous write of I2CDXR
    - a write after which the firmware becomes master: its next write of I2CMDR has MST = 1
    - a write in FIFO mode, in the free data format, or while the module is disabled (IRS = 0)

    If the firmware itself cleared SDIR after the module was addressed, the finding names the place that did so.
    """
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
        rows, by = group.rows[found], _sdir_wiped_by(run, group)[found]
        if (by < 0).any():
            yield Fault(group.unit, rows[by < 0], XRDY_ALONE, XRDY_SOURCE)
        for spot, writes in run.by_place(np.unique(by[by >= 0])):
            yield Fault(group.unit, rows[np.isin(by, writes)], SDIR_WIPED.format(spot), XRDY_SOURCE)


def _sdir_wiped_by(run: Run, group: Group) -> Rows:
    """Return, for each access, the row of the firmware's write that cleared SDIR after the module was addressed.

    The row is -1 if the last change of SDIR before the access was not made by such a write, or AAS has changed since.
    """
    value = run.table.value
    changes = run.changes(group.unit, group.module, I2CSTR, I2CSTR["SDIR"])
    addressed = run.changes(group.unit, group.module, I2CSTR, I2CSTR["AAS"])
    last = np.append(changes, -1)[np.searchsorted(changes, group.rows) - 1]
    since = np.append(addressed, -1)[np.searchsorted(addressed, group.rows) - 1]
    writes = run.accesses_of(group.unit, "W", group.module, I2CSTR.name)
    by = np.where(last >= 0, run.made_by(last), -1)
    here = (last > since) & (since >= 0) & (value[last] == 0) & (value[since] == 1) & np.isin(by, writes)
    return np.where(here, by, -1)


EARLY = "reads I2CDRR while RRDY = 0: no byte came since it was read last"
OVERWRITTEN = "writes I2CDXR while XRDY = 0: the byte written before was not taken yet, and is overwritten"


@finds("I2CDRR read with RRDY = 0: no byte came since the read before")
def receive_register_early(run: Run, options: Options) -> Iterator[Fault]:
    """Yield reads of I2CDRR that return no new byte, because none was received or the last byte was already read.

    FIFO mode and a disabled module (IRS = 0) are not judged, nor are reads after RRDY was cleared other than by a read.
    """
    for group in accesses(run, "R", I2CDRR):
        changes = run.changes(group.unit, group.module, I2CSTR, I2CSTR["RRDY"])
        last = np.append(changes, -1)[np.searchsorted(changes, group.rows) - 1]
        empty = ~held(run, group, I2CSTR, "RRDY")
        # Only a read that clears RRDY takes the byte. If a write or a reset cleared RRDY, the byte can still be read.
        by_read = (last < 0) | np.isin(run.made_by(last), group.rows)
        plain = ~held(run, group, I2CFFRX, "RXFFRST")
        enabled = held(run, group, I2CMDR, "IRS")
        rows = group.rows[empty & by_read & plain & enabled]
        yield Fault(group.unit, rows, EARLY, "SPRUG03B table 10 (RRDY), table 19")


@finds("I2CDRR never read though RRDY rose")
def receive_register_unread(run: Run, options: Options) -> Iterator[Fault]:
    """Yield one access for each module that received a byte (RRDY rose) although the firmware never reads I2CDRR.

    The access is the first read of I2CSTR that returned RRDY = 1. If there is none, it is the first access of the unit.
    """
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
    """Yield writes of I2CDXR that overwrite a byte of the same transfer which the module has not taken yet (XRDY = 0).

    FIFO mode is not judged, because XRDY does not show there whether the module can take a byte. A disabled module
    (IRS = 0) is not judged either.
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


OWN_ADDRESS = (
    "changes I2COAR while I2CSTR.BB = 1: the manual does not say whether the present transfer is compared with "
    "the old or the new address"
)
PRESCALER = "changes I2CPSC.IPSC while I2CMDR.IRS = 1; the module clock does not follow before IRS goes from 0 to 1"
RESET = (
    "clears IRS while the module takes part in a transfer (BB = 1): the byte in progress is lost, and SDA is released"
)


@finds("own address changed in mid-transfer (BB = 1, IRS = 1)")
def own_address_in_transfer(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes that change I2COAR while the module is enabled and the bus is busy."""
    for group in accesses(run, "W", I2COAR):
        rows = group.rows[held(run, group, I2CSTR, "BB") & _changed_while_on(run, group, I2COAR, "OAR")]
        yield Fault(group.unit, rows, OWN_ADDRESS, "SPRUG03B section 4 and table 17")


@finds("IPSC changed while IRS = 1")
def prescaler_while_enabled(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes that change I2CPSC while IRS = 1: the prescaler may be changed only in reset."""
    for group in accesses(run, "W", I2CPSC):
        rows = group.rows[_changed_while_on(run, group, I2CPSC, "IPSC")]
        yield Fault(group.unit, rows, PRESCALER, "SPRUG03B section 1.4 and table 12")


@finds("IRS cleared in mid-transfer: as slave that is addressed (AAS = 1), or as master, with BB = 1")
def reset_in_transfer(run: Run, options: Options) -> Iterator[Fault]:
    """Yield writes of IRS = 0 during a transfer (BB = 1) in which the module is master or addressed slave (AAS = 1).

    The byte in progress is lost. An external master that reads from the module then reads 0xFF.
    """
    for group in accesses(run, "W", I2CMDR):
        enabled = held(run, group, I2CMDR, "IRS")
        takes_part = held(run, group, I2CMDR, "MST") | held(run, group, I2CSTR, "AAS")
        busy = held(run, group, I2CSTR, "BB")
        clears = run.table.value[group.rows] & I2CMDR["IRS"].mask == 0
        rows = group.rows[enabled & clears & busy & takes_part]
        yield Fault(group.unit, rows, RESET, "SPRUG03B section 1.3 and table 5 (IRS)")


def _changed_while_on(run: Run, group: Group, register: Register, name: str) -> NDArray[np.bool_]:
    """Return, for each write of the group, True if the write changes the field while IRS = 1."""
    f = register[name]
    kept = run.values(group.unit, group.module, register, f, group.rows)
    changed: NDArray[np.bool_] = kept != run.table.value[group.rows] & f.mask
    return changed & held(run, group, I2CMDR, "IRS")
