"""The table [inputs]: exact times and durations, in place of values that follow from periods and random ranges."""

from __future__ import annotations

from fractions import Fraction

from ...core.table import Duration, Table


class InputsTable(Table, frozen=True, kw_only=True):
    """Exact values of the inputs that other tables leave free. Times count from the start of the run. No `ppm` applies.

    rounds: times at which the controller's rounds are due and start; without it, `[controller]` schedules them
    frames: starts of the host's frames; without it, `[host]` schedules them
    sends_later: time added to each `at` of `[serial]`
    costs: for each unit, the durations, in order, of computations for which the firmware states a range:
        `{ dsp = ["240 us"] }`; later computations draw random durations
    """

    rounds: tuple[Duration, ...] | None = None
    frames: tuple[Duration, ...] | None = None
    sends_later: Duration = Fraction(0)
    costs: dict[str, tuple[Duration, ...]] = {}
