"""The differences of two captures as text and as JSON. Times are converted to floats only for this output."""

from __future__ import annotations

from fractions import Fraction
from itertools import groupby

from ...core.text_table import paragraph, text_table
from . import ChangePoint, Entry, KindSummary, TraceDiff

COUNTS = ("kind", "in both", "changed", "missing", "inserted")
LATENESS = ("kind", "median later", "worst later", "worst at (A)")
SHOWN = 10  # maximum number of entries of a list that are shown, unless all are requested
WORDS = 8  # maximum number of successive missing or inserted events that one line names


def text(diff: TraceDiff, everything: bool = False) -> str:
    """Format the report: the offset, tables of kinds of events, differences, and the verdict.

    everything: True to list all events, and to show each list in full length.
    """
    counts = [(one.kind, *map(str, (one.both, one.changed, one.missing, one.inserted))) for one in diff.kinds]
    parts = [_title(diff), "", *text_table(COUNTS, counts, range(1, len(COUNTS))), ""]
    parts += [*text_table(LATENESS, [_lateness(diff, one) for one in diff.kinds], range(1, len(LATENESS))), ""]
    if diff.first is not None:
        parts.append(f"first difference: {_said(diff, diff.first)}")
    parts += _list("lateness changes", [_step(diff, point) for point in diff.change_points], everything)
    parts += _list("not the same in both", _apart(diff), everything)
    if everything:
        parts += _list("every event", [_said(diff, entry) for entry in diff.entries], everything)
    return "\n".join([*parts, _conclusion(diff)])


def as_json(diff: TraceDiff, everything: bool = False) -> dict[str, object]:
    """Convert a diff to JSON, with times in seconds.

    everything: True to include events that do not differ.
    """
    return {
        "a": diff.name_a,
        "b": diff.name_b,
        "equal": diff.equal,
        "offset_s": None if diff.offset is None else float(diff.seconds(diff.offset)),
        "tolerance_s": float(diff.tolerance),
        "events": len(diff.entries),
        "missing": len(diff.missing),
        "inserted": len(diff.inserted),
        "changed": len(diff.changed),
        "late": len(diff.late),
        "kinds": [
            {
                "kind": kind.kind,
                "both": kind.both,
                "changed": kind.changed,
                "missing": kind.missing,
                "inserted": kind.inserted,
                "median_later_s": None if kind.median is None else float(diff.seconds(kind.median)),
                "worst_later_s": None if kind.worst is None else float(diff.seconds(kind.worst.later or 0)),
            }
            for kind in diff.kinds
        ],
        "change_points": [
            _entry(diff, point.entry) | {"step_s": float(diff.seconds(point.step)), "after": point.before.number}
            for point in diff.change_points
        ],
        "entries": [_entry(diff, entry) for entry in diff.entries if everything or diff.differs(entry)],
    }


def duration(seconds: Fraction) -> str:
    """Format a duration with its sign: in us if it is below 10 ms, in ms if it is below 10 s, otherwise in seconds."""
    us = float(seconds * 10**6)
    if abs(us) < 10_000:
        return f"{us:+.3f} us"
    return f"{us / 10**3:+.3f} ms" if abs(us) < 10**7 else f"{us / 10**6:+.6f} s"


def _title(diff: TraceDiff) -> str:
    lines = [f"A {diff.name_a}", f"B {diff.name_b}"]
    if diff.offset is not None:
        lines += paragraph(
            f"offset {duration(diff.seconds(diff.offset))}: B's time of the first event in both, less A's; "
            "lateness is counted from there"
        )
    return "\n".join(lines)


def _lateness(diff: TraceDiff, kind: KindSummary) -> tuple[str, ...]:
    worst = kind.worst
    return (
        kind.kind,
        "-" if kind.median is None else duration(diff.seconds(kind.median)),
        "-" if worst is None else duration(diff.seconds(worst.later or 0)),
        "-" if worst is None or not worst.later else _at(diff.time_a(worst)),
    )


