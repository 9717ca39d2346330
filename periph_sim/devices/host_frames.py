"""Interface of the Python module that defines the frames that a [host] sends.

The module defines the values of a frame, their encoding in bytes, and the chips whose registers contain them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Literal, Protocol, TypeVar, cast

from ..core.registered import registered

ByteOrder = Literal["little", "big"]
T = TypeVar("T")


class FrameSource(Protocol):
    """A function from the number of a frame to its values, which are sampled from a motion.

    beyond: for each value, by name, the number of frames so far in which it was out of range.
    """

    motion: Any
    beyond: Counter[str]

    def __call__(self, number: int) -> tuple[int, ...]: ...


class HostFrames(Protocol):
    """The Python module that defines the frames of a [host].

    FRAME_BYTES: the length of a frame.
    PARTS: the values of a frame by name, each as x, y and z.
    ADDRESSES: the I2C addresses of the chips that `data` knows.
    """

    FRAME_BYTES: int
    PARTS: Mapping[str, slice]
    ADDRESSES: frozenset[int]

    def encoding_type(self) -> type[object]:
        """Return the dataclass of [host.encoding]."""

    def motion_settings(self) -> Mapping[str, type[object]]:
        """Return the dataclass of each kind of [host.motion]."""

    def encoding_of(self, given: dict[str, object]) -> Any:
        """Return the encoding of the frames, which has a `byte_order`.

        Raise BadSetting with the name of the setting if one is wrong.
        """

    def frames_of(self, given: dict[str, object], encoding: Any, first: Fraction, period: Fraction) -> FrameSource:
        """Return the frames of the motion in `given`. Raise BadSetting with the name of the setting if one is wrong."""

    def ramp(self, number: int) -> tuple[int, ...]:
        """Return the values of a frame if the host has no motion."""

    def encode(self, values: tuple[int, ...], byte_order: ByteOrder = "little") -> bytes:
        """Return the bytes of a frame. Raise OverflowError if a value does not fit."""

    def decode(self, data: bytes) -> tuple[int, ...]:
        """Return the values of a frame from its bytes, low byte first."""

    def shown(self, values: Sequence[T]) -> Mapping[str, Sequence[T]]:
        """Return, for each chip by name, the three values of a frame that its registers contain as x, y and z.

        This holds for firmware that copies the values of a frame to the registers. Firmware with a `ChipModel`
        computes the registers from the values instead.
        """

    def data(self, address: int, values: tuple[int, ...]) -> bytes:
        """Return the register bytes of the chip with this address if they contain the values of a frame."""


def host_frames() -> HostFrames:
    """Return the Python module that defines the frames of the host."""
    return cast(HostFrames, registered("host frames"))
