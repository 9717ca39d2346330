"""A report of the extremes as text and as JSON."""

from __future__ import annotations

from ...core.text_table import paragraph, text_table
from ..models.quantity import described
from ..numeric.estimate import MEASURED, SYSCLK
from . import SWEEPS, ExtremesReport
from .frames import REFERENCE, SENSORS
from .sweep import EVERY, ExtremeFinding

Rows = list[list[str]]


def text(report: ExtremesReport) -> str:
    """Format tables of the errors in the working range, the costs, the cycles by part, and the findings."""
    return "\n".join(
        [
            "working range: largest error found against float64, in LSB before rounding",
            "",
            *_table(_error_rows(report)),
            "",
            "cost of a sample at 150 MHz",
            f"tables of the libraries are in {report.costs[report.names[0]].tables}",
            "",
            *_table(_total_rows(report)),
            "",
            f"cycles by part; measured: {float(MEASURED) * 1e6:g} us, {round(MEASURED * SYSCLK)} cycles",
            "",
            *_table(_cost_rows(report)),
            *_without_fastrts(report),
            "",
            *_titled("extremes: effect, and the first input with it", _extreme_rows(report)),
            *_titled("time, clocks, lines and inputs, for any arithmetic", _common_rows(report)),
            *_remarks(report),
        ]
    )


def _table(rows: Rows) -> list[str]:
    """Format rows as a table. The first row contains the titles of the columns."""
    return text_table(rows[0], rows[1:])


def _error_rows(report: ExtremesReport) -> Rows:
    errors = [(name, report.errors.get(name)) for name in report.names]
    return [
        ["arithmetic", *SENSORS],
        *([name, *("0" if one is None else f"{one.error[sensor]:.2g}" for sensor in SENSORS)] for name, one in errors),
    ]


def _total_rows(report: ExtremesReport) -> Rows:
    rows = [["arithmetic", "cycles", "us", "library"]]
    for name in report.names:
        cost = report.costs[name]
        micro = [float(cycles * 1_000_000 / SYSCLK) for cycles in (cost.low, cost.high)]
        rows.append([name, _span(cost.low, cost.high), _span(*micro), cost.library.name])
    return rows


def _cost_rows(report: ExtremesReport) -> Rows:
    costs = [report.costs[name] for name in report.names]
    return [
        ["part", *report.names],
        *([part, *(_span(*cost.parts[part]) for cost in costs)] for part in costs[0].parts),
        ["not explained", *(_rest(*cost.left_of()) for cost in costs)],
    ]


def _without_fastrts(report: ExtremesReport) -> list[str]:
    if "float32" not in report.names:
        return []
    cost = report.without_fastrts
    return [f"float32 with {cost.library.name} instead: {_span(cost.low, cost.high)} cycles, by a guess"]


def _extreme_rows(report: ExtremesReport) -> Rows:
    rows = [["extreme", "unit", *report.names]]
    by_extreme: dict[str, dict[str, ExtremeFinding]] = {}
    for finding in report.findings:
        by_extreme.setdefault(finding.extreme, {})[finding.arithmetic] = finding
    for extreme, found in by_extreme.items():
        if EVERY not in found:
            unit = next(iter(found.values())).unit
            rows.append([extreme, unit, *(_cell(found[name]) for name in report.names)])
    return rows


def _common_rows(report: ExtremesReport) -> Rows:
    rows = [["extreme", "what happens", "from"]]
    for one in report.findings:
        if one.arithmetic == EVERY:
            begins = "" if one.begins is None else f"{one.begins:.6g} {one.unit}"
            rows.append([one.extreme, one.happens, begins])
    return rows


def _titled(title: str, rows: Rows) -> list[str]:
    """Format a title, a table and an empty line; return no lines if the table has no rows."""
    return [title, "", *_table(rows), ""] if len(rows) > 1 else []


def _cell(finding: ExtremeFinding) -> str:
    return finding.happens if finding.begins is None else f"{finding.happens} {finding.begins:.4g}"


def _remarks(report: ExtremesReport) -> list[str]:
    remarks = [f"{sweep.name}: {sweep.what}" for sweep in SWEEPS if report.findings_for(sweep.name)]
    for finding in report.findings:
        if finding.note:
            of = "" if finding.arithmetic == EVERY else f", {finding.arithmetic}"
            remarks.append(f"{finding.extreme}{of}: {finding.note}")
    if REFERENCE in report.names:
        remarks.append(f"{REFERENCE} is the reference: at full scale its converter returns its lowest or highest code")
    return [line for remark in remarks for line in paragraph(remark)]


def _span(low: float, high: float) -> str:
    """Format a range as "low to high", or as one number if both ends look the same."""
    first, last = (f"{value:.4g}" if value < 1000 else f"{value:.0f}" for value in (low, high))
    return first if first == last else f"{first} to {last}"


def _rest(least: int, most: int) -> str:
    return "nothing left" if most < 0 else _span(max(least, 0), most)


def as_json(report: ExtremesReport) -> dict[str, object]:
    """Convert a report to a dictionary for JSON. `begins` of a finding is null if no single input causes its effect."""
    return {
        "reference": REFERENCE,
        "seed": report.seed,
        "parameters": [
            {"name": name, "value": value, "unit": unit, "source": source}
            for name, value, unit, source in described(report.imu)
        ],
        "measured_cycles": round(MEASURED * SYSCLK),
        "float32_without_fastrts_cycles": [report.without_fastrts.low, report.without_fastrts.high],
        "arithmetics": [_arithmetic(report, name) for name in report.names],
        "findings": [
            {
                "extreme": one.extreme,
                "arithmetic": one.arithmetic,
                "happens": one.happens,
                "begins": one.begins,
                "overflows": one.overflows,
                "unit": one.unit,
                "worst_lsb": one.worst,
                "note": one.note,
            }
            for one in report.findings
        ],
    }


def _arithmetic(report: ExtremesReport, name: str) -> dict[str, object]:
    cost, error = report.costs[name], report.errors.get(name)
    return {
        "name": name,
        "library": cost.library.name,
        "guessed": cost.guessed,
        "cycles": [cost.low, cost.high],
        "parts": {part: list(cycles) for part, cycles in cost.parts.items()},
        "operations": dict(cost.counts),
        "not_explained_cycles": list(cost.left_of()),
        "error_lsb": {sensor: 0.0 if error is None else error.error[sensor] for sensor in SENSORS},
        "error_at": {} if error is None else {sensor: error.at[sensor].tolist() for sensor in SENSORS},
    }
