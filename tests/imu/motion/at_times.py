"""Values of a motion at several times, as arrays with one row per time."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from periph_sim.imu.motion import Motion


def attitudes(motion: Motion, times: Iterable[float]) -> np.ndarray:
    return np.array([motion.at(float(seconds))[:3] for seconds in times])


def accelerations(motion: Motion, times: Iterable[float]) -> np.ndarray:
    return np.array([motion.at(float(seconds))[3:] for seconds in times])


def rates(motion: Motion, times: Iterable[float]) -> np.ndarray:
    return np.array([motion.rates_at(float(seconds)) for seconds in times])
