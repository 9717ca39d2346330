"""Interface of the models by which firmware computes the register bytes of chips from host frames.

    frame --ChipModel.run--> Shown --data--> bytes, by address

The models that firmware can use are subclasses of `ChipModel`. They compute the bytes that a controller should read.
"""

# core: compiled

from __future__ import annotations

from typing import Any, final


@final
class Shown:
    """The register bytes of the chips after one run of a model. The bytes of a chip are computed on first use.

    state: the state of the model for the next run.
    inputs: the data from which the model computes the bytes.
    overflows: the number of intermediate results so far that did not fit the arithmetic.
    model: the model; None before the first run, when all bytes are 0.
    """

    def __init__(self, model: ChipModel | None, state: Any, inputs: Any, overflows: int = 0) -> None:
        self.state = state
        self.inputs = inputs
        self.overflows = overflows
        self._model = model
        self._data: dict[int, bytes] = {}

    def data(self, address: int) -> bytes:
        """Return the register bytes of the chip with this address."""
        known = self._data.get(address)
        if known is None:
            known = bytes(BYTES) if self._model is None else self._model.data_of(address, self)
            self._data[address] = known
        return known


BYTES = 6  # number of register bytes of a chip before the first run


class ChipModel:
    """Base of the models by which firmware computes the register bytes of chips.

    addresses: the addresses of these chips.
    at_rest: the result before the first run, in which all bytes are 0.
    """

    addresses: frozenset[int]
    at_rest: Shown

    def run(self, number: int, values: tuple[int, ...] | None, before: Shown) -> Shown:
        """Return the result of one run of the model, which processes the values of a frame.

        number: the number of the run, from 0.
        values: the values; None before the first frame. A run without values has no effect on the next one.
        before: the result of the last run.
        """
        raise NotImplementedError

    def data_of(self, address: int, shown: Shown) -> bytes:
        """Return the register bytes of one chip, and count overflows in `shown`."""
        raise NotImplementedError
