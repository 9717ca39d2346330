"""The verdict on one capture, from its measured times, as text, JSON or an AssertionError.

    Measures + LIMITS + Resolution --judge--> one Row per limit --> Report

Each time is measured with an error, so it has several possible true values. A time passes if all of these values are
within the limit. It fails if none of them is, unless it is not certain that the limit applies (`Measured.doubtful`), or
the time is too long and an edge within it may have been missed. Otherwise it is undecidable. Maxima do not apply to
excused times (`Measured.excused`). A row fails if any of its times fails. Otherwise it is undecidable if any of its
times is undecidable, or if a pulse between two samples may have been missed. Otherwise it passes. Floats are used only
in texts and JSON; all calculations are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

import numpy as np

from ...core.exact_number import short_time, trimmed
from ...core.text_table import paragraph, text_table
from ..decode.i2c import Party
from .limits import STRETCHED, Bounds, Limit, Mode, Resolution
from .measure import PARTY, Flags, Measured, Measures

PLACES = 3  # maximum number of worst occurrences that a row lists


class Verdict(Enum):
    PASS = "pass"
    FAIL = "fail"
    UNDECIDABLE = "undecidable at this sample rate"
    NOT_SEEN = "does not occur"
    NOT_JUDGED = "not judged: nothing was measured"  # a verdict on a whole capture, not on one limit
    NO_LIMIT = "no limit in this mode"
    NOT_IN_CAPTURE = "not in a logic capture"


@dataclass(frozen=True)
class Occurrence:
    """A measured time that breaks its limit or may break it.

    at: the position at which the time begins.
    length: the length of the time, in positions.
    party: the party that caused the time; None if the cause is unknown.
    """

    at: int
    length: int
    party: Party | None


@dataclass(frozen=True)
class Row:
    """The verdict on one limit.

    A measured time is undecidable if it is neither certain to be within the limit nor certain to break it.

    count: the number of measured times.
    least, most: the shortest and the longest measured time, in positions; None if nothing was measured.
    failed: how many of the measured times certainly break the limit.
    undecided: how many of them are undecidable.
    excused: how many of them exceed the maximum, or may exceed it, although the maximum does not apply to them.
    unsure: how many of them are beyond the limit, but undecidable, because the limit may not apply to them.
    worst: the worst occurrences, at most PLACES, in order from the worst.
    """

    limit: Limit
    bounds: Bounds
    count: int
    least: int | None
    most: int | None
    verdict: Verdict
    failed: int = 0
    undecided: int = 0
    excused: int = 0
    unsure: int = 0
    worst: tuple[Occurrence, ...] = ()


def row_of(limit: Limit, measures: Measures, mode: Mode, resolution: Resolution) -> Row:
    """Return the verdict on one limit of a mode."""
    found = measures.times.get(limit.symbol)
    bounds = limit.bounds[mode]
    if not limit.seen:
        return Row(limit, bounds, 0, None, None, Verdict.NOT_IN_CAPTURE)
    if bounds == Bounds():
        return Row(limit, bounds, 0, None, None, Verdict.NO_LIMIT)
    # True if pulses may be missing in the capture: a pulse that is shorter than a sample can be between two samples.
    hidden = measures.blind or (limit.symbol == "tSP" and resolution.period > (bounds.most or 0))
    if found is None or not len(found.lengths):
        return Row(limit, bounds, 0, None, None, Verdict.UNDECIDABLE if hidden or measures.coarse else Verdict.NOT_SEEN)
    return _judged(limit, bounds, found, resolution, hidden, measures.coarse)


def _judged(limit: Limit, bounds: Bounds, found: Measured, resolution: Resolution, hidden: bool, coarse: bool) -> Row:
    lengths = found.lengths
    kept = np.ones(len(lengths), np.bool_)
    broken = np.zeros(len(lengths), np.bool_)
    excused = 0
    if bounds.least is not None:
        kept &= lengths >= resolution.surely_at_least(bounds.least)
        broken |= lengths <= resolution.surely_below(bounds.least)
    if bounds.most is not None:
        within = lengths <= resolution.surely_at_most(bounds.most)
        excused = int((found.excused & ~within).sum())
        kept &= within | found.excused
        if not (hidden or coarse):  # otherwise, edges may have been missed, and one long time may be two short times
            broken |= (lengths >= resolution.surely_above(bounds.most)) & ~found.excused
    unsure = int((broken & found.doubtful).sum())
    broken &= ~found.doubtful
    failed, undecided = int(broken.sum()), int((~kept & ~broken).sum())
    if failed:
        verdict, culprits = Verdict.FAIL, broken
    else:
        verdict = Verdict.UNDECIDABLE if undecided or hidden else Verdict.PASS
        culprits = ~kept
    worst = _worst(found, culprits, bounds, resolution)
    least, most = int(lengths.min()), int(lengths.max())
    return Row(limit, bounds, len(lengths), least, most, verdict, failed, undecided, excused, unsure, worst)


def _worst(found: Measured, culprits: Flags, bounds: Bounds, resolution: Resolution) -> tuple[Occurrence, ...]:
    """Return the worst of the times that are marked in `culprits`, at most PLACES.

    The first one is the time that is farthest beyond the limit, or that may be farthest beyond it.
    """
    which = np.flatnonzero(culprits)
    lengths = found.lengths[which]
    beyond = np.full(len(which), np.iinfo(np.int64).min)
    if bounds.least is not None:
        beyond = np.maximum(beyond, resolution.surely_at_least(bounds.least) - lengths)
    if bounds.most is not None:
        beyond = np.maximum(beyond, lengths - resolution.surely_at_most(bounds.most))
    order = which[np.argsort(-beyond, kind="stable")[:PLACES]]
    return tuple(
        Occurrence(int(found.begins[k]), int(found.lengths[k]), PARTY[int(found.party[k])]) for k in order.tolist()
    )


@dataclass(frozen=True)
class Report:
    """The verdict on one capture.

    starts: the number of STARTs and repeated STARTs.
    shared: the number of positions at which both lines change.
    notes: sentences for the user.
    """

    name: str
    mode: Mode
    resolution: Resolution
    rows: tuple[Row, ...]
    starts: int
    shared: int
    notes: tuple[str, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The verdict on the capture.

        The verdict is NOT_JUDGED if no time with a limit was measured. Otherwise it is FAIL if any row fails, otherwise
        UNDECIDABLE if any row is undecidable, and otherwise PASS.
        """
        found = {row.verdict for row in self.rows}
        judged = {row.verdict for row in self.rows if row.count}
        if not judged & {Verdict.PASS, Verdict.FAIL, Verdict.UNDECIDABLE}:
            return Verdict.NOT_JUDGED
        if Verdict.FAIL in found:
            return Verdict.FAIL
        return Verdict.UNDECIDABLE if Verdict.UNDECIDABLE in found else Verdict.PASS

    def row(self, symbol: str) -> Row:
        """Return the row of a limit. Raise KeyError if there is no such limit."""
        for row in self.rows:
            if row.limit.symbol == symbol:
                return row
        raise KeyError(f"there is no limit {symbol!r}; there are {', '.join(row.limit.symbol for row in self.rows)}")

    def symbols_with(self, verdict: Verdict) -> list[str]:
        """Return the symbols of the limits with this verdict."""
        return [row.limit.symbol for row in self.rows if row.verdict is verdict]

    def assert_compliant(self, strict: bool = False) -> None:
        """Raise AssertionError, with the broken limits and their worst occurrences, if a limit is broken.

        AssertionError is also raised if no time with a limit was measured.

        strict: True if an undecidable limit counts as broken.
        """
        if self.verdict is Verdict.NOT_JUDGED:
            raise AssertionError(f"{self.name}: no time of the I2C limits was measured; the trace has no whole bit")
        wanted = {Verdict.FAIL, Verdict.UNDECIDABLE} if strict else {Verdict.FAIL}
        if self.verdict not in wanted:
            return
        lines = [f"{self.name} does not keep the I2C limits of mode {self.mode.value}:"]
        for row in self.rows:
            if row.verdict in wanted:
                lines.append(
                    f"  {row.limit.symbol} ({row.limit.begins} -> {row.limit.ends}) {row.verdict.value}: "
                    f"{limit_text(row.bounds)}, {row.failed or row.undecided} of {row.count}"
                )
                lines.extend(f"    {_place(self, place)}" for place in row.worst)
        raise AssertionError("\n".join(lines))

    def seconds(self, position: int) -> Fraction:
        return position / self.resolution.rate

    def __str__(self) -> str:
        """Format a table of the measured times, a table of the worst occurrences, the notes and the verdict."""
        lines = text_table(MEASURED, [_measured(self, row) for row in self.rows], (2, 3, 4))
        rules = text_table(RULES, [_rule(self, row) for row in self.rows], (2,))
        period = self.resolution.period
        exactness = f"each time good to {short_time(period)} either way" if period else "times exact"
        title = f"{self.name}: I2C limits of mode {self.mode.value}, {exactness}"
        remarks = [line for note in _remarks(self) for line in paragraph(f"note: {note}")]
        return "\n".join([title, "", *lines, "", *rules, "", *remarks, _conclusion(self)])


