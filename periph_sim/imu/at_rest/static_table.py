"""Reproduction of Table 5.1 of the dissertation: mean, 3 sigma and variance of the sensors at rest.

The table shows published, reproduced and expected values next to each other. The deviation of a value from the expected
value is shown in standard errors, so that a reader can see which deviations are explained by chance. The published
values come from 10 000 samples.

The dissertation's parameters can be interpreted in several ways. `readings` returns a list of interpretations. Each
interpretation adds one effect to the previous one. Its expected means are compared with the published means of the
emulator. The second to last interpretation is the parameter set `table_5_1`, which comes with periph_sim.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any, NamedTuple

from msgspec.structs import replace

from ...core.text_table import text_table
from ..models.parameters import NONE, ImuParameters
from ..noise import AXES
from ..parameter_sets import named
from .rest import SENSORS, UNITS, ExpectedMoments, Floats, expected_at_rest, variances_before_rounding

Three = tuple[float, float, float]  # values on x, y, z

SAMPLES = 10_000  # number of samples of the published table
RATE = 50  # sample rate of the published table in Hz


class PublishedRow(NamedTuple):
    """Published figures of one sensor on x, y, z, in g, deg/s or gauss; variances in the squares of these units.

    The variances of the magnetometer are printed as 0.0000.
    """

    mean: Three
    three_sigma: Three
    variance: Three


REAL = {
    "accelerometer": PublishedRow((-0.0188, 0.0196, -1.0007), (0.0831, 0.0801, 0.0887), (0.0008, 0.0007, 0.0009)),
    "gyroscope": PublishedRow((-3.1041, 3.5997, 0.0438), (0.1312, 0.1475, 0.1338), (0.0019, 0.0024, 0.0020)),
    "magnetometer": PublishedRow((0.3239, -0.0447, 0.0060), (0.0149, 0.0190, 0.0082), (0.0000, 0.0000, 0.0000)),
}
EMULATOR = {
    "accelerometer": PublishedRow((-0.0301, 0.0076, -1.0035), (0.0857, 0.0845, 0.0839), (0.0008, 0.0008, 0.0008)),
    "gyroscope": PublishedRow((-3.0313, 3.5380, 0.0535), (0.1452, 0.2370, 0.1356), (0.0023, 0.0062, 0.0020)),
    "magnetometer": PublishedRow((0.3231, -0.0447, 0.0056), (0.0164, 0.0187, 0.0097), (0.0000, 0.0000, 0.0000)),
}


PRINTED = 1e-4 / sqrt(12)  # standard error that is caused by printing a number with four decimals


@dataclass(frozen=True)
class Figure:
    """One figure of the table, such as the mean of one axis, in the unit of the sensor (squared for a variance).

    real, emulator: the published values of the real IMU and of the emulator.
    ours: the reproduced value, calculated from samples of the models.
    expected: the value to which `ours` tends with more samples.
    error, published_error: the standard errors of the reproduced value and of the published values.
    """

    real: float
    emulator: float
    ours: float
    expected: float
    error: float
    published_error: float

    @property
    def ours_off(self) -> float | None:
        """The reproduced value minus the expected value, in standard errors; None if the standard error is 0."""
        return (self.ours - self.expected) / self.error if self.error else None

    @property
    def emulator_off(self) -> float:
        """The published value of the emulator minus the expected value, in standard errors.

        The standard error includes the rounding of the printed value to four decimals.
        """
        return (self.emulator - self.expected) / hypot(self.published_error, PRINTED)


@dataclass(frozen=True)
class AxisRow:
    """The figures of the table for one axis."""

    sensor: str
    axis: str
    mean: Figure
    three_sigma: Figure
    variance: Figure


def static_table(imu: ImuParameters, samples: Mapping[str, Floats]) -> list[AxisRow]:
    """Return the nine rows of the table. samples: the result of `rest.at_rest` for the parameters `imu`."""
    expected = expected_at_rest(imu)
    return [
        _row(sensor, axis, samples[sensor][:, axis], expected[sensor][axis]) for sensor in SENSORS for axis in range(3)
    ]


def _row(sensor: str, axis: int, values: Floats, expected: ExpectedMoments) -> AxisRow:
    variance, sigma = float(values.var(ddof=1)), sqrt(expected.variance)
    real, emulator = REAL[sensor], EMULATOR[sensor]
    means, variances = (
        [error(count) for count in (len(values), SAMPLES)] for error in (expected.mean_error, expected.variance_error)
    )
    sigmas = [3 * error / (2 * sigma) if sigma else 0.0 for error in variances]
    return AxisRow(
        sensor,
        AXES[axis],
        Figure(real.mean[axis], emulator.mean[axis], float(values.mean()), expected.mean, *means),
        Figure(real.three_sigma[axis], emulator.three_sigma[axis], 3 * sqrt(variance), 3 * sigma, *sigmas),
        Figure(real.variance[axis], emulator.variance[axis], variance, expected.variance, *variances),
    )


@dataclass(frozen=True)
class Interpretation:
    """An interpretation of the dissertation's parameters, and its agreement with the published means.

    says: the effect that the interpretation adds, as a phrase.
    off: a dictionary from the name of each sensor to three differences, on x, y and z. A difference is the emulator's
        published mean minus the mean of this interpretation, in standard errors.
    """

    says: str
    off: dict[str, tuple[float, ...]]

    def rms(self, sensor: str) -> float:
        """Return the root mean square of `off` over a sensor's axes; about 1 if chance explains the differences."""
        return sqrt(sum(off**2 for off in self.off[sensor]) / len(AXES))


