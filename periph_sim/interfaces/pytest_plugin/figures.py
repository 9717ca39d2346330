"""Figures of budgets as properties of tests, and the summary table that is made from these properties.

    Verdict --properties--> ("periph-sim/CASE/BUDGET/worst_us", 5.0) in user_properties --> JUnit XML
                                    |  (through pytest-xdist, too)
                                    '--table--> the terminal summary

The code that runs cases is not imported here, because another process may have run the cases.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...core.text_table import WIDTH, table_rows

if TYPE_CHECKING:
    from ...timing.verdict import Verdict

HEAD = "periph-sim/"
FIRST = "verdict"  # the name of the first property of each budget
UNBROKEN = 10_000  # number of columns of a table with names of tests, so that a long name is on one line
VALUES = ("worst", "limit", "margin")

Property = tuple[str, object]


def properties(case: str, verdict: Verdict) -> list[Property]:
    """Return the figures of a verdict as properties of a test.

    `verdict` is `Verdict.word`. The other figures are the fields unit, worst, limit, margin, which, count, measured,
    occasions and at_s. If the unit is us, the names of worst, limit and margin end in `_us`. A missing figure is "".
    """
    tail = "_us" if verdict.unit == "us" else ""
    figures: dict[str, object] = {FIRST: verdict.word, "unit": verdict.unit}
    figures |= {f"{name}{tail}": _plain(getattr(verdict, name)) for name in VALUES}
    figures |= {"which": verdict.which, "count": verdict.count, "measured": verdict.measured}
    figures |= {"occasions": _plain(verdict.occasions), "at_s": _plain(verdict.at_s)}
    return [(f"{HEAD}{case}/{verdict.name}/{name}", value) for name, value in figures.items()]


def _plain(value: float | int | None) -> float | int | str:
    return "" if value is None else value


# Figures of a budget if only its verdict is known, for example because a user's own test records no other property.
UNKNOWN: dict[str, Any] = {"unit": "", "worst": None, "limit": None, "which": "", "at_s": None}
# A judged budget: "CASE/BUDGET", the test, and a dictionary from the names of figures, without `_us`, to values.
Judged = tuple[str, str, dict[str, Any]]


def judged(longest: Mapping[str, Sequence[Property]]) -> list[Judged]:
    """Return the budgets that tests have judged, in the order of the tests.

    longest: a dictionary from each test to its properties. pytest makes several reports of a test, and the properties
        are those of the report that has the most.

    A budget that a test judged several times with the same figures is returned once.
    """
    found: list[Judged] = []
    for test, given in longest.items():
        for name, value in given:
            if not str(name).startswith(HEAD):
                continue
            label, _, what = name.removeprefix(HEAD).rpartition("/")
            if what == FIRST:
                found.append((label, test, {**UNKNOWN}))
            if found:
                found[-1][2][what.removesuffix("_us")] = None if value == "" else value
    return [one for number, one in enumerate(found) if one not in found[:number]]


def table(reports: Iterable[Any]) -> list[tuple[str, bool]]:
    """Return the lines of the terminal summary; an empty list if no test judged a budget.

    Each line has a second value, which is False for a budget that did not pass and was not expected to break.

    pytest makes several reports of a test. The report with the most properties has all budgets of the test.
    """
    longest: dict[str, Sequence[Property]] = {}
    expected: set[str] = set()
    for report in reports:
        if hasattr(report, "wasxfail"):
            expected.add(report.nodeid)
        given = getattr(report, "user_properties", ())
        if len(given) > len(longest.get(report.nodeid, ())):
            longest[report.nodeid] = given
    budgets = judged(longest)
    if not budgets:
        return []
    from ...timing.verdict import PROVEN, SEEN, figure, instant, limit

    titles: tuple[str, ...] = ("case/budget", "seen", "limit", "when", "", "judged by")
    rows: list[tuple[str, ...]] = []
    good: list[bool] = []
    for label, test, of in budgets:
        numbers = (figure(of["worst"], of["unit"]), limit(of["limit"], of["unit"], of["which"]), instant(of["at_s"]))
        word = str(of[FIRST])
        passed = word in (SEEN, PROVEN)
        known = test in expected and not passed
        rows.append((label, *numbers, f"{word}, as expected" if known else word, "" if ".toml::" in test else test))
        good.append(known or passed)
    width = UNBROKEN
    if not any(row[-1] for row in rows):
        titles, rows, width = titles[:-1], [row[:-1] for row in rows], WIDTH
    head, *body = table_rows(titles, rows, right=range(1, 4), width=width)
    return [(line, True) for line in head] + [
        (line, well) for lines, well in zip(body, good, strict=True) for line in lines
    ]
