"""Interface of models for firmware that emulates sensor chips: a model computes the register bytes of these chips.

    values of a host frame --ChipModel.run--> ModelOutput --data--> register bytes, by I2C address

Each model is a subclass of `ChipModel`. A model is not one of the simulated chips on the bus, which are in the package
`devices.chips`: it computes the bytes that an I2C controller should read from the firmware.
"""

# core: compiled

from __future__ import annotations

from typing import Any, final


@final
class ModelOutput:
    """The register bytes of the emulated chips after one run of a `ChipModel`, each computed on first use.

    model: the model that was run; None before the first run, when all bytes are 0.
    state: the state with which the next run of the model begins.
    inputs: the intermediate results of the run. `ChipModel.data_of` computes the bytes from them.
    overflows: number of fixed-point results that wrapped or saturated so far, in the run and in calls of `data_of`.
    """

    def __init__(self, model: ChipModel | None, state: Any, inputs: Any, overflows: int = 0) -> None:
        self.state = state
        self.inputs = inputs
        self.overflows = overflows
        self._model = model
        self._data: dict[int, bytes] = {}

    def data(self, address: int) -> bytes:
        """Return the bytes of the data registers of the chip at this I2C address."""
        known = self._data.get(address)
        if known is None:
            known = bytes(BYTES) if self._model is None else self._model.data_of(address, self)
            self._data[address] = known
        return known


BYTES = 6  # number of bytes in the data registers of a chip; all are 0 before the first run of the model


class ChipModel:
    """Base of models that compute the register bytes of the sensor chips that firmware emulates.

    addresses: the I2C addresses of the emulated chips.
    at_rest: the result before the first run, in which all bytes are 0.
    """

    addresses: frozenset[int]
    at_rest: ModelOutput

    def run(self, number: int, values: tuple[int, ...] | None, before: ModelOutput) -> ModelOutput:
        """Run the model once with the values of the last host frame, and return the result.

        number: the number of the run, from 0.
        values: the values of that frame; None before the first frame. A run with None does not change the state.
        before: the result of the previous run.
        """
        raise NotImplementedError

    def data_of(self, address: int, shown: ModelOutput) -> bytes:
        """Return the register bytes of one chip, computed from `shown.inputs`.

        The number of overflows in this computation is added to `shown.overflows`.
        """
        raise NotImplementedError
