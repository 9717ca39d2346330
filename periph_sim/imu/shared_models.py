"""Sensor models shared by several users: each sample is computed once.

    arithmetic, parameters -------> model_of ---> Imu: shared by the firmware and the check of its output
    arithmetic, parameters, seed -> ModelNoise -> sample n of the noise, in the model's numbers

A model is stateless, so its results are a function of its inputs. They are cached if numbers are integers, as in Q:
of floats, 0.0 equals -0.0 but is another number.
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

REMEMBERED = 16  # cached samples, also of several runs of a scene's models


class RememberingImu(Imu[int]):
    """An Imu in Q with a cache of the last samples. overflows: of all requested samples, cached ones included."""

    def __init__(self, a: Q, imu: ImuParameters) -> None:
        super().__init__(a, imu)
        self.overflows = 0
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


def overflows_of(model: Imu[Any]) -> int:
    """Return the number of results that did not fit since the model was built; 0 for floats."""
    return model.overflows if isinstance(model, RememberingImu) else 0


@lru_cache(maxsize=16)
def model_of(arithmetic: str, parameters: ImuParameters) -> Imu[Any]:
    """Return the model, shared by scenes with equal arguments. NoSuchArithmetic or DoesNotFit if there is none."""
    a = named.scalar(arithmetic)
    return RememberingImu(a, parameters) if isinstance(a, Q) else Imu(a, parameters)


Slots = list[tuple[int, Noise[Any]] | None]


@lru_cache(maxsize=16)
def _slots(arithmetic: str, parameters: ImuParameters, seed: int) -> Slots:
    """Return the cache: samples with their numbers, each in the slot of its number."""
    return [None] * REMEMBERED


class ModelNoise:
    """The noise of a model's samples. seed: None for none."""

    def __init__(self, arithmetic: str, parameters: ImuParameters, seed: int | None) -> None:
        model = model_of(arithmetic, parameters)
        self._rounds = isinstance(model.a, Q)
        self._nearest = model.a.nearest if isinstance(model.a, Q) else model.a.constant
        self._silence = model.silence
        self._parameters, self._seed = parameters, seed
        self._noise: ImuNoise | None = None  # built for the first sample that is not cached
        self._slots: Slots = [] if seed is None else _slots(arithmetic, parameters, seed)

    def at(self, number: int) -> Noise[Any]:
        """Return the noise of sample `number`, from 0."""
        if self._seed is None:
            return self._silence
        slot = number % REMEMBERED
        known = self._slots[slot]
        if known is None or known[0] != number:
            if self._noise is None:
                self._noise = ImuNoise(self._parameters, self._seed)
            made = self._rounded(number, self._noise) if self._rounds else None
            if made is None:
                nearest = self._nearest
                g, a, m = self._noise.at(number)
                made = Noise(
                    (nearest(g[0]), nearest(g[1]), nearest(g[2])),
                    (nearest(a[0]), nearest(a[1]), nearest(a[2])),
                    (nearest(m[0]), nearest(m[1]), nearest(m[2])),
                )
            known = self._slots[slot] = number, made
        return known[1]

    def _rounded(self, number: int, noise: ImuNoise) -> Noise[Any] | None:
        """Return the sample without numpy, if no error of its values changes their rounding; else None."""
        near = noise.near(number)
        if near is None:
            return None
        chips = [[(self._nearest(x - off), self._nearest(x + off)) for x, off in axes] for axes in near]
        if any(least != most for axes in chips for least, most in axes):
            return None
        return Noise(*((x, y, z) for (x, _), (y, _), (z, _) in chips))
