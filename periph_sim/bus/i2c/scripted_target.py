"""I2C targets that answer as they once did: lists of answers by address go in; ACKs and bytes on the wires come out.

    SCL, SDA --> TargetSide --> address known? next answer --> SDA

It stands for the devices of a bus that are not the one under test. It stretches where its answer says so. An address
without answers left is not acknowledged.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ...core.kernel import Kernel
from ...core.wire import Wire
from .target_side import Stretches, TargetSide


@dataclass(frozen=True, slots=True)
class Answer:
    """To one START with its address. data: sent in a read, ones follow. acks: of the bytes written; then all ACK.

    stretches: (byte, bit, ticks) as in `target_side.Reply`.
    """

    ack: bool
    data: bytes = b""
    acks: tuple[bool, ...] = ()
    stretches: Stretches = ()

    def sends(self, byte: int) -> int:
        return self.data[byte] if byte < len(self.data) else 0xFF

    def hears(self, byte: int, value: int) -> bool:
        return byte >= len(self.acks) or self.acks[byte]


class ScriptedTarget(TargetSide):
    """hold: ticks from SCL's fall to its change of SDA."""

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        answers: Mapping[int, Iterable[Answer]],
        hold: int,
        who: str = "targets",
    ) -> None:
        self._left = {address: deque(of) for address, of in answers.items()}
        super().__init__(kernel, scl, sda, self._next, hold, who)

    def _next(self, address_byte: int) -> Answer | None:
        """The answer to this address byte; None if none is left."""
        waiting = self._left.get(address_byte >> 1)
        return waiting.popleft() if waiting else None
