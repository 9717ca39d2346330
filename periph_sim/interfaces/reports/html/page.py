"""The HTML page with the reports of cases.

    CaseReports --jinja2--> assets/report.html, with assets/*.css and assets/*.js inside

Every text of a case is escaped by the template engine, in HTML and in JSON.
"""

from __future__ import annotations

import platform
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from importlib.resources import files

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup

from .... import form
from ....timing.verdict import PASS, Verdict, assumes, figure, in_words, instant, legend, limit, title
from ..explain.chain import Chain, Part, bound, largest
from .distribution import PAPER, number, plot
from .gather import BudgetReport, CaseReport
from .over_time import shown_unit, time_plot

STYLES = ("report.css", "budget.css", "timeline.css")
SCRIPTS = (  # each script is after the scripts that it uses while it is loaded
    "times.js",
    "lanes.js",
    "tooltip.js",
    "minimap.js",
    "protocol.js",
    "timeline.js",
    "overtime.js",
    "table.js",
    "folds.js",
)
STANDINGS = ("bad", "known", "good")  # the standings of cases, in the order in which the page lists the cases
MOST_FAILURES = 3  # maximum number of failures that the head of the page shows


def page(cases: Sequence[CaseReport], title: str, command: str = "", refused: Sequence[str] = ()) -> str:
    """Return the page as HTML without references to other files.

    title: the title of the page, and of the overview if there are several cases.
    command: the command line that made the page.
    refused: a sentence for each case that cannot be run.
    """
    # A row has the number of the case, the case, the number of the budget, and the budget.
    # Budgets with an unexpected result are first, and budgets that broke as expected are second. Failures of a case are
    # in order of time.
    budgets = [(*case, *one) for case in enumerate(cases, 1) for one in enumerate(case[1].budgets, 1)]
    rows = sorted(budgets, key=lambda row: (row[3].as_it_should_be, row[3].verdict.passed, row[0], _order(row[3])))
    return _template().render(
        cases=cases,
        refused=refused,
        ordered=sorted(enumerate(cases, 1), key=lambda one: STANDINGS.index(one[1].standing)),
        rows=rows,
        failures=[row for row in rows if row[3].failure is not None],
        most_failures=MOST_FAILURES,
        title=title,
        command=command,
        commits=list(dict.fromkeys(case.commit for case in cases if case.commit)),
        version=version("periph-sim"),
        versions=versions(),
    )


def _order(one: BudgetReport) -> float:
    return 0 if one.failure is None else one.failed_at


def versions() -> str:
    """Return the versions of the package and of Python, and the form of the core."""
    return f"periph-sim {version('periph-sim')}, {form.running}, Python {platform.python_version()}"


@cache
def _template() -> Template:
    pages = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    pages.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "ensure_ascii": False}
    pages.filters |= {"figure": figure, "instant": instant, "limit": limit, "share": _share}
    pages.filters |= {"standing": _standing, "instants": _instants, "assumes": assumes}
    pages.filters |= {"legend": legend, "title": _title}
    pages.filters |= {"gist": _gist, "allowed": _allowed, "parts": _parts}
    style, script = (Markup("\n".join(map(_text, names))) for names in (STYLES, SCRIPTS))
    pages.globals |= {"plot": plot, "paper": PAPER, "time_plot": time_plot, "style": style, "script": script}
    return pages.get_template("report.html")


def _text(name: str) -> str:
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")


def _standing(one: BudgetReport) -> str:
    """Return the result of a budget in words."""
    if one.must_break:
        return "broken, as it must" if one.verdict.broken else f"{one.verdict.word}, but must break"
    return one.verdict.word


def _title(case: CaseReport) -> str:
    """Return the verdict of a case in the words of the output of `periph-sim run`."""
    held = case.verdict == "pass" and all(one.verdict.passed for one in case.budgets)
    return title(PASS, [one.verdict for one in case.budgets]) if held else case.verdict.upper()


def _share(one: BudgetReport) -> float | None:
    """Return the worst value in percent of the limit, at most 100.

    Return None if nothing was measured, if the limit is a `min` or not above 0, or if the worst value is negative.
    """
    verdict = one.verdict
    if verdict.worst is None or verdict.which == "min" or verdict.limit <= 0 or verdict.worst < 0:
        return None
    return round(min(100 * verdict.worst / verdict.limit, 100), 1)


def _instants(one: BudgetReport) -> dict[str, object]:
    """Return the data for the script of the plot over time.

    The instants, in seconds, are those of the worst value, of values beyond a limit, and of values with a timeline.
    """
    over, rate = one.over_time, one.per_second
    assert over is not None
    unit, size = shown_unit(over, rate)
    worst = None if one.verdict.at_s is None else round(one.verdict.at_s * rate) / rate
    return {
        "end": over.end / rate,
        "worst": worst,
        "at": [at / rate for at, _ in over.violations],
        "texts": [f"{number(value / size)} {unit}".rstrip() for _, value in over.violations],
        "count": over.violation_count,
        "waves": ([worst] if one.timeline is not None else []) + [at / rate for at, _ in one.others],
    }


def _parts(chain: Chain) -> list[tuple[Part, float, str]]:
    """Return the largest parts of an explanation, each with its percentage and its excess.

    The excess is the difference from the least critical occurrence; "" if there is no difference.
    """
    more = {(part.doing, part.what): part.length for part in chain.more}
    rows = []
    for part in largest(chain.parts):
        ticks = more.get((part.doing, part.what), 0)
        excess = f"{'+' * (ticks > 0)}{chain.figure(ticks)}"
        known = "" if excess.lstrip("+-") == chain.figure(0) else excess
        rows.append((part, round(100 * part.length / chain.length, 1), known))
    return rows


def _gist(case: CaseReport) -> str:
    """Return a summary of a case: "9 of 11 budgets hold; 1 must break, and does"."""
    hold = sum(one.verdict.passed and not one.must_break for one in case.budgets)
    known = sum(one.must_break and one.as_it_should_be for one in case.budgets)
    said = f"{hold} of {len(case.budgets)} budgets hold"
    return f"{said}; {known} must break, and {'do' if known > 1 else 'does'}" if known else said


def _allowed(verdict: Verdict) -> str:
    """Format the limit of a verdict: "at most 60 us", "p99 at most 3.4 us"."""
    text = limit(verdict.limit, verdict.unit, "")
    return f"{bound(verdict.which)} {text if text != f'{verdict.limit}' else in_words(verdict.limit, verdict.unit)}"
