"""`make bench`, sensor models: samples per second in each arithmetic. Nothing is asserted.

A sample is one time step of all nine axes. Three axes of one chip are a triplet, so a sample has three triplets. One
core is used, and the best of many short runs is taken, because the machine may be shared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from struct import pack
from typing import Any

import numpy as np

from firmware.python.imu_models import Models
from periph_sim.imu.host_frame import ACCELERATION, ANGLE
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.numeric import arithmetic_names as named

from .timed import Seconds, timed

Row = dict[str, Any]

RUNS = 20


def best(work: Callable[[], object]) -> Seconds:
    """Return the smallest time of each clock."""
    times = [timed(work)[1] for _ in range(RUNS)]
    return Seconds(min(time.wall for time in times), min(time.cpu for time in times))


def frames_of(samples: int) -> list[bytes]:
    """Return a motion of up to 2000 deg/s and 2 g as a host sends it."""
    times = np.arange(samples) * ImuParameters().period
    angles = [swing * np.sin(2000 / 57.3 / swing * times + lag) for lag, swing in ((0, 3.0), (1, 1.5), (2, 3.0))]
    accelerations = [2 * np.sin(rate * times) for rate in (1.1, 0.7, 1.9)]
    counts = np.rint(np.stack([*(angle / ANGLE for angle in angles), *(a / ACCELERATION for a in accelerations)]))
    return [pack("<6h", *frame) for frame in counts.astype(int).T.tolist()]


def row(what: str, samples: int, time: Seconds) -> Row:
    return {"what": what, "samples_per_s": samples / time.cpu, "triplets_per_s": 3 * samples / time.cpu}


def line(row: Row) -> str:
    return f"{row['what']:36} {row['samples_per_s']:12,.0f} samples/s {row['triplets_per_s']:12,.0f} triplets/s of cpu"


def rows(samples: int = 2000) -> Iterator[Row]:
    frames = frames_of(samples)
    for name in ("float64", "q16", "q16 rounded", "q16 saturating"):
        models = Models(name, ImuParameters())
        time = best(lambda models=models: [models.chips(frame) for frame in frames])
        yield row(f"{named.scalar(name).name}, frame by frame", samples, time)
