"""A blinking LED: deviations of its periods and on-times from a given rate and duty cycle.

    LED  ___|~~~~|____|~~~~|____|~~~~~      rate = "1 Hz", duty = "50 %"
            |-- period --|
            |-on-|

The LED is on while the wire is high. If the LED does not begin to blink, or stops, the run fails.
"""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from functools import partial
from typing import Annotated

from ...core.convert import Before
from ...core.table import FREQUENCY_TEXT, Duration, Share, Table, frequency
from . import WatchContext

KIND = "blink"


class Settings(Table, frozen=True, kw_only=True):
    """The expected blinking of a wire.

    rate: frequency, `"1 Hz"`
    duty: share of a period for which the wire is high; without it, only periods are checked
    after: edges up to this time are ignored
    first: latest time of the first rise; by default two periods after `after`
    """

    rate: Annotated[Fraction, Before(partial(frequency, usual="Hz"), FREQUENCY_TEXT)]
    duty: Share | None = None
    after: Duration = Fraction(0)
    first: Duration | None = None

    def check_together(self, given: Set[str]) -> None:
        if self.first is not None and self.first < self.after:
            raise ValueError("'first' is before 'after', up to which edges are ignored; lower 'after'")


class Blink:
    def __init__(self, settings: Settings, place: WatchContext) -> None:
        self._place = place
        period = 1 / settings.rate
        self._rate = settings.rate
        self._period = place.ticks(period)
        self._on = None if settings.duty is None else place.ticks(period * settings.duty)
        self._after = place.start + place.ticks(settings.after)
        first = settings.after + 2 * period if settings.first is None else settings.first
        self._first = place.start + place.ticks(first)
        self._rose: int | None = None  # tick of the last rise; None before the first one

    def edge(self, now: int, level: int) -> None:
        rose = self._rose
        if now <= self._after:
            return
        if level:
            if rose is not None:
                self._place.on_deviation(abs(now - rose - self._period), rose)
            elif now > self._first:
                self._refute_first()
            self._rose = now
        elif rose is not None and self._on is not None:
            self._place.on_deviation(abs(now - rose - self._on), rose)

    def finish(self, now: int) -> None:
        place = self._place
        if self._rose is None:
            if now > self._first:
                self._refute_first()
        elif now > self._rose + self._period + place.tolerance:
            place.refute(f"{place.wire} stopped: its last rise was at {place.at(self._rose)}", self._rose)

    def _refute_first(self) -> None:
        self._place.refute(f"{self._place.wire} did not rise by {self._place.at(self._first)}", self._first)

    def missing(self) -> str:
        rises = "no rise" if self._rose is None else "one rise"
        return f"{rises} of {self._place.wire} occurred, and a period needs two; let the run last longer"


def build(settings: Settings, place: WatchContext) -> Blink:
    return Blink(settings, place)
