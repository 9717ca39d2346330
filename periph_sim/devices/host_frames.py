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

    motion: the object that computes the movement of the sensors at a time.
    beyond: for the name of each value, the number of frames so far in which the value did not fit 16 bits.
    """

    motion: Any
    beyond: Counter[str]

    def __call__(self, number: int) -> tuple[int, ...]: ...


class HostFrames(Protocol):
    """The Python module that defines the frames of a [host].

    FRAME_BYTES: the number of bytes of a frame.
    PARTS: for the name of each part of a frame, such as "angles", the slice of the tuple of values (not of the bytes)
        that has the three values of this part.
    ADDRESSES: the I2C addresses that `data` accepts.
    """

    FRAME_BYTES: int
    PARTS: Mapping[str, slice]
    ADDRESSES: frozenset[int]

    def encoding_type(self) -> type[object]:
        """Return the dataclass of [host.encoding]."""

    def motion_settings(self) -> Mapping[str, type[object]]:
        """Return the dataclass of the settings of each kind of [host.motion], by the name of the kind."""

    def encoding_of(self, given: dict[str, object]) -> Any:
        """Return the encoding of the frames, an object with the attribute `byte_order`.

        Raise BadSetting, with the name of the setting, if a setting in `given` is invalid.
        """

    def frames_of(self, given: dict[str, object], encoding: Any, first: Fraction, period: Fraction) -> FrameSource:
        """Return the frames of the motion with the settings `given`.

        first: the time of the motion, in seconds, that frame 0 describes.
        period: the time between two frames in seconds.

        Raise BadSetting, with the name of the setting, if a setting is invalid.
        """

    def ramp(self, number: int) -> tuple[int, ...]:
        """Return the values of frame `number` of a host without a motion."""

    def encode(self, values: tuple[int, ...], byte_order: ByteOrder = "little") -> bytes:
        """Return the bytes of a frame. Raise OverflowError if a value does not fit 16 bits."""

    def decode(self, data: bytes) -> tuple[int, ...]:
        """Return the values of a frame from its bytes, low byte first."""

    def shown(self, values: Sequence[T]) -> Mapping[str, Sequence[T]]:
        """Return the x, y and z in the registers of each chip, by the chip's name. values: those of a frame.

        The result is valid for firmware that copies the values of a frame to the registers. Firmware with a `ChipModel`
        computes the registers from the values instead.
        """

    def data(self, address: int, values: tuple[int, ...]) -> bytes:
        """Return the register bytes of the chip with this address after firmware has copied the values of a frame."""


def host_frames() -> HostFrames:
    """Return the Python module that defines the frames of the host."""
    return cast(HostFrames, registered("host frames"))
