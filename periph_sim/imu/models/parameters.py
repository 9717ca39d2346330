"""Parameters of the sensor models, each with its unit, range and source (see quantity.py).

The defaults are those of Table 4.1 of the dissertation. If the dissertation gives no value, the source of the parameter
says so and gives the reason for the chosen value.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Literal

from ...core.time import Timebase
from ..numeric.arithmetic import Rounding
from .quantity import BadParameter, Checked, Choice, Quantity, Vector

Rates = Literal["as built", "corrected"]
Wrap = Literal["as built", "unwrapped"]
Spherical = Literal["four-quadrant", "plain", "rotation"]
Norm = Literal["squares", "mag"]

# Relative tolerance of a period, because the clocks of unit, controller and host may differ by 1000 ppm in total.
PERIOD_TOLERANCE = Fraction(1, 1000)
STANDARD_GRAVITY = 9.81  # m/s^2 in one g, section 4.3.4
NONE: Vector = (0.0, 0.0, 0.0)

TABLE = "dissertation, Table 4.1"
SILENT = "the dissertation gives none"
ARM = f"{SILENT}; 0, at the centre of gravity, which changes nothing at rest"
G_SENS = f"{SILENT}; 0.1 is usual for such a gyroscope, and changes nothing at rest"
AXES = f"{SILENT}; the chip's axes are assumed to be the body's"
FIELD = "Table 5.1, the real mean: undisturbed, level, pointing north (section 5.2; see at_rest/earth_field.py)"
BOARD = f"{SILENT}; 0: its effect at rest is in earth_field already"
OFF = "section 4.3.4 leaves it out; 0 is off"
NEAREST = "not said; nearest, which Table 5.1's emulated means of the gyroscope fit within one standard error"
EITHER = "not said; nearest; Table 5.1's emulated means of this sensor lie half an LSB lower, where a floor has them"


class SensorParameters(Checked, frozen=True):
    """The parameters that each sensor has: for the matrix S, and for the range and rounding of the converter's codes.

    scale: the number of LSB per unit.
    cross_axis: the cross-axis sensitivity as a fraction of `scale`.
    bits: the number of bits of a code.
    """

    scale: float
    cross_axis: float
    bits: int
    rounding: Rounding

    @property
    def matrix(self) -> tuple[Vector, Vector, Vector]:
        """The matrix S. The element in row i and column k is the number of LSB on axis i per unit on axis k.

        The diagonal elements are `scale`. The other elements are `cross_axis` times `scale`, all with the same sign.
        """
        on, off = self.scale, self.scale * self.cross_axis
        return (on, off, off), (off, on, off), (off, off, on)

    @property
    def limits(self) -> tuple[int, int]:
        """The converter's lowest and highest code, in LSB."""
        return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1


class AccelerometerParameters(SensorParameters, frozen=True):
    """Parameters of the ADXL345 (equations 4.1 to 4.4).

    lever_arm: d of equation 4.3, the position of the chip relative to the centre of gravity.
    """

    bias: Annotated[Vector, Quantity("g", -16, 16, TABLE)] = (-0.02, 0.02, -0.00)
    noise_density: Annotated[Vector, Quantity("g^2/Hz", 0, 1, TABLE)] = (0.16e-4, 0.16e-4, 0.15e-4)
    scale: Annotated[float, Quantity("LSB/g", 1e-3, 1e6, TABLE)] = 256.0
    cross_axis: Annotated[float, Quantity("", -0.5, 0.5, TABLE)] = 0.01
    bits: Annotated[int, Quantity("bit", 2, 16, TABLE)] = 10
    full_scale: Annotated[float, Quantity("g", 1e-3, 1e3, "ADXL345 data sheet, range 0")] = 2.0
    rounding: Annotated[Rounding, Choice(EITHER)] = "nearest"
    lever_arm: Annotated[Vector, Quantity("m", -100, 100, ARM)] = NONE
    bias_instability: Annotated[Vector, Quantity("g", 0, 16, OFF)] = NONE
    random_walk: Annotated[Vector, Quantity("g/s^0.5", 0, 16, OFF)] = NONE


class GyroscopeParameters(SensorParameters, frozen=True):
    """Parameters of the ITG-3200 (equation 4.5, appendix B).

    g_sens: the change of a rate per g of linear acceleration on the axis with the same name.
    mounting: for each axis of the chip, the number of the parallel body axis: 1 for x, 2 for y, 3 for z. The number is
        negative if the two axes point in opposite directions.
    rates: "as built" for the derivatives of the three angles, or "corrected" for the body rates of appendix B.
    """

    bias: Annotated[Vector, Quantity("deg/s", -2000, 2000, TABLE)] = (-3.10, 3.60, 0.04)
    noise_density: Annotated[Vector, Quantity("(deg/s)^2/Hz", 0, 1e4, TABLE)] = (0.05e-3, 0.12e-3, 0.04e-3)
    scale: Annotated[float, Quantity("LSB/(deg/s)", 1e-3, 1e6, TABLE)] = 14.375
    cross_axis: Annotated[float, Quantity("", -0.5, 0.5, TABLE)] = 0.02
    bits: Annotated[int, Quantity("bit", 2, 16, TABLE)] = 16
    full_scale: Annotated[float, Quantity("deg/s", 1e-3, 1e6, "ITG-3200 specification, FS_SEL 3")] = 2000.0
    rounding: Annotated[Rounding, Choice(NEAREST)] = "nearest"
    g_sens: Annotated[float, Quantity("(deg/s)/g", -100, 100, G_SENS)] = 0.1
    mounting: Annotated[Vector, Quantity("", -3, 3, AXES)] = (1, 2, 3)
    rates: Annotated[Rates, Choice("section 4.3.2; appendix B")] = "as built"
    bias_instability: Annotated[Vector, Quantity("deg/s", 0, 2000, OFF)] = NONE
    random_walk: Annotated[Vector, Quantity("(deg/s)/s^0.5", 0, 2000, OFF)] = NONE

    def __post_init__(self) -> None:
        super().__post_init__()
        if sorted(abs(axis) for axis in self.mounting) != [1, 2, 3]:
            found = ", ".join(f"{axis:g}" for axis in self.mounting)
            raise BadParameter("gyroscope.mounting", f"expected 1, 2 and 3 once each, with a sign, but it is {found}")


