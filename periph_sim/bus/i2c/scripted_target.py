"""I2C targets that answer from lists of recorded answers by address.

    SCL, SDA --> TargetSide --> address known? next answer --> SDA

The targets replace the devices of a bus that are not under test. They stretch the clock if the answer has stretches. An
address without remaining answers is not acknowledged.

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
    """Answer to a START with an address.

    data: the bytes that are sent in a read; 0xFF follows them.
    acks: the acknowledges of written bytes; further bytes are acknowledged.
    stretches: triples (byte, bit, ticks) as in `target_side.Reply`.
    """

    ack: bool
    data: bytes = b""
    acks: tuple[bool, ...] = ()
    stretches: Stretches = ()

    def send_byte(self, byte: int) -> int:
        return self.data[byte] if byte < len(self.data) else 0xFF

    def receive_byte(self, byte: int, value: int) -> bool:
        return byte >= len(self.acks) or self.acks[byte]


class ScriptedTarget(TargetSide):
    """Answers for the addresses in `answers`. hold: ticks from the fall of SCL to a change of SDA."""

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
        """Return the answer to this address byte; None if none is left."""
        waiting = self._left.get(address_byte >> 1)
        return waiting.popleft() if waiting else None
