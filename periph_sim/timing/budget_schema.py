"""The table of a budget in a case file, with its checked keys.

The text of the measure is not parsed here, but in `budget_plan.py`.
"""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated

from msgspec import field

from ..core.convert import Before
from ..core.table import Duration, Share, Table


def _limit(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise ValueError('expected a duration with its unit ("250 us"), or a whole number for counts')
    return value


Extent = Annotated[str | int, Before(_limit)]

# The text of some measures is one of these prefixes and a name, such as "span:models".
SPAN = "span:"
REPLY = "reply:"
SILENCE = "silence:"
WATCH = "watch:"
LIMITS = ("max", "min", "exactly", "p50", "p95", "p99", "p99_9")  # the keys of a budget that are limits


class Limited(Table, frozen=True, kw_only=True):
    """Limits on a measure. A limit is a duration such as "250 us", a share of time such as "40 %", a value such as
    "2 LSB", or a whole number for a count.
    """

    def check_together(self, given: Set[str]) -> None:
        if not self.limits():
            keys = [key for key in LIMITS if hasattr(self, key)]
            raise ValueError(f"a budget needs a limit: {', '.join(keys[:-1])} or {keys[-1]}")

    def limits(self) -> dict[str, str | int]:
        """Return the given limits by key, such as {"max": "250 us"}."""
        given: dict[str, str | int | None] = {key: getattr(self, key, None) for key in LIMITS}
        return {key: limit for key, limit in given.items() if limit is not None}


class Condition(Limited, frozen=True, kw_only=True):
    """Limits on a second measure, which must hold at each occurrence of the budget's own measure."""

    measure: str
    max: Extent | None = None
    min: Extent | None = None
    exactly: Extent | None = None


class Budget(Limited, frozen=True, kw_only=True):
    """A measure with at least one limit. A budget with too few measurements is *not judged*, which is not a pass.

    name: name in verdicts
    measure: measured quantity: `"response"`
    max: upper limit: duration, `"40 %"`, `"2.5 LSB"`, or a count
    min: lower limit
    exactly: only allowed value; excludes other limits
    p50, p95, p99, p99_9: upper limit of that percentile
    after: occurrences that began earlier are ignored
    coverage: minimum share of the occasions at which a value must be measured
    and: further conditions on the same occurrence: tables of `measure` and `max`, `min` or `exactly`
    why, source: reason, and origin of the number
    """

    name: str
    measure: str
    max: Extent | None = None
    min: Extent | None = None
    exactly: Extent | None = None
    p50: Extent | None = None
    p95: Extent | None = None
    p99: Extent | None = None
    p99_9: Extent | None = None
    after: Duration | None = None
    coverage: Share = Fraction(9, 10)
    also: tuple[Condition, ...] = field(default=(), name="and")
    why: str = ""
    source: str = ""