class MagnetometerParameters(SensorParameters, frozen=True):
    """Parameters of the HMC5883L (equations 4.6 to 4.8).

    hard_iron: the constant field of magnetised parts near the chip (V). It is added to the earth field.
    earth_field: the earth field in the axes of a body whose roll, pitch and yaw are 0 (H_rt).
    board_azimuth, board_elevation: the inclination of the board in the body (Incl_PCB).
    spherical: the method that adds the inclination to the azimuth and elevation of the field (H_rp). "plain": with
        arctangents, as written in section 4.3.3. "four-quadrant": with atan2, which is the intended form. "rotation":
        with sines and cosines of the inclination only, which gives the values of "four-quadrant". The equations are in
        `chips.Magnetometer`.
    norm: the method for the length of a vector. "squares": the root of the sum of squares, as written in section 4.3.3.
        "mag": `Arithmetic.mag`, which takes two numbers at a time and squares them without overflow in a Q format.
    """

    hard_iron: Annotated[Vector, Quantity("gauss", -8, 8, TABLE)] = (-0.16, 0.17, -0.02)
    noise_density: Annotated[Vector, Quantity("gauss^2/Hz", 0, 1, TABLE)] = (0.58e-6, 0.77e-6, 0.20e-6)
    scale: Annotated[float, Quantity("LSB/gauss", 1e-3, 1e6, TABLE)] = 660.0
    cross_axis: Annotated[float, Quantity("", -0.5, 0.5, TABLE)] = 0.002
    bits: Annotated[int, Quantity("bit", 2, 16, TABLE)] = 12
    full_scale: Annotated[float, Quantity("gauss", 1e-3, 1e3, "HMC5883L data sheet, GN 3")] = 2.5
    rounding: Annotated[Rounding, Choice(EITHER)] = "nearest"
    earth_field: Annotated[Vector, Quantity("gauss", -1000, 1000, FIELD)] = (0.3239, -0.0447, 0.0060)
    board_azimuth: Annotated[float, Quantity("deg", -180, 180, BOARD)] = 0.0
    board_elevation: Annotated[float, Quantity("deg", -90, 90, BOARD)] = 0.0
    spherical: Annotated[Spherical, Choice("equation 4.7; section 4.3.3 writes plain arctangents")] = "four-quadrant"
    norm: Annotated[Norm, Choice("section 4.3.3, cart2sph")] = "squares"
    bias_instability: Annotated[Vector, Quantity("gauss", 0, 8, OFF)] = NONE
    random_walk: Annotated[Vector, Quantity("gauss/s^0.5", 0, 8, OFF)] = NONE


class ImuParameters(Checked, frozen=True):
    """Parameters of all three sensors and of their common derivative.

    period: Ts, the time between two samples.
    wrap: the treatment of a step of nearly 360 degrees. "as built": the step is used as it is. "unwrapped": a step of
        roll or yaw by more than half a turn is changed by one turn, so that it is the shorter way round.
    """

    accelerometer: AccelerometerParameters = AccelerometerParameters()
    gyroscope: GyroscopeParameters = GyroscopeParameters()
    magnetometer: MagnetometerParameters = MagnetometerParameters()
    period: Annotated[float, Quantity("s", 1e-6, 3600, "section 3.4: 20 ms; 0 has no derivative")] = 0.02
    wrap: Annotated[Wrap, Choice("section 4.3.2 takes plain differences")] = "as built"

    def check_period(self, runs: Fraction, what: str) -> None:
        """Raise BadParameter unless the models' period is `runs` seconds, within 0.1 %.

        If the models run at another period, every rate is wrong by the ratio of the periods. No other check detects
        this mistake.

        runs: the period in seconds at which the models run.
        what: the occasion at which the models run, for the message, such as "once a round".
        """
        period = Fraction(self.period)
        if abs(period - runs) > PERIOD_TOLERANCE * runs:
            base = Timebase()
            shown, meant = (base.show(base.ticks(seconds, "nearest")) for seconds in (period, runs))
            raise BadParameter(
                "imu.period",
                f"the models' period is {shown}, but they run {what}, every {meant}; "
                "make them the same, or every rate is off by their ratio",
            )
