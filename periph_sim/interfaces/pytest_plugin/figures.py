"""Figures of budgets as properties of tests, and the table that is made from these properties.

    Verdict --properties--> ("periph-sim/CASE/BUDGET/worst_us", 5.0) in user_properties --> JUnit XML
                                    |  (through pytest-xdist, too)
                                    '--table--> the terminal summary

The code that runs cases is not imported here, because another process may have run them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...core.text_table import WIDTH, table_rows

if TYPE_CHECKING:
    from ...timing.verdict import Verdict

HEAD = "periph-sim/"
FIRST = "verdict"  # the first figure of each budget
UNBROKEN = 10_000  # number of columns of a table with names of tests: no name is broken, so that it can be copied
VALUES = ("worst", "limit", "margin")

Property = tuple[str, object]


def properties(case: str, verdict: Verdict) -> list[Property]:
    """Return the figures of a verdict as properties of a test.

    These are verdict, unit, worst, limit, margin, which, count, measured, occasions and at_s. The names of times in
    microseconds end in `_us`. A missing figure is "".
    """
    tail = "_us" if verdict.unit == "us" else ""
    figures: dict[str, object] = {FIRST: verdict.verdict, "unit": verdict.unit}
    figures |= {f"{name}{tail}": _plain(getattr(verdict, name)) for name in VALUES}
    figures |= {"which": verdict.which, "count": verdict.count, "measured": verdict.measured}
    figures |= {"occasions": _plain(verdict.occasions), "at_s": _plain(verdict.at_s)}
    return [(f"{HEAD}{case}/{verdict.name}/{name}", value) for name, value in figures.items()]


def _plain(value: float | int | None) -> float | int | str:
    return "" if value is None else value


@dataclass
class Judged:
    """One budget that a test judged, read back from its properties."""

    label: str  # the text "case/budget"
    test: str
    expected: bool  # True if the test was expected to fail
    figures: dict[str, Any] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        verdict: str = self.figures[FIRST]
        if verdict == "pass":
            return "seen"
        word = "broken" if verdict == "fail" else verdict
        return f"{word}, as expected" if self.expected else word

    def value(self, name: str) -> Any:
        value = self.figures.get(f"{name}_us", self.figures.get(name, ""))
        return None if value == "" else value


def judged(reports: Iterable[Any]) -> list[Judged]:
    """Return the budgets in the reports of tests, ordered by test. The last report of a test has all of its budgets.

    A budget that a test judged several times with the same figures is returned once.
    """
    longest: dict[str, Sequence[Property]] = {}
    expected: set[str] = set()
    for report in reports:
        if hasattr(report, "wasxfail"):
            expected.add(report.nodeid)
        given = getattr(report, "user_properties", ())
        if len(given) > len(longest.get(report.nodeid, ())):
            longest[report.nodeid] = given
    found: list[Judged] = []
    for test, given in longest.items():
        for name, value in given:
            if not str(name).startswith(HEAD):
                continue
            label, _, what = name.removeprefix(HEAD).rpartition("/")
            if what == FIRST:
                found.append(Judged(label, test, test in expected))
            if found:
                found[-1].figures[what] = value
    return [one for number, one in enumerate(found) if one not in found[:number]]


def table(reports: Iterable[Any]) -> list[tuple[str, bool]]:
    """Return the lines of the terminal summary, each with True if it is good. Empty if no budget was judged."""
    budgets = judged(reports)
    if not budgets:
        return []
    from ...timing.verdict import figure, instant, limit

    titles: tuple[str, ...] = ("case/budget", "seen", "limit", "when", "", "judged by")
    rows: list[tuple[str, ...]] = []
    for one in budgets:
        unit = one.figures.get("unit", "")
        numbers = (figure(one.value("worst"), unit), limit(one.value("limit"), unit, one.figures.get("which", "")))
        by = "" if ".toml::" in one.test else one.test
        rows.append((one.label, *numbers, instant(one.value("at_s")), one.verdict, by))
    width = UNBROKEN
    if not any(row[-1] for row in rows):
        titles, rows, width = titles[:-1], [row[:-1] for row in rows], WIDTH
    head, *body = table_rows(titles, rows, right=range(1, 4), width=width)
    good = [one.figures[FIRST] == "pass" or one.expected for one in budgets]
    return [(line, True) for line in head] + [
        (line, well) for lines, well in zip(body, good, strict=True) for line in lines
    ]