def _said(diff: TraceDiff, entry: Entry) -> str:
    """Format one entry: `event 12: byte 1D changed to byte 1E, +1.500 us, at A ..., B ...`."""
    if entry.b is None:
        return f"event {entry.number}: {entry.event.word} is missing in B, at A {_at(diff.time_a(entry))}"
    if entry.a is None:
        return f"event {entry.number}: {entry.b.word} is inserted in B, at B {_at(diff.time_b(entry))}"
    what = f"{entry.a.word} changed to {entry.b.word}" if entry.changed else entry.a.word
    later = duration(diff.seconds(entry.later or 0))
    return f"event {entry.number}: {what}, {later}, at A {_at(diff.time_a(entry))}, B {_at(diff.time_b(entry))}"


def _apart(diff: TraceDiff) -> list[str]:
    """List changed, missing and inserted events. Successive missing or inserted events share one line."""
    apart = [entry for entry in diff.entries if entry.later is None or entry.changed]
    found: list[str] = []
    for _, same in groupby(enumerate(apart), lambda pair: (pair[1].number - pair[0], _sort(pair[1]))):
        row = [entry for _, entry in same]
        if _sort(row[0]) is None or len(row) == 1:
            found.extend(_said(diff, entry) for entry in row)
            continue
        words = [entry.event.word for entry in row]
        shown = ", ".join(words[:WORDS]) + (", ..." if len(words) > WORDS else "")
        where = _said(diff, row[0]).partition(" is ")[2]
        found.append(f"events {row[0].number} to {row[-1].number}: {shown}: {where}")
    return found


def _sort(entry: Entry) -> str | None:
    return "missing" if entry.b is None else "inserted" if entry.a is None else None


def _step(diff: TraceDiff, point: ChangePoint) -> str:
    """Format a change point with the event just before it, which may be in only one of the two captures."""
    before = diff.entries[point.entry.number - 1]
    only = "" if before.later is not None else ", which is inserted" if before.a is None else ", which is missing"
    after = (before.b or before.event).word
    return f"{duration(diff.seconds(point.step))} from {_said(diff, point.entry)}; after {after}{only}"


def _list(title: str, lines: list[str], everything: bool) -> list[str]:
    if not lines:
        return []
    shown = lines if everything else lines[:SHOWN]
    more = len(lines) - len(shown)
    return [f"{title}: {len(lines)}", *(f"  {line}" for line in shown), *([f"  and {more} more"] if more else [])]


def _conclusion(diff: TraceDiff) -> str:
    tolerance = _tolerance(diff.tolerance)
    if diff.equal:
        return f"EQUAL: {len(diff.entries)} events, all within {tolerance}"
    points = len(diff.change_points)
    return (
        f"DIFFERENT: {len(diff.missing)} missing, {len(diff.inserted)} inserted, {len(diff.changed)} changed, "
        f"{len(diff.late)} of {len(diff.entries)} off by more than {tolerance}, "
        f"{points} change{'s' * (points != 1)} of lateness"
    )


def _tolerance(seconds: Fraction) -> str:
    return f"{float(seconds * 10**9):g} ns" if seconds < Fraction(1, 10**6) else f"{float(seconds * 10**6):g} us"


def _entry(diff: TraceDiff, entry: Entry) -> dict[str, object]:
    at_a, at_b = diff.time_a(entry), diff.time_b(entry)
    return {
        "number": entry.number,
        "a": entry.a.word if entry.a else None,
        "b": entry.b.word if entry.b else None,
        "a_s": None if at_a is None else float(at_a),
        "b_s": None if at_b is None else float(at_b),
        "later_s": None if entry.later is None else float(diff.seconds(entry.later)),
    }


def _at(seconds: Fraction | None) -> str:
    return "-" if seconds is None else f"{float(seconds):.9f} s"
