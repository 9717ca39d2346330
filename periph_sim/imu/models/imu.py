"""The whole IMU: nine codes from attitude, acceleration and noise, in any arithmetic.

    attitude --+--> Derivative --> Gyroscope -----> x, y, z
               +--> angles ------> Accelerometer -> x, y, z
    a_lin -----+                   Magnetometer --> x, y, z

Source: the dissertation's Figure 4.6 and section 4.3.5. The derivative is computed once, and so are the six sines and
cosines. Inputs must be finite: a NaN would have a different effect in each arithmetic, such as 0 LSB in float64 and
full scale in float32.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from math import isfinite
from typing import Generic, NamedTuple, TypeVar, cast

from ..numeric.arithmetic import Arithmetic, Triple
from ..numeric.q import DoesNotFit, Q
from . import parameters
from .chips import Accelerometer, Angles, Derivative, Gyroscope, Magnetometer, SensorEquations, angles

INPUTS = (
    *(f"attitude, {angle}" for angle in ("roll", "pitch", "yaw")),
    *(f"acceleration, {axis}" for axis in "xyz"),
    *(f"noise of the {chip}, {axis}" for chip in ("gyroscope", "accelerometer", "magnetometer") for axis in "xyz"),
)


class NotFinite(ValueError):
    """An input of the models is NaN or infinite. The message names the input, such as "attitude, pitch"."""


R = TypeVar("R")
T = TypeVar("T")


class Noise(NamedTuple, Generic[T]):
    """Noise of the three chips on x, y, z, in deg/s, g and gauss.

    The models add the noise before they multiply by the matrix S, which has scale and cross-axis sensitivity.
    """

    gyroscope: Triple[T]
    accelerometer: Triple[T]
    magnetometer: Triple[T]


class Inputs(NamedTuple, Generic[T]):
    """The inputs of the chips at one sample.

    turned: the sines and cosines of the attitude.
    acceleration: the linear acceleration in g.
    body: p, q, r of this sample in rad/s.
    body_before: p, q, r of the previous sample in rad/s.
    """

    turned: Angles[T]
    acceleration: Triple[T]
    body: Triple[T]
    body_before: Triple[T]
    noise: Noise[T]


class Codes(NamedTuple, Generic[T]):
    """Codes of each chip on x, y and z, which are whole numbers of LSB."""

    gyroscope: Triple[T]
    accelerometer: Triple[T]
    magnetometer: Triple[T]


class State(NamedTuple, Generic[T]):
    """The values of a sample that the models need at the next sample.

    attitude: roll, pitch, yaw in rad.
    body: the body rates p, q, r in rad/s.
    """

    attitude: Triple[T]
    body: Triple[T]


def _named(part: str, build: Callable[[], R]) -> R:
    """Return the result of `build`. If it raises DoesNotFit, add the name of the part to the message."""
    try:
        return build()
    except DoesNotFit as error:
        raise DoesNotFit(f"{part}: {error}") from None


class Imu(Generic[T]):
    """The models of the three sensors. They are stateless: `step` receives a state and returns the next state."""

    def __init__(self, a: Arithmetic[T], imu: parameters.ImuParameters) -> None:
        """Build the models with the parameters `imu` in the arithmetic `a`.

        Raise DoesNotFit, with the name of the sensor or "derivative", if a Q format cannot hold a constant, or holds
        1/Ts with an error of more than 1 %.
        """
        self.a = a
        zero = a.constant(0.0)
        still = (zero, zero, zero)
        self.silence: Noise[T] = Noise(still, still, still)
        self.at_rest: State[T] = State(still, still)
        self.derivative = _named("derivative", lambda: Derivative(a, imu.period, imu.wrap))
        self.gyroscope = _named("gyroscope", lambda: Gyroscope(a, imu.gyroscope))
        self.accelerometer = _named("accelerometer", lambda: Accelerometer(a, imu.accelerometer))
        self.magnetometer = _named("magnetometer", lambda: Magnetometer(a, imu.magnetometer))

    @property
    def overflows(self) -> int:
        """The number of results so far that did not fit the Q format; 0 in another arithmetic."""
        return self.a.overflows if isinstance(self.a, Q) else 0

    def check(self, attitude: Triple[T], acceleration: Triple[T], noise: Noise[T]) -> None:
        """Raise NotFinite, with the axis, if an input is NaN or infinite. In a Q format, all numbers are finite."""
        if not isinstance(self.a, Q):
            for axis, value in zip(INPUTS, chain(attitude, acceleration, *noise), strict=True):
                if not isfinite(cast(float, value)):
                    raise NotFinite(f"{axis}: {float(cast(float, value))}; expected a finite number")

    def motion(self, attitude: Triple[T], before: Triple[T]) -> tuple[Angles[T], Triple[T]]:
        """Return the sines and cosines of an attitude, and p, q, r in rad/s.

        attitude, before: the attitude of this sample and of the previous sample in rad.
        """
        turned = angles(self.a, attitude)
        return turned, self.gyroscope.body_rates(self.derivative.rates(attitude, before), turned)

    def codes_of(self, chip: str, inputs: Inputs[T]) -> Triple[T]:
        """Return the codes of a chip on x, y, z. chip: the name of a field of Codes."""
        equations: SensorEquations[T] = getattr(self, chip)
        return equations.converted(self.lsb_of(chip, inputs))

    def lsb_of(self, chip: str, inputs: Inputs[T]) -> Triple[T]:
        """Return x, y, z of a chip in LSB, before saturation and rounding. chip: the name of a field of Codes."""
        turned, acceleration, body, body_before, noise = inputs
        if chip == "gyroscope":
            return self.gyroscope.lsb(body, acceleration, noise.gyroscope)
        if chip == "magnetometer":
            return self.magnetometer.lsb(turned, noise.magnetometer)
        change = self.derivative.change(body, body_before)
        return self.accelerometer.lsb(turned, acceleration, body, change, noise.accelerometer)

    def step(
        self, attitude: Triple[T], acceleration: Triple[T], noise: Noise[T], before: State[T]
    ) -> tuple[Codes[T], State[T]]:
        """Calculate the codes of one sample and the next state.

        attitude: roll, pitch, yaw in rad.
        acceleration: the linear acceleration in g.
        before: the state after the previous sample.

        Raise NotFinite, with the axis, if an input is NaN or infinite.
        """
        self.check(attitude, acceleration, noise)
        turned, body = self.motion(attitude, before.attitude)
        inputs = Inputs(turned, acceleration, body, before.body, noise)
        g, a, m = (self.codes_of(chip, inputs) for chip in Codes._fields)
        return Codes(g, a, m), State(attitude, body)
