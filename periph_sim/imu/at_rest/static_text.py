"""Table 5.1 and the readings as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ...core.text_table import text_table
from ..models.parameters import ImuParameters
from . import published
from .readings import Reading
from .rest import SENSORS, UNITS, variances_before_rounding
from .static_table import AxisRow, Figure

COLUMNS = ("", "real IMU", "emulator", "ours", "expected", "ours off", "emulator off")


def text(imu: ImuParameters, rows: Sequence[AxisRow], found: Sequence[Reading], samples: int, seed: int) -> str:
    """Format the table of this set, deviations in standard errors (se), and the readings `found`, if any."""
    lines = [
        f"At rest, {samples} samples, seed {seed}; published (Table 5.1) {published.SAMPLES} at {published.RATE} Hz.",
        "off: difference to the expectation, in standard errors, of figures with four",
        "decimals where printed.",
    ]
    for title, name, form in (
        ("mean", "mean", ".4f"),
        ("3 sigma", "three_sigma", ".4f"),
        ("variance", "variance", ".2e"),
    ):
        lines += ["", *_block(title, name, form, rows)]
    lines += ["", *_gyroscope_variances(imu, rows)]
    if found:
        lines += ["", *_explained(found)]
    return "\n".join(lines)


def _block(title: str, name: str, form: str, rows: Sequence[AxisRow]) -> list[str]:
    cells = []
    for row in rows:
        figure: Figure = getattr(row, name)
        printed = form if name != "variance" else ".4f"
        cells.append(
            (
                f"{row.sensor} {row.axis}, {_unit(row.sensor, name)}",
                f"{figure.real:{printed}}",
                f"{figure.emulator:{printed}}",
                f"{figure.ours:{form}}",
                f"{figure.expected:{form}}",
                "-" if figure.ours_off is None else f"{figure.ours_off:+.1f}",
                f"{figure.emulator_off:+.1f}" if figure.emulator else "-",
            )
        )
    return text_table((title, *COLUMNS[1:]), cells, range(1, len(COLUMNS)))


def _explained(found: Sequence[Reading]) -> Iterator[str]:
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
    """Compare gyroscope variances, published ones from 3 sigma: LSB and noise are similar, so rounding shows."""
    three = [row for row in rows if row.sensor == "gyroscope"]
    published_ones = [(row.three_sigma.emulator / 3) ** 2 for row in three]
    expected = [row.variance.expected for row in three]
    unrounded = variances_before_rounding(imu.gyroscope, imu.period) / imu.gyroscope.scale**2
    yield f"gyroscope variances: published {_three(published_ones)} (by 3 sigma)"
    yield f"  expected with whole LSB    {_three(expected)}: {_more(expected, published_ones)}"
    yield f"  expected before rounding   {_three(unrounded)}: {_more(unrounded, published_ones)}"


def _more(values: Iterable[float], than: Iterable[float]) -> str:
    return ", ".join(f"{100 * (value / other - 1):+.0f} %" for value, other in zip(values, than, strict=True))


def _three(values: Iterable[float]) -> str:
    return ", ".join(f"{value:.5f}" for value in values)


def _unit(sensor: str, figure: str) -> str:
    unit = UNITS[sensor]
    if figure != "variance":
        return unit
    return f"({unit})^2" if "/" in unit else f"{unit}^2"
