"""Format of UART frames, and the levels of a frame's bits.

start  data, LSB first  [address]  [parity]  stop [stop]
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from msgspec import Struct


class UartFormat(Struct, frozen=True):
    """The format of the frames on a line.

    bits: number of data bits, 1 to 8.
    parity: the parity of the data and the address bit: "none", "even" or "odd".
    stop: number of stop bits, 1 or 2.
    address: True if an address bit follows the data.
    """

    bits: int = 8
    parity: str = "none"
    stop: int = 1
    address: bool = False

    @property
    def length(self) -> int:
        """The number of bits of a frame, start and stop bits included."""
        return 1 + self.bits + self.address + (self.parity != "none") + self.stop

    def half_bits(self, bit: Fraction) -> list[int]:
        """Return the ticks from the start of a frame to the start of each half bit, and to the end of the frame.

        bit: the length of a bit in ticks. The second-to-last entry of the result is the middle of the last stop bit. A
        falling edge from then on starts the next frame.
        """
        return list(_half_bits(self.length, bit))

    def is_kept_by(self, levels: list[int]) -> bool:
        """Return True if the levels of a frame's bits have the start bit, stop bits and parity of this format."""
        end = len(levels) - self.stop
        if levels[0] or 0 in levels[end:]:
            return False
        return self.parity == "none" or sum(levels[1:end]) & 1 == (self.parity == "odd")

    def levels(self, byte: int, address: int = 0) -> list[int]:
        """Return the levels of one frame, bit by bit, start bit first. address: the address bit, if there is one."""
        data = [byte >> i & 1 for i in range(self.bits)] + [address] * self.address
        frame = [0, *data]
        if self.parity != "none":
            frame.append(sum(data) + (self.parity == "odd") & 1)
        return frame + [1] * self.stop


@lru_cache(maxsize=64)
def _half_bits(length: int, bit: Fraction) -> tuple[int, ...]:
    """See `UartFormat.half_bits`. length: the number of bits of a frame."""
    return tuple(int(half * bit / 2) for half in range(2 * length + 1))
