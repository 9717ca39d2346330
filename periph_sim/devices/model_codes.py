"""Register bytes that a controller should read if firmware computes the sensors, from the values of a frame.

    six int16 --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu in the firmware's arithmetic --> bytes, by address

The byte order is the controller's (`sensor_head.CHIPS`), so that firmware with another one is wrong.
"""

# core: compiled

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, final

from msgspec import Struct

from ..imu.host_frame import ACCELERATION, ANGLE
from ..imu.models.imu import Imu, State
from ..imu.models.parameters import ImuParameters
from ..imu.numeric.arithmetic import Arithmetic
from ..imu.shared_models import ModelNoise, model_of
from .sensor_rounds import CHIPS, ChipData

ModelState = State[Any]
BIG, LITTLE = struct.Struct(">3h"), struct.Struct("<3h")
BY_ADDRESS = {chip.address: (name, chip) for name, chip in CHIPS.items()}


class Computed(Struct, frozen=True):
    """The sensors that firmware computes. noise_seed: seed of noise, sample n for run n; None for no noise."""

    parameters: ImuParameters
    arithmetic: str
    noise_seed: int | None = None


@final
class Shown:
    """The register bytes of the chips after one run of the models; those of a chip are computed on first use.

    state: of the models, for the next run.
    """

    def __init__(self, codes: ModelCodes | None, state: ModelState, inputs: tuple[Any, ...]) -> None:
        self.state = state
        self._codes = codes
        self._inputs = inputs  # arguments of the model's codes_of that follow the chip
        self._data: dict[int, bytes] = {}

    def data(self, address: int) -> bytes:
        """Return the register bytes of the chip with this address."""
        known = self._data.get(address)
        if known is None:
            known = self._data[address] = self._made(address)
        return known

    def _made(self, address: int) -> bytes:
        name, chip = BY_ADDRESS[address]
        return register_bytes(chip, (0, 0, 0) if self._codes is None else self._codes.of_chip(name, self._inputs))


@final
class ModelCodes:
    """at_rest: the output before the first run, with zeros in all chips."""

    _model: Imu[Any]
    _a: Arithmetic[Any]
    _noise: ModelNoise

    def __init__(self, computed: Computed) -> None:
        self._model = model_of(computed.arithmetic, computed.parameters)
        self._a = self._model.a
        self._warns = self._a.name == "float32"  # numpy warns of divisions by zero, whose results float32 defines
        self._noise = ModelNoise(computed.arithmetic, computed.parameters, computed.noise_seed)
        self.at_rest = Shown(None, self._model.at_rest, ())

    def run(self, number: int, values: tuple[int, ...], before: Shown) -> Shown:
        """Return the result of run `number` of the models, from 0, for the values of a frame.

        The first frame after `at_rest` has no attitude before it, so its rates are zero.
        """
        scaled, model, last = self._a.scaled, self._model, before.state
        roll, pitch, yaw, x, y, z = values
        attitude = scaled(roll, ANGLE), scaled(pitch, ANGLE), scaled(yaw, ANGLE)
        pushed = scaled(x, ACCELERATION), scaled(y, ACCELERATION), scaled(z, ACCELERATION)
        noise = self._noise.at(number)
        model.check(attitude, pushed, noise)
        attitude_before = attitude if last is model.at_rest else last.attitude
        turned, body = self._quietly(model.motion, (attitude, attitude_before))
        return Shown(self, State(attitude, body), (turned, pushed, body, last.body, noise))

    def of_chip(self, name: str, inputs: tuple[Any, ...]) -> Any:
        """Return the codes of one chip."""
        return self._quietly(self._model.codes_of, (name, *inputs))

    def _quietly(self, computed: Callable[..., Any], inputs: tuple[Any, ...]) -> Any:
        """Return computed(*inputs) without warnings of numpy."""
        if not self._warns:
            return computed(*inputs)
        import numpy as np

        with np.errstate(all="ignore"):
            return computed(*inputs)


def register_bytes(chip: ChipData, xyz: tuple[Any, Any, Any]) -> bytes:  # core: python
    """Return the six bytes of three values in the chip's order. OverflowError for one that does not fit 16 bits."""
    first, second, third = chip.order
    try:
        return (BIG if chip.big else LITTLE).pack(int(xyz[first]), int(xyz[second]), int(xyz[third]))
    except struct.error as error:
        raise OverflowError(f"{xyz}: {error}") from None
