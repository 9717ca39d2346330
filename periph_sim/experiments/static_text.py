"""Table 5.1 again, as text: its rows and the readings go in, lines for people come out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ..devices.models.parameters import Imu
from . import published
from .readings import Reading
from .rest import SENSORS, UNITS, variances_before_rounding
from .static_table import AxisRow, Figure

COLUMNS = ("", "real IMU", "emulator", "ours", "expected", "ours off", "emulator off")


def text(imu: Imu, rows: Sequence[AxisRow], told: Sequence[Reading], samples: int, seed: int) -> str:
    """The table of this set, deviations in standard errors (se), and what explains the published means."""
    lines = [
        f"At rest, {samples} samples, seed {seed}; published (Table 5.1) {published.SAMPLES} at {published.RATE} Hz.",
        "off: less what the model expects, in standard errors (se), of figures with four decimals where printed.",
    ]
    for title, name, form in (
        ("mean", "mean", ".4f"),
        ("3 sigma", "three_sigma", ".4f"),
        ("variance", "variance", ".2e"),
    ):
        lines += ["", *_block(title, name, form, rows)]
    lines += ["", *_explained(told), *_without_rounding(imu, rows)]
    return "\n".join(lines)


def _block(title: str, name: str, form: str, rows: Sequence[AxisRow]) -> Iterator[str]:
    yield _line((title, *COLUMNS[1:]))
    for row in rows:
        figure: Figure = getattr(row, name)
        printed = form if name != "variance" else ".4f"
        yield _line(
            (
                f"{row.sensor} {row.axis}, {_unit(row.sensor, name)}",
                f"{figure.real:{printed}}",
                f"{figure.emulator:{printed}}",
                f"{figure.ours:{form}}",
                f"{figure.expected:{form}}",
                "-" if figure.ours_off is None else f"{figure.ours_off:+.1f} se",
                f"{figure.emulator_off:+.1f} se" if figure.emulator else "-",
            )
        )


def _explained(told: Sequence[Reading]) -> Iterator[str]:
    yield "Published emulator's means less those of the model, x, y, z in se, and their root mean square:"
    yield ""
    yield _wide(("the model with", *SENSORS))
    for reading in told:
        cells = (
            f"{' '.join(f'{off:+.1f}' for off in reading.off[sensor])}  ({reading.rms(sensor):.1f})"
            for sensor in SENSORS
        )
        yield _wide((reading.says, *cells))
    yield ""
    for sensor in SENSORS:
        best = min(told, key=lambda reading: reading.rms(sensor))
        yield f"{sensor}: nearest with what ends on {best.says!r}, {best.rms(sensor):.1f} se"


def _without_rounding(imu: Imu, rows: Sequence[AxisRow]) -> Iterator[str]:
    """The gyroscope's LSB is of the size of its noise, so variances show whether values were rounded."""
    three = [row.variance for row in rows if row.sensor == "gyroscope"]
    unrounded = variances_before_rounding(imu.gyroscope, imu.period) / imu.gyroscope.scale**2
    yield (
        f"gyroscope variances: published {_three(f.emulator for f in three)}, "
        f"expected {_three(f.expected for f in three)},"
    )
    yield f"without rounding to whole LSB {_three(unrounded)}"


def _three(values: Iterable[float]) -> str:
    x, y, z = (f"{value:.4f}" for value in values)
    return f"{x}, {y} and {z}"


def _unit(sensor: str, figure: str) -> str:
    unit = UNITS[sensor]
    if figure != "variance":
        return unit
    return f"({unit})^2" if "/" in unit else f"{unit}^2"


def _line(cells: Sequence[str]) -> str:
    return f"{cells[0]:<22}" + "".join(f"{cell:>13}" for cell in cells[1:])


def _wide(cells: Sequence[str]) -> str:
    return f"{cells[0]:<28}" + "".join(f"{cell:>27}" for cell in cells[1:])
