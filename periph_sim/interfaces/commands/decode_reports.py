"""Reports of `periph-sim decode` on whole buses: counts and load for each address, and the glitches of the lines."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Sequence

import click
import numpy as np

from ...traces.capture.capture import Capture
from ...traces.capture.sampling import sample_step
from ...traces.decode.event_rows import (
    ADDRESS,
    ADDRESS_LOW,
    AGAIN,
    CUT,
    DATA,
    FRAME,
    READ,
    START,
    WORD,
    Rows,
    refusals,
)
from .bulk_text import Numbers
from .command_frame import print_table
from .decode_buses import Bus
from .decoded_text import Clock, seconds_of

Cells = list[tuple[str | int | float | None, ...]]

COUNTS = ("bus", "address", "transfers", "bytes", "read", "refused", "errors", "load_percent")
PARITY, FRAME_ERROR = 1, 2  # bits of `Rows.detail - READ` of a frame with faults
ALL = -1  # represents all addresses of a bus, or an address that is missing


def counts(rows: Rows, first: Numbers, buses: Sequence[Bus], capture: Capture) -> Cells:
    """Return a row with the columns COUNTS for each address of an I2C bus, and for each bus as a whole.

    bytes: data bytes, frames or words.
    read: data bytes that an I2C target sent; None for other buses.
    refused: addresses and written bytes that no target acknowledged; None for other buses.
    errors: frames with parity or frame errors, and incomplete bytes, frames and words.
    load_percent: the time from START to STOP, or in bursts and selections, as a share of the recorded time; None if
        there is no recorded time.
    """
    begins = np.union1d(first, np.flatnonzero((rows.event == START) | (rows.event == AGAIN)))
    data = (rows.event == DATA) | (rows.event == FRAME) | (rows.event == WORD)
    is_fault = (rows.event == FRAME) & (rows.detail > READ) & ((rows.detail - READ) & (PARITY | FRAME_ERROR) > 0)
    counted = (data, data & (rows.detail == READ), refusals(rows), is_fault | (rows.event == CUT))
    sums = [np.add.reduceat(column.astype(np.int64), begins) for column in counted] if len(begins) else []
    ends = np.maximum.reduceat(rows.end, begins) if len(begins) else rows.end
    # For each message, `again` is True if the message ends with a repeated START.
    again = np.append(rows.event[begins[1:]] == AGAIN, False)[: len(begins)]
    ends = np.where(again, np.append(rows.at[begins[1:]], 0)[: len(begins)], ends)
    transfers = np.searchsorted(first, begins, side="right")
    columns = zip(
        rows.bus[begins].tolist(),
        _addresses(rows, begins),
        transfers.tolist(),
        *(column.tolist() for column in (*sums, ends - rows.at[begins])),
        strict=True,
    )
    totals: dict[tuple[int, int], list[int]] = {(number, ALL): [0] * 5 for number in range(len(buses))}
    seen: dict[tuple[int, int], set[int]] = {}
    for bus, address, transfer, *numbers in columns:
        for key in {(bus, address), (bus, ALL)}:
            before = totals.get(key, [0] * 5)
            totals[key] = [a + b for a, b in zip(before, numbers, strict=True)]
            seen.setdefault(key, set()).add(transfer)
    cells: Cells = []
    for (number, address), (many, read, refused, errors, busy) in sorted(totals.items()):
        bus = buses[number]
        is_i2c = bus.protocol == "i2c"
        known = sum(span.end - span.begin for span in capture.known(*bus.lines))
        load = round(100 * busy / known, 2) if known else None
        label = "all" if address == ALL else f"0x{address:02X}"
        i2c_only = (read, refused) if is_i2c else (None, None)
        cells.append((bus.name, label, len(seen.get((number, address), ())), many, *i2c_only, errors, load))
    return cells


def _addresses(rows: Rows, begins: Numbers) -> list[int]:
    """Return the address of each message; ALL if the message has no complete address, or is not of an I2C bus."""
    events, values = np.append(rows.event, [CUT] * 3), np.append(rows.value, [ALL] * 3)
    found: Numbers = np.where(events[begins + 1] == ADDRESS, values[begins + 1], ALL)
    low = events[begins + 3] == ADDRESS_LOW
    found[low] = values[begins + 3][low]
    return list(map(int, found))


GLITCHES = ("time_s", "line", "pulse", "width_s", "other_lines")


def glitches(buses: Sequence[Bus], capture: Capture, clock: Clock | None, shortest: int | None) -> Cells:
    """Return a row with the columns GLITCHES for each short pulse, in order of time.

    If the capture has no sample rate, times and widths are positions.

    shortest: pulses of fewer positions are glitches. None: the limit is `Bus.glitch`.
    """
    lines = {line.index: (line, bus) for bus in buses for line in bus.lines}
    found: list[tuple[int, int, str, str, str]] = []
    for line, bus in lines.values():
        for span in capture.known(line):
            part = line.cut(span)
            widths = np.diff(part.edges)
            for place in np.flatnonzero(widths < (bus.glitch if shortest is None else shortest)).tolist():
                at = part.edges[place : place + 1]
                around = [f"{other.name} {LEVELS[int(other.at(at)[0])]}" for other in bus.lines if other is not line]
                pulse = LEVELS[int(part.levels[place])]
                found.append((int(at[0]), int(widths[place]), line.name, pulse, ", ".join(around)))
    found.sort()
    at_s, width_s = (seconds_of(np.array([row[column] for row in found], np.int64), clock) for column in (0, 1))
    return [
        (time or at, name, pulse, long or width, around)
        for time, long, (at, width, name, pulse, around) in zip(at_s, width_s, found, strict=True)
    ]


LEVELS = ("low", "high")


def glitch_notes(buses: Sequence[Bus], capture: Capture, shortest: int | None) -> list[str]:
    """Return a note for each bus that states below which width a pulse is a glitch.

    shortest: pulses of fewer positions are glitches; None for the limit of each bus, `Bus.glitch`.

    Raise ClickException if this width is unknown, because the capture has no sample rate, or if `shortest` is 0.
    """
    if shortest == 0:
        raise click.ClickException("--glitches with --glitch 0: no pulse is shorter; give --glitch a greater width")
    notes = []
    for bus in buses:
        limit = bus.glitch if shortest is None else shortest
        if not limit:
            raise click.ClickException(
                f"--glitches: {capture.path} states no rate; state --rate, or the width with --glitch in samples"
            )
        width = f"{limit} samples" if capture.rate is None else f"{float(limit / capture.rate) * 1e9:.6g} ns"
        blind = "; none can be seen, since no sample is shorter; state --glitch"
        notes.append(f"{bus.name}: pulses shorter than {width}" + blind * (limit <= sample_step(capture)))
    return notes


def print_cells(titles: Sequence[str], cells: Cells, style: str) -> None:
    """Print the cells of a report as a table, as CSV, or as one JSON object for each row."""
    if style == "table":
        shown = [(["" if cell is None else str(cell) for cell in row], "") for row in cells]
        numbers = {n for row in cells for n, cell in enumerate(row) if isinstance(cell, int | float)}
        print_table([title.replace("_percent", " %") for title in titles], shown, right=numbers)
    elif style == "json":
        for row in cells:
            pairs = zip(titles, row, strict=True)
            cells_of = {title: float(cell or 0) if title.endswith("_s") else cell for title, cell in pairs}
            click.echo(json.dumps(cells_of))
    else:
        csv.writer(sys.stdout, lineterminator="\n").writerows([titles, *cells])
