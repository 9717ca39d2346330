"""Values of the host's frames, from the tables [host.motion] and [host.encoding] of a case."""

from __future__ import annotations

from fractions import Fraction

from ..core.suggest import did_you_mean
from ..imu.host_frame import Encoding, MotionFrames
from ..imu.motion import kind_named, kinds
from .firmware_loader import BadSetting, shared


def encoding_of(given: dict[str, object]) -> Encoding:
    """Return the encoding of the frames. Raise BadSetting, naming the setting, if one is wrong."""
    return shared(Encoding, given, "host.encoding")


def frames_of(given: dict[str, object], encoding: Encoding, first: Fraction, period: Fraction) -> MotionFrames:
    """Return the frames of the motion in `given`. Raise BadSetting, naming the setting, if one is wrong."""
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
    except ValueError as error:  # BadMotion; of a file BadCapture, too, whose module would bring numpy
        raise BadSetting(str(error), "") from None
    return MotionFrames(motion, encoding, first, period)
