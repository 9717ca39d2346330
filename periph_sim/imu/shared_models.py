"""Sensor models that several users share.

arithmetic, parameters -------> model_of ---> Imu, which is stateless
arithmetic, parameters, seed -> model_noise -> sample n of the noise, in the model's numbers
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from .imu_noise import ImuNoise
from .models.imu import Imu, Noise
from .models.parameters import ImuParameters
from .numeric import arithmetic_names as named
from .numeric.q import Q

REMEMBERED = 16  # number of cached samples, which may belong to several runs of a scene's models


@lru_cache(maxsize=16)
def model_of(arithmetic: str, parameters: ImuParameters) -> Imu[Any]:
    """Return the model, which scenes with equal arguments share.

    Raise NoSuchArithmetic if the arithmetic does not exist, and DoesNotFit if it cannot hold a constant.
    """
    return Imu(named.scalar(arithmetic), parameters)


@lru_cache(maxsize=16)
def model_noise(arithmetic: str, parameters: ImuParameters, seed: int | None) -> Callable[[int], Noise[Any]]:
    """Return a function from the number of a sample, from 0, to its noise in the numbers of the arithmetic.

    seed: None for no noise.
    """
    model = model_of(arithmetic, parameters)
    if seed is None:
        return lambda number: model.silence
    noise, a = ImuNoise(parameters, seed), model.a
    nearest = a.nearest if isinstance(a, Q) else a.constant

    def sample(number: int) -> Noise[Any]:
        near = noise.near(number) if isinstance(a, Q) else None
        rounded = None if near is None else _rounded(nearest, near)
        if rounded is not None:
            return rounded
        (p, q, r), (x, y, z), (north, east, down) = noise.at(number)
        return Noise(
            (nearest(p), nearest(q), nearest(r)),
            (nearest(x), nearest(y), nearest(z)),
            (nearest(north), nearest(east), nearest(down)),
        )

    return lru_cache(REMEMBERED)(sample)


def _rounded(nearest: Callable[[float], int], near: list[tuple[float, float]]) -> Noise[int] | None:
    """Return the noise of a sample without numpy; None if the error of a value might change its rounding."""
    numbers = []
    for value, off in near:
        least = nearest(value - off)
        if least != nearest(value + off):
            return None
        numbers.append(least)
    p, q, r, x, y, z, north, east, down = numbers
    return Noise((p, q, r), (x, y, z), (north, east, down))
