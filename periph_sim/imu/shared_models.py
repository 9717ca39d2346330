"""Sensor models that several users share, so that each sample is calculated once.

    arithmetic, parameters -------> model_of ---> Imu: shared by the firmware and the check of its output
    arithmetic, parameters, seed -> model_noise -> sample n of the noise, in the model's numbers

A model is stateless, so its results are a function of its inputs. Results are cached if numbers are integers, as in Q
formats. Floats cannot be keys of the cache, because 0.0 and -0.0 are different numbers but equal keys.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any, TypeVar

from .imu_noise import ImuNoise
from .models.chips import Angles
from .models.imu import Imu, Noise
from .models.parameters import ImuParameters
from .numeric import arithmetic_names as named
from .numeric.arithmetic import Triple
from .numeric.q import Q

R = TypeVar("R")

REMEMBERED = 16  # number of cached samples, which may belong to several runs of a scene's models


class RememberingImu(Imu[int]):
    """An Imu in a Q format with a cache of the last samples. `overflows` includes those of cached samples."""

    def __init__(self, a: Q, imu: ImuParameters) -> None:
        super().__init__(a, imu)
        self._motion = lru_cache(REMEMBERED)(partial(_with_overflows, a, super().motion))
        self._codes_of = lru_cache(3 * REMEMBERED)(partial(_with_overflows, a, super().codes_of))

    def motion(self, attitude: Triple[int], before: Triple[int]) -> tuple[Angles[int], Triple[int]]:
        made, overflows = self._motion(attitude, before)
        self.overflows += overflows
        return made

    def codes_of(
        self,
        chip: str,
        turned: Angles[int],
        acceleration: Triple[int],
        body: Triple[int],
        body_before: Triple[int],
        noise: Noise[int],
    ) -> Triple[int]:
        codes, overflows = self._codes_of(chip, turned, acceleration, body, body_before, noise)
        self.overflows += overflows
        return codes


def _with_overflows(a: Q, compute: Callable[..., R], *arguments: Any) -> tuple[R, int]:
    """Return the result, and the number of intermediate results that did not fit."""
    before = a.overflows
    return compute(*arguments), a.overflows - before


@lru_cache(maxsize=16)
def model_of(arithmetic: str, parameters: ImuParameters) -> Imu[Any]:
    """Return the model, which scenes with equal arguments share.

    Raise NoSuchArithmetic if the arithmetic does not exist, and DoesNotFit if it cannot hold a constant.
    """
    a = named.scalar(arithmetic)
    return RememberingImu(a, parameters) if isinstance(a, Q) else Imu(a, parameters)


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


class ModelNoise:
    """The noise of a model's samples, for firmware. at: the function of `model_noise`."""

    def __init__(self, arithmetic: str, parameters: ImuParameters, seed: int | None) -> None:
        self.at = model_noise(arithmetic, parameters, seed)


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
