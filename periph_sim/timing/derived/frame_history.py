"""History of all frames that a host has sent, searched for the youngest frame that shows given bytes.

A frame takes 28 bytes, and 6 more for each chip that is asked for: an hour of 50 frames a second is 5 MB.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from struct import Struct

from ...devices.chip_model import BYTES


class FrameHistory:
    """data: returns the register bytes of the chip with an address while it shows the values of a frame."""

    def __init__(self, data: Callable[[int, tuple[int, ...]], bytes]) -> None:
        self._data = data
        self._numbers = array("q")
        self._ended = array("q")
        self._values = bytearray()
        self._format: Struct | None = None  # known from the first frame on
        self._shown: dict[int, bytearray] = {}  # by address, what the chip shows of each frame up to some frame

    def add(self, number: int, values: tuple[int, ...], ended: int) -> None:
        """Append a frame. ended: the tick at which its last stop bit ended."""
        self._numbers.append(number)
        self._ended.append(ended)
        self._format = self._format or Struct(f"<{len(values)}h")
        self._values += self._format.pack(*values)

    def youngest(self, address: int, got: bytes) -> tuple[int, int, bytes] | None:
        """Return (number, ended, bytes shown) of the youngest frame that shows `got`, or begins so.

        None if there is no such frame.
        """
        shown = self._shown_at(address)
        at = shown.rfind(got)
        while at > 0 and at % BYTES:
            at = shown.rfind(got, 0, at - 1 + len(got))
        if at < 0 or at % BYTES:
            return None
        frame = at // BYTES
        return self._numbers[frame], self._ended[frame], bytes(shown[at : at + BYTES])

    def _shown_at(self, address: int) -> bytearray:
        """Return the bytes that the chip with this address shows of each frame, one frame after the other."""
        shown = self._shown.setdefault(address, bytearray())
        for frame in range(len(shown) // BYTES, len(self._numbers)):
            assert self._format is not None
            shown += self._data(address, self._format.unpack_from(self._values, frame * self._format.size))
        return shown
