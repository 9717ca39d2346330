"""The errors of a controller's clock, within a range, that give different runs.

errors from -100 to 100 ppm --counted_lengths--> low 14999 to 15002 ticks, gap 149985 to 150015 ticks, ...
                            --bisect--------> one error for each combination of these lengths

A controller counts its lengths, such as the low time of SCL and the gap between requests, in whole ticks. Each length
decreases as the error increases, and is rounded to a whole number. Therefore, if two errors give equal lengths, all
errors between them give these lengths, too. The starts of rounds also depend on the error, but a closed table holds for
all starts.
"""

from __future__ import annotations

from fractions import Fraction

from ..scene.case.model import Case
from ..scene.controller import counted_lengths, head_plan
from ..scene.plan import ScenePlan
from .free_run import NotClosed

MOST_CLOCKS = 500  # maximum number of tables of a proof
# Bisection stops when two errors differ by at most LEAST ppm. Between two errors that are so close, lengths change at
# most once, because the errors at which they change are fractions with far smaller denominators.
LEAST = Fraction(1, 2**80)


def clock_errors(case: Case, within: Fraction) -> list[Fraction]:
    """Return errors of the controller's clock, in ppm and ascending, one for each combination of lengths in the range.

    The range has all errors that differ from `controller.ppm` by at most `within` ppm. Raise NotClosed if there are
    more than MOST_CLOCKS combinations, and BadCase if the case has no controller or initialises chips.
    """
    if case.controller is None:
        raise case.mistake("--ppm needs a [controller], because it is about its clock; remove the option", "name")
    if case.controller.initialise is not None:
        what = "--ppm: the start-up of the chips would come at another tick for each clock; remove the key"
        raise case.mistake(what, "controller", "initialise")
    found: dict[object, Fraction] = {}
    table, scale = case.controller, ScenePlan(case).ticks
    # With the slowest and with the fastest clock, `head_plan` raises BadCase if a time has too many ticks.
    for side in (-within, within):
        controller = table.model_copy(update={"ppm": table.ppm + side})
        head_plan(ScenePlan(case.model_copy(update={"controller": controller})).ticks)

    def lengths(error: Fraction) -> object:
        if len(found) > MOST_CLOCKS:
            raise NotClosed(f"the range has more than {MOST_CLOCKS} clocks with different lengths in ticks")
        these = counted_lengths(scale, table.model_copy(update={"ppm": error}))
        found.setdefault(these, error)
        return these

    waiting = [(table.ppm, table.ppm + side) for side in (-within, within)]
    while waiting:
        one, other = waiting.pop(0)
        if lengths(one) != lengths(other) and abs(other - one) > LEAST:
            middle = (one + other) / 2
            waiting += [(one, middle), (middle, other)]
    return sorted(found.values())
