"""The page: reports of cases go in, the text of one HTML file comes out.

    CaseReports --jinja2--> assets/report.html, with assets/*.css and assets/*.js inside

Every text of a case is escaped: the template engine does it for HTML, `_data` for JSON within it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from importlib.resources import files

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup

from ...timing.format_value import figure, instant, limit
from .model import BudgetReport, CaseReport
from .plot import plot

STYLES = ("report.css", "timeline.css")
SCRIPTS = ("times.js", "lanes.js", "timeline.js", "table.js")  # in the order in which they need each other


def page(cases: Sequence[CaseReport], title: str) -> str:
    """HTML without any reference to another file. title: of the page, and of its overview where there are several."""
    return _template().render(cases=cases, title=title, version=version("periph-sim"))


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
    pages.filters |= {"data": _data, "figure": figure, "instant": instant, "limit": limit, "share": _share}
    pages.filters |= {"standing": _standing, "plot": _plot}
    pages.globals |= {"style": _joined(STYLES), "script": _joined(SCRIPTS), "worst_first": _worst_first}
    return pages.get_template("report.html")


def _text(name: str) -> str:
    text: str = (files(__package__) / "assets" / name).read_text(encoding="utf-8")
    return text


def _joined(names: Sequence[str]) -> Markup:
    return Markup("\n".join(_text(name) for name in names))


def _data(value: object) -> Markup:
    """Compact JSON that can stand in a script element: no `<` in it, so none that ends it."""
    return Markup(json.dumps(value, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c"))


def _standing(one: BudgetReport) -> str:
    """How a budget stands, in words."""
    if one.must_break:
        return "broken, as it must" if one.verdict.broken else f"{one.verdict.word}, but must break"
    return one.verdict.word


def _share(one: BudgetReport) -> float | None:
    """What part of a `max` the worst came to, in percent; None where there is no such part."""
    verdict = one.verdict
    if verdict.worst is None or verdict.which == "min" or verdict.limit <= 0 or verdict.worst < 0:
        return None
    return round(min(100 * verdict.worst / verdict.limit, 100), 1)


def _plot(one: BudgetReport) -> object:
    assert one.distribution is not None
    return plot(one.distribution, least_is_worst=one.verdict.which == "min")


def _worst_first(cases: Sequence[CaseReport]) -> list[tuple[int, CaseReport, int, BudgetReport]]:
    """All budgets with the places of case and budget: first what is not as it should be, then what else is broken."""
    rows = [
        (place, case, number, one) for place, case in enumerate(cases, 1) for number, one in enumerate(case.budgets, 1)
    ]
    return sorted(rows, key=lambda row: (row[3].as_it_should_be, row[3].verdict.passed))
