"""Figures of budgets as test properties, and back as a table.

    Verdict --properties--> ("periph-sim/CASE/BUDGET/worst_us", 5.0) in user_properties --> JUnit XML
                                    |  (through pytest-xdist, too)
                                    '--table--> the terminal summary

The code that runs cases is not imported: another process may have run them.
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
UNBROKEN = 10_000  # columns of a table with names of tests, so their paths can be copied
VALUES = ("worst", "limit", "margin")

Property = tuple[str, object]


def properties(case: str, verdict: Verdict) -> list[Property]:
    """Return verdict, unit, worst, limit, margin (with `_us` in their names for microseconds), which, count, measured,
    occasions, at_s; "" for none.
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

    label: str  # case/budget
    test: str
    expected: bool  # the test was expected to fail
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
    """Return the budgets in reports of tests, by test; a test's last report has all of its budgets.

    Budgets judged several times with the same figures appear once.
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
    """Return lines of the terminal summary, and whether each is good. Empty if no budget was judged."""
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