MEASURED = ("symbol", "limit", "min", "max", "count", "verdict")
RULES = ("symbol", "from -> to", "worst begins at", "by")


def as_json(report: Report) -> dict[str, object]:
    """Convert a report to JSON. A key that ends in `_s` or `_ns` has a time in seconds or nanoseconds."""
    return {
        "capture": report.name,
        "mode": report.mode.value,
        "verdict": report.verdict.value,
        "positions_per_second": float(report.resolution.rate),
        "exact_to_ns": float(report.resolution.period),
        "starts": report.starts,
        "both_lines_at_once": report.shared,
        "rows": [_json_row(report, row) for row in report.rows],
        "notes": _remarks(report),
    }


def limit_text(bounds: Bounds) -> str:
    """Format bounds as `min 4.7 us`, `0 to 3.45 us` or `max 50 ns`, or as `-` if there are none."""
    if bounds.least is None and bounds.most is None:
        return "-"
    if bounds.most is None:
        return f"min {short_time(Fraction(bounds.least or 0))}"
    if bounds.least is None:
        return f"max {short_time(Fraction(bounds.most))}"
    least = Fraction(bounds.least, 1000 if bounds.most >= 1000 else 1)
    return f"{trimmed(least)} to {short_time(Fraction(bounds.most))}"


