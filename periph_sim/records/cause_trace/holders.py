"""Parties that pull a wire low, and causes of a change of these parties.

EDGE fell "controller"   HOLD "controller, dsp.SCLA"   HOLD "dsp.SCLA"   EDGE rose
pulled it low first      joined in                     holds it alone
"""

from __future__ import annotations

import numpy as np

from ...core.records import Kind, Record
from ..run import Rows, Run
from .firmware_causes import RECORDED, Link


def holders(run: Run, row: int, record: Record) -> tuple[str, ...]:
    """Return the parties that pull the wire low after this record; for a rising edge, those that did before it."""
    before = _before(run, row, record)
    return _named(record.text) if not record.value else () if before is None else _named(before.text)


def mover(run: Run, row: int, record: Record) -> str:
    """Return the party that pulled or released the wire with this record; "" if it is not known."""
    earlier = _before(run, row, record)
    now, before = _named(record.text), () if earlier is None else _named(earlier.text)
    moved = [who for who in now if who not in before] or [who for who in before if who not in now]
    return moved[-1] if moved else ""


def wire_rows(run: Run, wire: str) -> Rows:
    """Return the rows of a wire in order: its edges and the changes of its holders."""

    def both() -> Rows:
        return np.sort(np.concatenate([run.rows(kind, wire) for kind in (Kind.EDGE, Kind.HOLD)]))

    return run.remembered(f"edges and holders of {wire}", both)


def causes_of_hold(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the record since which the present holders have held a line that others released.

    Empty if a party began to hold it with this record, which then has the cause of that.
    """
    ours = set(_named(record.text))
    joined = row
    rows = wire_rows(run, record.where)
    for earlier in rows[: np.searchsorted(rows, row)][::-1].tolist():
        before = run.record(earlier)
        if before.value or not ours <= set(_named(before.text)):
            break
        joined = earlier
    who = " and ".join(_named(record.text))
    return [] if joined == row else [Link(joined, RECORDED, f"since then {who} has held it")]


def _before(run: Run, row: int, record: Record) -> Record | None:
    rows = wire_rows(run, record.where)
    place = int(np.searchsorted(rows, row))
    return run.record(int(rows[place - 1])) if place else None


def _named(text: str) -> tuple[str, ...]:
    return tuple(text.split(", ")) if text else ()
