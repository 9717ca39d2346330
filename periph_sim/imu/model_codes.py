"""Register bytes that a controller should read if firmware calculates them from a frame with sensor models.

    six int16 --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu in the firmware's arithmetic --> bytes, by address

The byte order is that of the controller (`sensors`), so that firmware with another byte order is detected as wrong.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, final

from ..devices.chip_model import ChipModel, Shown
from ..devices.sensor_rounds import register_bytes
from .host_frame import ACCELERATION, ANGLE
from .models.imu import Imu, Inputs, Noise, State
from .models.parameters import ImuParameters
from .noise import ImuNoise
from .numeric import arithmetic_names as named
from .numeric.q import Q
from .sensors import SENSORS

REMEMBERED = 16  # number of cached results, which may belong to several runs of a scene's models
BY_ADDRESS = {chip.address: (name, chip) for name, chip in SENSORS.items()}


@final
class ModelCodes(ChipModel):
    """The sensor models as a `ChipModel`.

    noise_seed: the seed of the noise, of which run n of the models uses sample n; None for no noise.
    """

    _model: Imu[Any]
    _noise: ImuNoise | None
    _remembered: Callable[..., Any]

    def __init__(self, parameters: ImuParameters, arithmetic: str, noise_seed: int | None = None) -> None:
        self._model = Imu(named.scalar(arithmetic), parameters)
        # True if numpy would warn of divisions by zero, whose results float32 defines.
        self._warns = arithmetic == "float32"
        self._noise = None if noise_seed is None else ImuNoise(parameters, noise_seed)
        self._remembered = lru_cache(REMEMBERED)(self._computed)
        self.addresses = frozenset(BY_ADDRESS)
        self.at_rest = Shown(None, self._model.at_rest, None)

    def run(self, number: int, values: tuple[int, ...] | None, before: Shown) -> Shown:
        """Return the result of run `number` of the models, from 0, for the values of a frame.

        The first frame after `at_rest` has no attitude before it, so its rates are zero. Equal runs after the same
        result are calculated once.
        """
        shown: Shown = self._remembered(number, values, before)
        return shown

    def _computed(self, number: int, values: tuple[int, ...] | None, before: Shown) -> Shown:
        model, last = self._model, before.state
        scaled, overflows = model.a.scaled, model.overflows
        roll, pitch, yaw, x, y, z = values or (0, 0, 0, 0, 0, 0)
        attitude = scaled(roll, ANGLE), scaled(pitch, ANGLE), scaled(yaw, ANGLE)
        pushed = scaled(x, ACCELERATION), scaled(y, ACCELERATION), scaled(z, ACCELERATION)
        noise = self.noise(number)
        model.check(attitude, pushed, noise)
        attitude_before = attitude if last is model.at_rest else last.attitude
        turned, body = self._quietly(model.motion, attitude, attitude_before)
        state = last if values is None else State(attitude, body)
        return Shown(self, state, Inputs(turned, pushed, body, last.body, noise), model.overflows - overflows)

    def data_of(self, address: int, shown: Shown) -> bytes:
        """Return the register bytes of one chip, and count overflows in `shown`."""
        name, chip = BY_ADDRESS[address]
        overflows = self._model.overflows
        codes = self._quietly(self._model.codes_of, name, shown.inputs)
        shown.overflows += self._model.overflows - overflows
        return register_bytes(chip, codes)

    def noise(self, number: int) -> Noise[Any]:
        """Return sample `number` of the noise in the numbers of the arithmetic."""
        if self._noise is None:
            return self._model.silence
        a = self._model.a
        numbers = _rounded(a, self._noise.near(number)) if isinstance(a, Q) else None
        if numbers is None:
            nearest = a.nearest if isinstance(a, Q) else a.constant
            numbers = [nearest(value) for axes in self._noise.at(number) for value in axes]
        p, q, r, x, y, z, north, east, down = numbers
        return Noise((p, q, r), (x, y, z), (north, east, down))

    def _quietly(self, computed: Callable[..., Any], *inputs: Any) -> Any:
        """Return computed(*inputs) without warnings of numpy."""
        if not self._warns:
            return computed(*inputs)
        import numpy as np

        with np.errstate(all="ignore"):
            return computed(*inputs)


@lru_cache(maxsize=16)
def model_codes(parameters: ImuParameters, arithmetic: str, noise_seed: int | None) -> ModelCodes:
    """Return the models, which firmware, the check of its output and scenes with equal arguments share."""
    return ModelCodes(parameters, arithmetic, noise_seed)


def _rounded(a: Q, near: list[tuple[float, float]] | None) -> list[Any] | None:
    """Return values with an error in a Q format; None if the error of one might change its rounding."""
    if near is None:
        return None
    numbers = [a.nearest(value - off) for value, off in near]
    return numbers if numbers == [a.nearest(value + off) for value, off in near] else None


def model_of(arithmetic: str, parameters: ImuParameters) -> Imu[Any]:
    """Return the model, for firmware of earlier versions that calls `Imu.step` itself."""
    return Imu(named.scalar(arithmetic), parameters)


class ModelNoise:
    """The noise of a model's samples, for firmware of earlier versions. at: returns sample n."""

    at: Callable[[int], Noise[Any]]

    def __init__(self, arithmetic: str, parameters: ImuParameters, seed: int | None) -> None:
        self.at = ModelCodes(parameters, arithmetic, seed).noise
