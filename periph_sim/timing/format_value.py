"""Figures of verdicts as short texts.

Imports no other module of this package at run time, so that showing figures does not load the measures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .verdict import Verdict

PLAIN = ("count", "value")  # units that say nothing beside a number


def figure(value: float | int | None, unit: str) -> str:
    """Return a value as text: `5.000 us`, `17.380 ms`, `1.28 %`, or a plain count; `-` for None."""
    if value is None:
        return "-"
    if unit == "%":
        return f"{value:.2f} %"
    if unit == "LSB":
        return f"{value:.3f} LSB"
    if unit != "us":
        return f"{value}"
    return f"{value:.3f} us" if abs(value) < 1000 else f"{value / 1000:.3f} ms"


def in_words(value: float | int, unit: str) -> str:
    """Return a figure for use within a sentence, where no column names the unit: `12 words`."""
    text = figure(value, unit)
    return f"{text} {unit}" if unit not in PLAIN and text == f"{value}" else text


def limit(value: float | int, unit: str, which: str) -> str:
    """Return a limit as text, to the nanosecond: `60 us`, `= 150`, `p99 3.4 us`. which: its key."""
    number, blank, symbol = figure(value, unit).partition(" ")
    if symbol == "ms":
        number = f"{value / 1000:.6f}"
    text = f"{number.rstrip('0').rstrip('.') if '.' in number else number}{blank}{symbol}"
    if which in ("max", "min", ""):
        return text
    return f"{'=' if which == 'exactly' else percentile(which)} {text}"


def simulated(seconds: float) -> str:
    """Return the length of a run as text: `1.5 s`, `6.667 us`."""
    return f"{seconds * 1_000_000:.3f} us" if 0 < seconds < 0.001 else f"{seconds:g} s"


def duration_text(seconds: float) -> str:
    """Return a duration as text: `60 ms`, `10 s`."""
    return f"{seconds * 1000:g} ms" if seconds < 1 else f"{seconds:g} s"


def percentile(which: str) -> str:
    """Return the percentile of a limit's key, such as `p99.9`."""
    return which.replace("_", ".")


def instant(at_s: float | None) -> str:
    """Return an instant as text, such as `0.005290 s`, or `-` for None."""
    return "-" if at_s is None else f"{at_s:.6f} s"


def broken(verdict: Verdict) -> str:
    """Return why a budget is broken, as a phrase: `37.153 ms is over its limit of 25.000 ms, at 0.025195 s`."""
    if verdict.worst is None or (verdict.margin is not None and verdict.margin >= 0):
        return verdict.found
    over = "over" if verdict.worst > verdict.limit else "under"
    at = "" if verdict.at_s is None else f", at {instant(verdict.at_s)}"
    found = f" ({verdict.found})" if verdict.found else ""
    worst, limit = (in_words(value, verdict.unit) for value in (verdict.worst, verdict.limit))
    return f"{worst} is {over} its limit of {limit}{at}{found}"
