"""The worst case in closed form beside the largest value seen: a case goes in, bounds with their terms come out.

    case --calm run--> waits and code --.
         --host alone--> routines -------+--> closed form --> response, round, slack, age, spans
                                                                  beside: the same measures of a run

A bound takes its figures from the case and from straight-line code measured undisturbed, never from the worst value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .compare_with_run import BoundWithRun, Report, report
    from .terms import BadBound, Bound, Term

__all__ = ["BadBound", "Bound", "BoundWithRun", "Report", "Term", "report"]

__getattr__ = lazy_names(
    __name__,
    {"compare_with_run": ("BoundWithRun", "Report", "report"), "terms": ("BadBound", "Bound", "Term")},
)
