"""The emulator's sensor models: the six data bytes of each chip from a host frame, in a chosen arithmetic.

    12 bytes --> six int16 --> attitude (1e-4 rad), acceleration (1e-3 g) --> Imu --> codes --> bytes

The models are those of periph_sim/imu/models. They compute one sample at a time, as on the F28335, and keep the last
attitude and body rates for the next sample, even without a new frame (section 3.4 of the dissertation).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, lru_cache, partial
from struct import Struct
from typing import Annotated, Any, Literal

from periph_sim.core.table import DurationRange, Spread
from periph_sim.firmware import After, Before
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import named as parameter_set
from periph_sim.processor.dsp import Dsp

FRAME = Struct("<6h")
LITTLE, BIG = Struct("<3h"), Struct(">3h")
MEASURED = Spread(Fraction(250, 1_000_000), Fraction(250, 1_000_000))  # run time in dissertation, section 5.4
NOTHING = Spread(Fraction(0), Fraction(0))
NO_FRAME = bytes(FRAME.size)  # input of the models before the first frame
BYTES = "bytes"  # name of the arithmetic without models: the chips show the values of the frame


def _ignore() -> None:
    """Do nothing: the default for `on_overflow`."""


@cache
def _known(name: str) -> str:
    if name != BYTES:
        from periph_sim.imu.models.imu import Imu
        from periph_sim.imu.numeric import arithmetic_names as named

        Imu(named.scalar(name), ImuParameters())  # raises for a wrong name or format
    return name


def _parameters(value: object) -> object:
    if isinstance(value, ImuParameters):
        return value
    if not isinstance(value, str):
        raise ValueError("expected the path of a TOML file, or the name of a shipped set")
    return parameter_set(value)


ArithmeticName = Annotated[str, After(_known)]
ParameterFile = Annotated[ImuParameters, Before(_parameters)]


@dataclass
class ModelSettings:
    """Settings of the models of an emulator: when they run, how long, and what they compute.

    models_run: "round" to run the models after each round of the sensor head, with the last frame. "frame" to run them
        on each frame that is complete before a round, or after the round if none was, so that noise continues.
    model_cost: the duration of a run, a range from which each run draws a duration, or "estimate": the estimated
        duration of the equations, to which `beyond_estimate` adds the time of all other code of the models.
    """

    models_run: Literal["round", "frame"] = "round"
    model_cost: DurationRange | Literal["estimate"] = MEASURED
    beyond_estimate: DurationRange = NOTHING
    arithmetic: ArithmeticName = BYTES
    parameters: ParameterFile = field(default_factory=ImuParameters)  # a TOML file's path, or the name of a shipped set
    noise_seed: int | None = None  # seed of the sensors' noise; None: no noise

    def __post_init__(self) -> None:
        if self.model_cost == "estimate" and self.arithmetic == BYTES:
            raise ValueError('model_cost = "estimate" needs an arithmetic to estimate; give one, for instance "q16"')
        if self.model_cost != "estimate" and self.beyond_estimate.most:
            raise ValueError('beyond_estimate needs model_cost = "estimate"; give that, or leave it out')

    @property
    def sensors(self) -> ImuParameters | None:
        """The emulated sensors; None if the chips show the values of frames."""
        return None if self.arithmetic == BYTES else self.parameters

    @property
    def run_cost(self) -> Spread:
        """The duration of a run of the models, as a range."""
        if isinstance(self.model_cost, Spread):
            return self.model_cost
        return self.beyond_estimate + estimated(self.arithmetic, self.parameters)


class Models:
    """The sensor models of one emulator, with the attitude and body rates of the last sample.

    The rates of the first frame are zero, since there is no attitude before it. A step from zero to the attitude of
    the host within one period would be a rate that no gyroscope shows and that Q16 cannot represent.
    arithmetic: the name of the arithmetic, such as "float64" or "q16".
    noise_seed: seed of the sensors' noise; the n-th call uses sample n. None: no noise.
    on_overflow: called once for each result that does not fit its Q format.
    """

    def __init__(
        self,
        arithmetic: str,
        parameters: ImuParameters,
        noise_seed: int | None = None,
        on_overflow: Callable[[], None] = _ignore,
    ) -> None:
        from periph_sim.imu.model_codes import model_codes

        self._models = model_codes(parameters, arithmetic, noise_seed)
        self._shown = self._models.at_rest
        self._on_overflow = on_overflow
        self._number = 0

    def chips(self, frame: bytes) -> tuple[bytes, bytes, bytes]:
        """Return the data registers of gyroscope, accelerometer and magnetometer, in reading order.

        frame: twelve bytes, or the object NO_FRAME before the first frame, which has no effect on the next sample.
        """
        values = None if frame is NO_FRAME else FRAME.unpack(frame)
        self._shown = shown = self._models.run(self._number, values, self._shown)
        self._number += 1
        gyroscope, accelerometer, magnetometer = (shown.data(address) for address in (0x68, 0x53, 0x1E))
        for _ in range(shown.overflows):
            self._on_overflow()
        return gyroscope, accelerometer, magnetometer


def models_of(settings: ModelSettings, dsp: Dsp) -> Models | None:
    """Return the models of a case, or None if the chips show the values of frames.

    Overflows are reported to `dsp`.
    """
    if settings.arithmetic == BYTES:
        return None
    on_overflow = partial(dsp.report_overflow, f"a result of the sensor models does not fit {settings.arithmetic}")
    return Models(settings.arithmetic, settings.parameters, settings.noise_seed, on_overflow)


def shown(frame: bytes) -> tuple[bytes, bytes, bytes]:
    """Return the data without models: angles, accelerations, angles again, in each chip's order of axes and bytes."""
    roll, pitch, yaw, *accelerations = FRAME.unpack(frame)
    return BIG.pack(roll, pitch, yaw), LITTLE.pack(*accelerations), _swapped(roll, pitch, yaw)


def _swapped(x: Any, y: Any, z: Any) -> bytes:
    """Pack three values in the order x, z, y, because the magnetometer sends z before y."""
    return BIG.pack(int(x), int(z), int(y))


@lru_cache(maxsize=16)
def estimated(arithmetic: str, parameters: ImuParameters) -> Fraction:
    """Return the estimated seconds that the equations take at 150 MHz. `arithmetic` must not be "bytes"."""
    from periph_sim.imu.models.counts import counts_of
    from periph_sim.imu.numeric import arithmetic_names as named
    from periph_sim.imu.numeric.estimate import estimate

    return estimate(counts_of(parameters), named.library(arithmetic)).seconds()
