"""Number of operations for a sample, part by part: {"gyroscope": {"mul": 15, ...}, ...}.

The choices among the parameters (corrected rates, unwrapped angles, how the field is turned) change the counts; the
numbers do not, since the equations have no branches.
"""

from __future__ import annotations

from collections import Counter
from functools import lru_cache

from ..numeric.counting import Counting
from ..numeric.float64 import Float64
from . import parameters
from .angles import angles
from .imu import Imu

PARTS = ("frame", "derivative", "angles", "gyroscope", "accelerometer", "magnetometer")
FRAME = 6  # scaled values of a host frame


def counts_of(imu: parameters.ImuParameters) -> dict[str, Counter[str]]:
    """Count the operations of one sample by part; `frame` is the scaling of a host frame's six values."""
    return {part: Counter(counts) for part, counts in _counted(imu).items()}


@lru_cache(maxsize=16)
def _counted(imu: parameters.ImuParameters) -> dict[str, Counter[str]]:
    a = Counting(Float64())
    model = Imu(a, imu)
    still = (0.0, 0.0, 0.0)
    noise, (attitude, before) = model.silence, model.at_rest
    found: dict[str, Counter[str]] = {"frame": Counter({"scaled": FRAME})}
    rates = model.derivative.rates(attitude, still)
    derivative = a.pop_counts()
    turned = angles(a, attitude)
    found["angles"] = a.pop_counts()
    body = model.gyroscope.body_rates(rates, turned)
    model.gyroscope.codes(body, still, noise.gyroscope)
    found["gyroscope"] = a.pop_counts()
    change = model.derivative.change(body, before)
    found["derivative"] = derivative + a.pop_counts()
    model.accelerometer.codes(turned, still, body, change, noise.accelerometer)
    found["accelerometer"] = a.pop_counts()
    model.magnetometer.codes(turned, noise.magnetometer)
    found["magnetometer"] = a.pop_counts()
    return {part: found[part] for part in PARTS}
