"""A place that reads one register for longer than the bound, with no other access between; or till the run is over.

Skipped polls are not recorded, so a wait is the stretch from its first recorded read to the next access of the same
routine elsewhere, or to the end of the run. What the firmware computed meanwhile without an access counts as waiting;
a single read is no wait, as the firmware may have gone on without the register. A wait that the end of the run cuts
short is at fault, however short, if its place never got past it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..lint_finding import Fault, Options
from ..register_maps import register_of
from ..run import Run

SAYS = "a place that polls one register for longer than --bound, or to the end of the run without ever getting past"


def faults(run: Run, options: Options) -> Iterator[Fault]:
    table = run.table
    bound = int(options.bound * run.per_second)
    for unit in run.units:
        rows, following = run.in_order(unit)
        if not len(rows):
            continue
        what, place = table.columns["what"][rows], table.columns["text"][rows]
        is_read = np.array([name.startswith("R ") for name in table.names["what"]])
        new = np.append(True, (what[1:] != what[:-1]) | (place[1:] != place[:-1]) | (following[:-1] < 0))
        begins = np.flatnonzero(new)
        lasts = np.append(begins[1:], len(rows)) - 1
        after = following[lasts]
        main = table.cause[rows[lasts]] == 0
        ends = np.where(after >= 0, table.tick[after], np.where(main, table.end, table.tick[rows[lasts]]))
        lengths = ends - table.tick[rows[begins]]
        same = what[begins].astype(np.int64) << 32 | place[begins]
        stuck = (after < 0) & main & np.isin(same, same[after >= 0], invert=True)
        long = np.flatnonzero(is_read[what[begins]] & (lasts > begins) & ((lengths > bound) | stuck))
        for one in np.unique(same[long]).tolist():
            waits = long[same[long] == one]
            name = table.names["what"][one >> 32].partition(" ")[2]
            longest = int(waits[np.argmax(lengths[waits])])
            since = int(table.tick[rows[begins[longest]]])
            text = f"polls {name} for up to {run.length(int(lengths[longest]), since, unit)}"
            if stuck[waits].any():
                text += ", until the end of the run, and never got past it"
            elif (after[waits] < 0).any():
                text += ", the last until the end of the run"
            yield Fault(unit, rows[begins[waits]], text, _source(name))


def _source(name: str) -> str:
    register = register_of(*name.split(".", 1))
    return register.source if register is not None else ""
