"""Search for the cells of frames: ranges of starts of frames that the SCI receives at the same instant.

start of a frame alone   t  t+1  t+2  t+3 ...
effects                  A   A    B    B        a cell of frames begins at t+2
"""

from __future__ import annotations

from .free_run import NotClosed
from .pair_groups import Cells, GroupRunner

MOST_AWAY = 40  # if more frames in a row start from other orbits than the wanted one, another orbit is chosen


def find_cells(runner: GroupRunner) -> Cells:
    """Run frames alone, one for each start in a period of the SCI's samples. Return the cells of frames.

    Within a period, the effects change at one tick, at which a cell of frames begins. Raise NotClosed if they change
    more often.
    """
    run, records, cycle = runner.run, runner.records, runner.cycle
    period = runner.sci_period() * cycle
    number, away = runner.at[0], 0
    seen: list[tuple[int, int, int, int, int]] = []
    while len(seen) < period:
        here, at = runner.at
        away = 0 if here == number else away + 1
        if away > MOST_AWAY:  # the orbit only occurs after the start-up, so begin again with the present orbit
            number, away = here, 0
            seen.clear()
        whole = runner.orbits.known[here].cycles * cycle
        start = run.now + (len(seen) - at * cycle) % whole + whole
        run.start(frames=start)
        run.settle()
        runner.at = runner.place()
        runner.check_frame(is_sent=True)
        if here == number:
            zero = start - len(seen)
            after, there = runner.at
            shift = (there * cycle - run.now + zero) % (runner.orbits.known[after].cycles * cycle)
            seen.append((records.entered - zero, records.left - zero, records.routine, after, shift))
        if len(run.frames) > 8 * (period + MOST_AWAY):
            raise NotClosed("a state of rest is not reached again")
    orbit = runner.orbits.known[number]
    steps = [n for n in range(1, period) if seen[n] != seen[n - 1]]
    if len(steps) > 1:
        raise NotClosed(f"frames of one period of the SCI's samples are received in {len(steps) + 1} ways")
    step = steps[0] if steps else 0  # without a change, a cell of frames begins at the first of these ticks
    entered = [seen[-1][0] - step, seen[0][0] - step + (period if steps else 0)]
    left = [seen[-1][1] - step, seen[0][1] - step + (period if steps else 0)]
    return Cells((orbit.origin + step) % period, period, min(entered), max(left))
