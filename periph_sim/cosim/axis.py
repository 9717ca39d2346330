"""Conversion between steps of a simulator and ticks of a session, both integers, without drift.

    step --floor--> tick      a change of a line is applied at the tick that contains its step
    tick --ceil --> step      a change of our pin is shown in the first step at or after its tick

A step is at most one tick long, so tick -> step -> tick returns the same tick.
"""

from __future__ import annotations

from ..outside.errors import OutsideError

UNITS = {12: "1ps", 13: "100fs", 14: "10fs", 15: "1fs"}


class Axis:
    """Converter between the steps of a simulator and the ticks of a session.

    begin: the step at which the session's time begins.

    Raise OutsideError if a step is longer than a tick.
    """

    def __init__(self, steps_per_second: int, ticks_per_second: int, begin: int = 0) -> None:
        if steps_per_second < ticks_per_second:
            finer = next((text for power, text in UNITS.items() if 10**power >= ticks_per_second), None)
            if finer is None:
                raise OutsideError(
                    f"a tick is shorter than 1 fs ({ticks_per_second} a second): no simulator has such steps"
                )
            raise OutsideError(
                f"the simulator's precision is {_length(steps_per_second)}, and a tick of this case is"
                f" {1e12 / ticks_per_second:.3g} ps; write `timescale 1ns/{finer} into the Verilog,"
                f' or give the runner timescale=("1ns", "{finer}")'
            )
        self._steps = steps_per_second
        self._ticks = ticks_per_second
        self._begin = begin

    def tick(self, step: int) -> int:
        """Return the tick that contains this step."""
        return (step - self._begin) * self._ticks // self._steps

    def step(self, tick: int) -> int:
        """Return the first step at or after this tick."""
        return self._begin - (-tick * self._steps // self._ticks)


def _length(per_second: int) -> str:
    """Return the length of a step as in a timescale, such as "1 ps". per_second: number of steps in a second."""
    power = len(str(per_second)) - 1  # the number of steps in a second is a power of ten
    for unit, of in (("s", 0), ("ms", 3), ("us", 6), ("ns", 9), ("ps", 12), ("fs", 15)):
        if power <= of:
            return f"{10 ** (of - power)} {unit}"
    return f"1e-{power} s"
