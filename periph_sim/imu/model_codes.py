"""Register bytes that a controller should read from an emulator.

    host frame --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu in the firmware's arithmetic --> bytes, by address

The bytes have the order that the controller expects (see `sensors`). So firmware with another byte order is detected as
wrong.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, final

from ..devices.chip_model import ChipModel, ModelOutput
from ..devices.sensor_rounds import register_bytes
from .host_frame import ACCELERATION, ANGLE
from .models.imu import Imu, Inputs, Noise, State
from .models.parameters import ImuParameters
from .noise import ImuNoise
from .numeric import arithmetic_names as named
from .numeric.q import Q
from .sensors import SENSORS

REMEMBERED = 16  # number of cached results; firmware, the check of its output and several scenes share the cache
BY_ADDRESS = {chip.address: (name, chip) for name, chip in SENSORS.items()}


@final
class ModelCodes(ChipModel):
    """The sensor models of an IMU as a `ChipModel`.

    parameters: the parameters of the sensors.
    arithmetic: the name of the arithmetic in which the models calculate, such as "q16".
    noise_seed: the seed of the noise; None for no noise. Run n of the models uses sample n of the noise.
    """

    _model: Imu[Any]
    _noise: ImuNoise | None
    _remembered: Callable[..., Any]

    def __init__(self, parameters: ImuParameters, arithmetic: str, noise_seed: int | None = None) -> None:
        self._model = Imu(named.scalar(arithmetic), parameters)
        # True for float32, which allows a division by zero. Numpy warns of it, so its warnings must be turned off.
        self._warns = arithmetic == "float32"
        self._noise = None if noise_seed is None else ImuNoise(parameters, noise_seed)
        self._remembered = lru_cache(REMEMBERED)(self._computed)
        self.addresses = frozenset(BY_ADDRESS)
        self.at_rest = ModelOutput(None, self._model.at_rest, None)

    def run(self, number: int, values: tuple[int, ...] | None, before: ModelOutput) -> ModelOutput:
        """Return the result of run `number` of the models. The first run has number 0.

        If `before.state` is the state at rest, there is no earlier attitude, so the rates are zero. The results of the
        last runs are cached.

        values: the values of the last host frame; None if no frame has arrived, so that the models calculate with
            zeros.
        before: the result of the previous run.
        """
        shown: ModelOutput = self._remembered(number, values, before)
        return shown

    def _computed(self, number: int, values: tuple[int, ...] | None, before: ModelOutput) -> ModelOutput:
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
        return ModelOutput(self, state, Inputs(turned, pushed, body, last.body, noise), model.overflows - overflows)

    def data_of(self, address: int, shown: ModelOutput) -> bytes:
        """Return the register bytes of the chip with this address.

        The number of overflows in this calculation is added to `shown.overflows`.

        shown: the result of `run` from which the bytes are calculated.
        """
        name, chip = BY_ADDRESS[address]
        overflows = self._model.overflows
        codes = self._quietly(self._model.codes_of, name, shown.inputs)
        shown.overflows += self._model.overflows - overflows
        return register_bytes(chip, codes)

    def noise(self, number: int) -> Noise[Any]:
        """Return sample `number` of the noise, converted to numbers of the arithmetic."""
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
        """Return computed(*inputs). In float32, numpy's warnings are turned off during the call."""
        if not self._warns:
            return computed(*inputs)
        import numpy as np

        with np.errstate(all="ignore"):
            return computed(*inputs)


@lru_cache(maxsize=16)
def model_codes(parameters: ImuParameters, arithmetic: str, noise_seed: int | None) -> ModelCodes:
    """Return the sensor models for these arguments.

    Firmware, the check of its output and all scenes with equal arguments share one object.
    """
    return ModelCodes(parameters, arithmetic, noise_seed)


def _rounded(a: Q, near: list[tuple[float, float]] | None) -> list[Any] | None:
    """Convert approximate noise values to a Q format.

    Return None if the error of a value might change the number to which it is rounded, or if `near` is None.

    near: the approximate values, each with its maximum error.
    """
    if near is None:
        return None
    numbers = [a.nearest(value - off) for value, off in near]
    return numbers if numbers == [a.nearest(value + off) for value, off in near] else None


def model_of(arithmetic: str, parameters: ImuParameters) -> Imu[Any]:
    """Return the models of an IMU, for firmware that was written for earlier versions of periph_sim.

    Such firmware calls `Imu.step` of the result. Newer firmware uses `ModelCodes` instead.
    """
    return Imu(named.scalar(arithmetic), parameters)


class ModelNoise:
    """The noise of the models, in numbers of the arithmetic. For firmware that uses `model_of`.

    at: a function that returns the noise of a sample. Its argument is the number of the sample.
    """

    at: Callable[[int], Noise[Any]]

    def __init__(self, arithmetic: str, parameters: ImuParameters, seed: int | None) -> None:
        self.at = ModelCodes(parameters, arithmetic, seed).noise
