"""Lints of firmware that hangs in a wait, or that never acknowledges an interrupt group."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...core.records import Kind
from ...f28335.pie.register_map import LINES, PIEACK
from ..lint import Fault, Options, finds
from ..register_maps import reads_take, register_of
from ..run import Rows, Run

Bools = NDArray[np.bool_]
LONGEST_PASS = 4  # maximum number of reads in one pass of a loop


@finds("a place that polls registers for longer than --bound, or to the end of the run without ever getting past")
def spin_without_bound(run: Run, options: Options) -> Iterator[Fault]:
    """Yield the first reads of waits that are longer than `options.bound`, or that never end.

    A wait is a polling loop: a series of 1 to LONGEST_PASS reads that is made at least twice in a row, without another
    access of the same routine. A series of several reads is no wait if one of them removes a word or clears a field,
    as a read of SCIRXBUF or I2CISRC does: such a loop makes progress. A read that is made only once is no wait either,
    because the firmware may have gone on to code that accesses no register.

    Skipped polls are not recorded. Therefore a wait lasts from its first recorded read to the next other access of its
    routine, including computations before this access. If there is none, the wait lasts to the end of the run in the
    main program, and to its last recorded read in a service routine.

    A wait of the main program that is cut off by the end of the run is a fault, however short, if neither the main
    program nor a service routine has ever got past this loop.
    """
    table = run.table
    bound = int(options.bound * run.per_second)
    for unit in run.units:
        rows, following = run.in_order(unit)
        what = table.columns["what"][rows]
        ids = what.astype(np.int64) << 32 | table.columns["text"][rows]
        is_read = np.array([name.startswith("R ") for name in table.names["what"]], bool)[what]
        takes = np.array([reads_take(name[2:]) for name in table.names["what"]], bool)[what]
        # `found` maps the reads of a loop to its waits: (index of the first read in `rows`, length in ticks, True if
        # the end of the run cuts the wait off).
        found: dict[tuple[int, ...], list[tuple[int, int, bool]]] = {}
        for reads in range(1, LONGEST_PASS + 1):
            for begin, last in _again_and_again(ids, is_read & ~takes if reads > 1 else is_read, following, reads):
                after, main = int(following[last]), table.cause[rows[last]] == 0
                end = table.tick[after] if after >= 0 else table.end if main else table.tick[rows[last]]
                length = int(end) - int(table.tick[rows[begin]])
                key = tuple(sorted(set(ids[begin : begin + reads].tolist())))
                found.setdefault(key, []).append((begin, length, bool(after < 0 and main)))
        for key, loops in found.items():
            of = np.isin(ids, key)
            past = (of[:-1] & ~of[1:] & (following[:-1] >= 0)).any()
            waits = [loop for loop in loops if loop[1] > bound or (loop[2] and not past)]
            if not waits:
                continue
            longest = max(waits, key=lambda wait: wait[1])
            names = list(dict.fromkeys(table.names["what"][one >> 32].partition(" ")[2] for one in key))
            since = int(table.tick[rows[longest[0]]])
            text = f"polls {' and '.join(names)} for up to {run.length(longest[1], since, unit)}"
            if any(cut for _, _, cut in waits):
                text += ", the last" if past else ","
                text += " until the end of the run" if past else " until the end of the run, and never got past it"
            register = register_of(*names[0].split(".", 1))
            source = "" if register is None else register.source
            yield Fault(unit, rows[[begin for begin, _, _ in waits]], text, source)


def _again_and_again(ids: Rows, is_look: Bools, following: Rows, reads: int) -> Iterator[tuple[int, int]]:
    """Yield the first and last index of each stretch in which a series of `reads` reads occurs at least twice in a row.

    A stretch is within one routine. It is left out if the series itself consists of repetitions of a shorter series.

    ids: for each access, a number that is the same for equal kinds of access to the same register at the same place.
    is_look: for each access, True if it is a read that may belong to a wait.
    following: for each access, the row of the next access of its routine; -1 for the last one.
    """
    if len(ids) < 2 * reads:
        return
    ends_before = np.append(0, np.cumsum(following < 0))[:-1]  # for each access, the number of routines that precede it
    same_routine = ends_before[reads:] == ends_before[:-reads]
    again = np.append(np.zeros(reads, bool), (ids[reads:] == ids[:-reads]) & is_look[reads:] & same_routine)
    turns = np.flatnonzero(np.diff(np.concatenate(([0], again.astype(np.int8), [0]))))
    for start, end in zip(turns[::2].tolist(), turns[1::2].tolist(), strict=True):
        begin, last = start - reads, end - 1
        parts = [part for part in range(1, reads) if reads % part == 0]  # possible lengths of the shorter series
        if end - start >= reads and not any(
            (ids[begin : begin + reads - part] == ids[begin + part : begin + reads]).all() for part in parts
        ):
            yield begin, last


TEXT = "{} is served, and PIEACK bit {} is not written afterwards: no interrupt of group {} comes any more"


@finds("a service routine after which PIEACK is never written for its group")
def group_not_acknowledged(run: Run, options: Options) -> Iterator[Fault]:
    """Yield entries of service routines after which PIEACK is never written for their group, which blocks the group.

    The entry of a routine that is still running at the end of the run is no fault.
    """
    for unit in run.units:
        acknowledges = run.accesses_of(unit, "W", "PIE", PIEACK.name)
        for vector, (group, _) in LINES.items():
            rows = run.rows(Kind.IRQ, unit, vector)
            entries, ends = rows[run.table.value[rows] != 0], rows[run.table.value[rows] == 0]
            of_group = acknowledges[run.table.value[acknowledges] >> group - 1 & 1 == 1]
            unanswered = entries[entries > of_group.max(initial=-1)]
            left = np.array([entry for entry in unanswered.tolist() if (ends > entry).any()], np.int64)
            yield Fault(unit, left, TEXT.format(vector, group - 1, group), "SPRUFB0D section 8.3 and table 115")
