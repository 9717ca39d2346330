"""Run the models in float64 over a recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from periph_sim.imu.models.imu import Codes, Imu
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.numeric.float64 import Float64

Rows = Iterable[tuple[float, ...]]


def codes_of(imu: ImuParameters, attitudes: Rows, accelerations: Rows) -> Iterator[Codes[float]]:
    """Yield the codes of each sample of roll, pitch, yaw and x, y, z; the first has no attitude before it."""
    model, state = Imu(Float64(), imu), None
    for attitude, acceleration in zip(attitudes, accelerations, strict=True):
        before = model.at_rest._replace(attitude=attitude) if state is None else state
        codes, state = model.step(attitude, acceleration, model.silence, before)
        yield codes
