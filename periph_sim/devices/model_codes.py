"""What a controller should read where firmware computes the sensors: a frame's values go in, register bytes come out.

    six int16 --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu in the firmware's arithmetic --> bytes, by address

The way of the bytes is the controller's (`sensor_head.CHIPS`), so that firmware which packs them otherwise is wrong.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, NamedTuple

from msgspec import Struct

from ..sensors.host_frame import ACCELERATION, ANGLE
from ..sensors.models.finite import check_sample
from ..sensors.models.imu import State
from ..sensors.models.parameters import ImuParameters
from ..sensors.shared_models import ModelNoise, model_of
from .sensor_rounds import CHIPS, ChipData

ModelState = State[Any]
BIG, LITTLE = struct.Struct(">3h"), struct.Struct("<3h")
BY_ADDRESS = {chip.address: (name, chip) for name, chip in CHIPS.items()}


class Computed(Struct, frozen=True):
    """The sensors that firmware computes. noise_seed: of their noise, whose sample n goes into run n; None for none."""

    parameters: ImuParameters
    arithmetic: str
    noise_seed: int | None = None


class ChipBytes(dict[int, bytes]):
    """What the chips show, by address: each worked out when it is first asked for, as often one is enough to tell."""

    def __init__(self, codes_of: Callable[[str], tuple[Any, Any, Any]]) -> None:
        super().__init__()
        self._codes_of = codes_of

    def __missing__(self, address: int) -> bytes:
        name, chip = BY_ADDRESS[address]
        self[address] = found = register_bytes(chip, self._codes_of(name))
        return found


class Shown(NamedTuple):
    """What the chips show after a run of the models, by address, and what that run leaves to the next."""

    data: ChipBytes
    state: ModelState


class ModelCodes:
    def __init__(self, computed: Computed) -> None:
        self._model = model_of(computed.arithmetic, computed.parameters)
        self._a = self._model.a
        self._warns = self._a.name == "float32"  # as numpy's arithmetic does of x/0; it says itself what that gives
        self._noise = ModelNoise(computed.arithmetic, computed.parameters, computed.noise_seed)
        self.at_rest: ModelState = self._model.at_rest

    def run(self, number: int, values: tuple[int, ...], before: ModelState) -> Shown:
        """Run `number` of the models, from 0, on the values of a frame."""
        scaled = self._a.scaled
        roll, pitch, yaw, x, y, z = values
        attitude = scaled(roll, ANGLE), scaled(pitch, ANGLE), scaled(yaw, ANGLE)
        pushed = scaled(x, ACCELERATION), scaled(y, ACCELERATION), scaled(z, ACCELERATION)
        noise, model = self._noise.at(number), self._model
        check_sample(attitude, pushed, noise)
        turned, body = self._quietly(model.motion, attitude, before.attitude)

        def codes_of(chip: str) -> tuple[Any, Any, Any]:
            codes: tuple[Any, Any, Any] = self._quietly(model.codes_of, chip, turned, pushed, body, before.body, noise)
            return codes

        return Shown(ChipBytes(codes_of), State(attitude, body))

    def _quietly(self, computed: Callable[..., Any], *inputs: Any) -> Any:
        """What is computed of these inputs, without warnings."""
        if not self._warns:
            return computed(*inputs)
        import numpy as np

        with np.errstate(all="ignore"):
            return computed(*inputs)


def register_bytes(chip: ChipData, xyz: tuple[Any, Any, Any]) -> bytes:
    """The six bytes of three values, as the chip keeps them. OverflowError for one that does not fit 16 bits."""
    first, second, third = chip.order
    try:
        return (BIG if chip.big else LITTLE).pack(int(xyz[first]), int(xyz[second]), int(xyz[third]))
    except struct.error as error:
        raise OverflowError(f"{xyz}: {error}") from None
