"""The frames that a host (table [host] of a case) sends: three angles and three accelerations, signed 16-bit values.

    [host.motion] and [host.encoding], or a ramp --> values of frame n --> bytes
                                                                       --> values in the registers of the chips

The dissertation does not define the encoding; low byte first is our choice. Nothing in a frame marks its start.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from struct import Struct, error
from typing import TYPE_CHECKING, TypeVar

from ..core.phrases import did_you_mean
from ..devices.host_frames import ByteOrder
from ..devices.sensor_rounds import register_bytes
from ..scene.firmware_loader import BadSetting, shared
from .sensors import SENSORS

if TYPE_CHECKING:
    from .host_frame import Encoding, MotionFrames

T = TypeVar("T")

VALUES = 6
FRAME_BYTES = 2 * VALUES
PACKED = {"little": Struct(f"<{VALUES}h"), "big": Struct(f">{VALUES}h")}
# For each value of a frame in `ramp`: the step from frame to frame, and the value in frame 0.
RAMP = ((1, 1), (3, 1000), (5, -2000), (7, 12), (11, -34), (13, 1000))
PARTS = {"angles": slice(0, 3), "accelerations": slice(3, 6)}
# Maps the name of a chip to the part of a frame that firmware without sensor models copies to the chip's registers.
SHOWN = {"gyroscope": "angles", "accelerometer": "accelerations", "magnetometer": "angles"}
BY_ADDRESS = {SENSORS[name].address: (SENSORS[name], PARTS[part]) for name, part in SHOWN.items()}
ADDRESSES = frozenset(BY_ADDRESS)


def ramp(number: int) -> tuple[int, ...]:
    """Return the values of frame `number` of a host without a motion.

    The values do not repeat for 65536 frames, so that values on the bus identify their frame.
    """
    return tuple((number * step + start + 0x8000) % 0x10000 - 0x8000 for step, start in RAMP)


def encode(values: tuple[int, ...], byte_order: ByteOrder = "little") -> bytes:
    """Return the bytes of a frame. Raise OverflowError for a value that does not fit 16 bits."""
    try:
        return PACKED[byte_order].pack(*values)
    except error:
        raise OverflowError(f"{values} do not all fit 16 bits") from None


def decode(data: bytes) -> tuple[int, ...]:
    """Return the values of a frame. data: its bytes, with the low byte of each value first."""
    return PACKED["little"].unpack(data)


def shown(values: Sequence[T]) -> dict[str, Sequence[T]]:
    """Return, by the name of each chip, the three values that firmware copies to the chip's registers (see SHOWN).

    values: the six values of a frame.
    """
    return {name: values[PARTS[part]] for name, part in SHOWN.items()}


def data(address: int, values: tuple[int, ...]) -> bytes:
    """Return the register bytes of the chip at this address after firmware has copied a frame's values (see SHOWN)."""
    chip, part = BY_ADDRESS[address]
    return register_bytes(chip, values[part])


def encoding_type() -> type[object]:
    """Return the dataclass of [host.encoding]."""
    from .host_frame import Encoding

    return Encoding


def motion_settings() -> Mapping[str, type[object]]:
    """Return the dataclass of the settings of each kind of [host.motion], by the name of the kind."""
    from .motion import kinds

    return {name: kind.Settings for name, kind in kinds().items()}


def encoding_of(given: dict[str, object]) -> Encoding:
    """Return the encoding with the settings `given`. Raise BadSetting if a setting is invalid."""
    from .host_frame import Encoding

    return shared(Encoding, given, "host.encoding")


def frames_of(given: dict[str, object], encoding: Encoding, first: Fraction, period: Fraction) -> MotionFrames:
    """Return the frames of the motion with the settings `given`.

    first: the instant of the motion, in seconds, that frame 0 describes.
    period: the time between two frames in seconds.

    Raise BadSetting, with the name of the setting, if a setting is invalid. The name is "" if the settings are valid
    one by one, but the motion cannot be made from them.
    """
    from .host_frame import MotionFrames
    from .motion import kind_named, kinds

    settings = dict(given)
    name = settings.pop("kind", None)
    if name is None:
        raise BadSetting(f"it has no kind; the kinds are {', '.join(kinds())}", "kind")
    kind = kind_named(str(name))
    if kind is None:
        raise BadSetting(f"there is no motion {name!r}; {did_you_mean(str(name), kinds())}", "kind")
    checked = shared(kind.Settings, settings, f"motion {name}")
    try:
        motion = kind.motion(checked)
    # The error is BadMotion, or BadCapture for a file. BadCapture is not imported, because its module imports numpy.
    except ValueError as error:
        raise BadSetting(str(error), "") from None
    return MotionFrames(motion, encoding, first, period)