def _measured(report: Report, row: Row) -> tuple[str, ...]:
    resolution = report.resolution
    verdict = "undecidable" if row.verdict is Verdict.UNDECIDABLE else row.verdict.value
    if row.failed:
        verdict = f"FAIL, {row.failed} of {row.count}"
        verdict += f", {row.undecided} undecidable" if row.undecided else ""
    elif row.undecided:
        verdict += f", {row.undecided} of {row.count}"
    return (
        row.limit.symbol,
        limit_text(row.bounds),
        short_time(resolution.ns(row.least)) if row.least is not None else "-",
        short_time(resolution.ns(row.most)) if row.most is not None else "-",
        str(row.count) if row.count else "-",
        verdict,
    )


def _rule(report: Report, row: Row) -> tuple[str, ...]:
    worst = row.worst[0] if row.worst else None
    measured = f"{row.limit.begins} -> {row.limit.ends}"
    if row.limit.symbol == "fSCL" and row.bounds.least is not None:
        measured += f", {10**6 // row.bounds.least} kHz"
    return (
        row.limit.symbol,
        measured,
        f"{float(report.seconds(worst.at)):.9f} s" if worst is not None else "-",
        worst.party.value if worst is not None and worst.party else "",
    )


def _remarks(report: Report) -> list[str]:
    excused = [row for row in report.rows if row.excused]
    found = []
    if excused:
        counts = ", ".join(f"{row.limit.symbol} {row.excused}" for row in excused)
        found.append(f"beyond a maximum where it does not bind: {counts}; {STRETCHED}")
    unsure = [row for row in report.rows if row.unsure and row.bounds.most is not None]
    if unsure:
        counts = ", ".join(f"{row.limit.symbol} {row.unsure}" for row in unsure)
        found.append(f"a maximum that binds only where SCL is not stretched, which these samples do not tell: {counts}")
    spikes = report.row("tSP")
    if spikes.count:
        found.append(f"tSP: {spikes.count} spikes were removed before the measurement; {spikes.limit.rule}")
    elif spikes.verdict is Verdict.UNDECIDABLE:
        found.append("tSP: no spike is seen, but one may lie between two samples")
    if report.shared:
        found.append(f"both lines change at once at {report.shared} positions; which came first is not known")
    return [*found, *report.notes]


def _conclusion(report: Report) -> str:
    if report.verdict is Verdict.NOT_JUDGED:
        return "NOT JUDGED: nothing was measured"
    failed, open_rows = report.symbols_with(Verdict.FAIL), report.symbols_with(Verdict.UNDECIDABLE)
    if failed:
        return f"FAIL: {', '.join(failed)}"
    if open_rows:
        return f"UNDECIDABLE at this sample rate: {', '.join(open_rows)}; nothing that can be decided fails"
    return "PASS"


def _place(report: Report, place: Occurrence) -> str:
    by = f", driven by the {place.party.value}" if place.party else ""
    length = short_time(report.resolution.ns(place.length))
    return f"{length} at {float(report.seconds(place.at)):.9f} s (position {place.at}){by}"


def _json_row(report: Report, row: Row) -> dict[str, object]:
    def seconds(positions: int | None) -> float | None:
        return None if positions is None else float(report.seconds(positions))

    return {
        "symbol": row.limit.symbol,
        "from": row.limit.begins,
        "to": row.limit.ends,
        "limit_min_ns": row.bounds.least,
        "limit_max_ns": row.bounds.most,
        "min_s": seconds(row.least),
        "max_s": seconds(row.most),
        "count": row.count,
        "failed": row.failed,
        "undecided": row.undecided,
        "excused": row.excused,
        "unsure": row.unsure,
        "verdict": row.verdict.value,
        "worst": [
            {
                "at": place.at,
                "at_s": seconds(place.at),
                "length_s": seconds(place.length),
                "party": place.party.value if place.party else None,
            }
            for place in row.worst
        ],
    }
