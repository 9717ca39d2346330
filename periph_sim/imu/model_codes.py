"""Register bytes that a controller should read if firmware calculates them from a frame with sensor models.

    six int16 --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu in the firmware's arithmetic --> bytes, by address

The byte order is that of the controller (`sensors`), so that firmware with another byte order is detected as wrong.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

from ..devices.chip_model import ChipModel, Shown
from ..devices.sensor_rounds import register_bytes
from .host_frame import ACCELERATION, ANGLE
from .models.imu import Imu, State
from .models.parameters import ImuParameters
from .numeric.arithmetic import Arithmetic
from .sensors import SENSORS
from .shared_models import model_noise, model_of

BY_ADDRESS = {chip.address: (name, chip) for name, chip in SENSORS.items()}


@final
class ModelCodes(ChipModel):
    """The sensor models as a `ChipModel`.

    noise_seed: the seed of the noise, of which run n of the models uses sample n; None for no noise.
    """

    _model: Imu[Any]
    _a: Arithmetic[Any]
    _noise: Callable[[int], Any]

    def __init__(self, parameters: ImuParameters, arithmetic: str, noise_seed: int | None = None) -> None:
        self._model = model_of(arithmetic, parameters)
        self._a = self._model.a
        # True if numpy would warn of divisions by zero, whose results float32 defines.
        self._warns = self._a.name == "float32"
        self._noise = model_noise(arithmetic, parameters, noise_seed)
        self.addresses = frozenset(BY_ADDRESS)
        self.no_frame = (0,) * 6
        self.at_rest = Shown(None, self._model.at_rest, ())

    def run(self, number: int, values: tuple[int, ...], before: Shown) -> Shown:
        """Return the result of run `number` of the models, from 0, for the values of a frame.

        The first frame after `at_rest` has no attitude before it, so its rates are zero.
        """
        scaled, model, last = self._a.scaled, self._model, before.state
        roll, pitch, yaw, x, y, z = values
        attitude = scaled(roll, ANGLE), scaled(pitch, ANGLE), scaled(yaw, ANGLE)
        pushed = scaled(x, ACCELERATION), scaled(y, ACCELERATION), scaled(z, ACCELERATION)
        noise = self._noise(number)
        model.check(attitude, pushed, noise)
        attitude_before = attitude if last is model.at_rest else last.attitude
        turned, body = self._quietly(model.motion, (attitude, attitude_before))
        return Shown(self, State(attitude, body), (turned, pushed, body, last.body, noise))

    def data_of(self, address: int, inputs: tuple[Any, ...]) -> bytes:
        """Return the register bytes of one chip."""
        name, chip = BY_ADDRESS[address]
        return register_bytes(chip, self._quietly(self._model.codes_of, (name, *inputs)))

    def _quietly(self, computed: Callable[..., Any], inputs: tuple[Any, ...]) -> Any:
        """Return computed(*inputs) without warnings of numpy."""
        if not self._warns:
            return computed(*inputs)
        import numpy as np

        with np.errstate(all="ignore"):
            return computed(*inputs)
