"""Numbers of operations for a sample in each part of the models: {"gyroscope": {"mul": 15, ...}, ...}.

Parameters that select a method (corrected rates, unwrapped angles, the rotation of the field) change the counts. The
values of a sample do not change the counts, because the equations have no branches.
"""

from __future__ import annotations

from collections import Counter
from functools import lru_cache
from typing import Any

from ..numeric.arithmetic import Arithmetic
from ..numeric.float64 import Float64
from . import parameters
from .chips import angles
from .imu import Codes, Imu, Inputs

COSTLESS = ("constant", "value")  # operations that a program does not execute at run time


class Counting:
    """An arithmetic that calculates like the arithmetic `a` and counts the operations.

    equations --> Counting(Q(16)) --> the results of Q(16), and {"mul": 113, "add": 101, "sincos": 5, ...}

    counts: the number of operations of each kind since the last `pop_counts`. A vector operation is counted as its
        operations on single numbers, even if `a` implements vector operations itself.
    """

    def __init__(self, a: Arithmetic[Any]) -> None:
        self._a = a
        self.name = a.name
        self.counts: Counter[str] = Counter()

    def pop_counts(self) -> Counter[str]:
        """Return the counts so far and reset them."""
        counts, self.counts = self.counts, Counter()
        return counts

    def __getattr__(self, name: str) -> Any:
        if name not in vars(Arithmetic):
            raise AttributeError(name)
        operation = getattr(self._a, name)
        if name in COSTLESS:
            return operation
        kind = "select" if name == "select_greater" else name.replace("_", " ")

        def counted(*arguments: Any) -> Any:
            self.counts[f"{kind}, {arguments[1]}" if name == "to_integer" else kind] += 1
            return operation(*arguments)

        setattr(self, name, counted)
        return counted


PARTS = ("frame", "derivative", "angles", "gyroscope", "accelerometer", "magnetometer")
FRAME = 6  # number of values of a host frame that are scaled


def counts_of(imu: parameters.ImuParameters) -> dict[str, Counter[str]]:
    """Return the number of operations of each kind for one sample, by the part of the models (see PARTS).

    The part `frame` is the scaling of a host frame's six values.
    """
    return {part: Counter(counts) for part, counts in _counted(imu).items()}


@lru_cache(maxsize=16)
def _counted(imu: parameters.ImuParameters) -> dict[str, Counter[str]]:
    a = Counting(Float64())
    model: Imu[float] = Imu(a, imu)
    still = (0.0, 0.0, 0.0)
    noise, (attitude, before) = model.silence, model.at_rest
    found: dict[str, Counter[str]] = {"frame": Counter({"scaled": FRAME})}
    rates = model.derivative.rates(attitude, still)
    derivative = a.pop_counts()
    turned = angles(a, attitude)
    found["angles"] = a.pop_counts()
    body = model.gyroscope.body_rates(rates, turned)
    inputs = Inputs(turned, still, body, before, noise)
    for chip in Codes._fields:
        model.codes_of(chip, inputs)
        found[chip] = a.pop_counts()
    model.derivative.change(body, before)
    change = a.pop_counts()
    found["derivative"], found["accelerometer"] = derivative + change, found["accelerometer"] - change
    return {part: found[part] for part in PARTS}