def readings() -> list[Interpretation]:
    """Return all interpretations, each with its differences from the published means.

    Table 4.1 prints biases with two decimals. The set `table_5_1` has biases with four decimals, which follow from the
    means of the real IMU in Table 5.1. No interpretation has hard iron, since Table 5.1 was measured away from iron
    (section 5.2).
    """
    table_4_1, table_5_1 = _each(ImuParameters(), ("magnetometer",), hard_iron=NONE), named("table_5_1")
    sets = {
        "bias of Table 4.1 alone": _each(table_4_1, cross_axis=0.0),
        "and cross-axis sensitivity": table_4_1,
        "and bias to four decimals": _each(table_5_1, rounding="nearest"),
        "and floor for two: table_5_1": table_5_1,
        "and floor for the gyroscope": _each(table_5_1, rounding="floor"),
    }
    return [Interpretation(says, _off(expected_at_rest(imu))) for says, imu in sets.items()]


def _off(expected: Mapping[str, Sequence[ExpectedMoments]]) -> dict[str, tuple[float, ...]]:
    return {
        sensor: tuple(
            # The standard error has three causes: noise of the mean, rounding of the printed mean, and rounding of the
            # printed bias.
            (found - axis.mean) / hypot(axis.mean_error(SAMPLES), PRINTED, PRINTED)
            for found, axis in zip(EMULATOR[sensor].mean, expected[sensor], strict=True)
        )
        for sensor in SENSORS
    }


def _each(imu: ImuParameters, sensors: Sequence[str] = SENSORS, **changes: Any) -> ImuParameters:
    changed: dict[str, Any] = {sensor: replace(getattr(imu, sensor), **changes) for sensor in sensors}
    return replace(imu, **changed)


COLUMNS = ("", "real IMU", "emulator", "ours", "expected", "ours off", "emulator off")


def text(imu: ImuParameters, rows: Sequence[AxisRow], found: Sequence[Interpretation], samples: int, seed: int) -> str:
    """Format the table as text, with the deviations from the expected values in standard errors.

    imu: the parameters with which the values were reproduced.
    rows: the rows of the table for these parameters (`static_table`).
    found: interpretations of the dissertation's parameters (`readings`), which are listed below the table with their
        differences from the published means; none if empty.
    samples, seed: the number of samples from which the values were reproduced, and the seed of their noise.
    """
    lines = [
        f"At rest, {samples} samples, seed {seed}; published (Table 5.1) {SAMPLES} at {RATE} Hz.",
        "off: difference to the expectation, in standard errors, of figures with four",
        "decimals where printed.",
    ]
    for name, form in (("mean", ".4f"), ("three_sigma", ".4f"), ("variance", ".2e")):
        lines += ["", *_block(name, form, rows)]
    lines += ["", *_gyroscope_variances(imu, rows)]
    if found:
        lines += ["", *_explained(found)]
    return "\n".join(lines)


def _block(name: str, form: str, rows: Sequence[AxisRow]) -> list[str]:
    cells = []
    for row in rows:
        figure: Figure = getattr(row, name)
        cells.append(
            (
                f"{row.sensor} {row.axis}, {_unit(row.sensor, name)}",
                f"{figure.real:.4f}",
                f"{figure.emulator:.4f}",
                f"{figure.ours:{form}}",
                f"{figure.expected:{form}}",
                "-" if figure.ours_off is None else f"{figure.ours_off:+.1f}",
                f"{figure.emulator_off:+.1f}" if figure.emulator else "-",
            )
        )
    return text_table((name.replace("three_", "3 "), *COLUMNS[1:]), cells, range(1, len(COLUMNS)))


def _explained(found: Sequence[Interpretation]) -> Iterator[str]:
    yield "Published emulator's means less those of the model, x, y, z in standard errors,"
    yield "and their root mean square (rms):"
    yield ""
    rows = []
    for reading in found:
        for sensor in SENSORS:
            says = reading.says if sensor == SENSORS[0] else ""
            rows.append((says, sensor, *(f"{off:+.1f}" for off in reading.off[sensor]), f"{reading.rms(sensor):.1f}"))
    yield from text_table(("the model with", "sensor", "x", "y", "z", "rms"), rows, range(2, 6))


def _gyroscope_variances(imu: ImuParameters, rows: Sequence[AxisRow]) -> Iterator[str]:
    """Yield lines that compare the gyroscope's published variances with the expected ones, with and without rounding.

    The gyroscope's noise has a similar size as its LSB, so that rounding has a visible effect on the variances. The
    published variances are calculated from the published 3 sigma, which has more digits.
    """
    three = [row for row in rows if row.sensor == "gyroscope"]
    published_ones = [(row.three_sigma.emulator / 3) ** 2 for row in three]
    expected = [row.variance.expected for row in three]
    unrounded = variances_before_rounding(imu.gyroscope, imu.period) / imu.gyroscope.scale**2
    yield f"gyroscope variances: published {numbers(published_ones, 5)} (by 3 sigma)"
    yield f"  expected with whole LSB    {numbers(expected, 5)}: {_more(expected, published_ones)}"
    yield f"  expected before rounding   {numbers(unrounded, 5)}: {_more(unrounded, published_ones)}"


def _more(values: Iterable[float], than: Iterable[float]) -> str:
    return ", ".join(f"{100 * (value / other - 1):+.0f} %" for value, other in zip(values, than, strict=True))


def numbers(values: Iterable[float], decimals: int) -> str:
    """Format numbers with this number of decimals, separated by commas."""
    return ", ".join(f"{value:.{decimals}f}" for value in values)


def _unit(sensor: str, figure: str) -> str:
    unit = UNITS[sensor]
    if figure != "variance":
        return unit
    return f"({unit})^2" if "/" in unit else f"{unit}^2"
