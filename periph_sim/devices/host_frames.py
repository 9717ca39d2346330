"""Interface of the Python module that defines the frames of a [host]: values, bytes, and what chips show of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Literal, Protocol, TypeVar, cast

from ..core.registered import registered

ByteOrder = Literal["little", "big"]
T = TypeVar("T")


class FrameSource(Protocol):
    """The values of the frames of a motion: call it with the number of a frame.

    beyond: number of times that each value was outside its range.
    """

    motion: Any
    beyond: Counter[str]

    def __call__(self, number: int) -> tuple[int, ...]: ...


class HostFrames(Protocol):
    """The Python module that defines the frames of a [host].

    FRAME_BYTES: the length of a frame.
    PARTS: the values of a frame by name, each as x, y and z.
    ADDRESSES: the addresses of the chips that show the values of a frame if firmware computes no model.
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
        """Return, by chip, which values of a frame the chip shows as x, y, z if firmware computes no model."""

    def data(self, address: int, values: tuple[int, ...]) -> bytes:
        """Return the register bytes of the chip with this address when it shows the values of a frame."""


def host_frames() -> HostFrames:
    """Return the Python module that defines the frames of the host."""
    return cast(HostFrames, registered("host frames"))
