"""A recorded flight from a CSV file, interpolated linearly between rows. Angles are interpolated the shorter way round.

    time [s],phi [deg],theta [deg],psi [deg],ax [g],ay [g],az [m/s^2]

Angles are in rad, deg or mrad, and accelerations in g, mg or m/s^2. The columns may be in any order, and other columns
are ignored. Angles are returned from -180 (not included) to 180 degrees, even if the file uses another range. The first
row is at time 0 of the motion. After the last row, the values of the last row remain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, pi
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...core.phrases import did_you_mean
from ...traces.formats.unit_csv import Column, line_of_row, read
from . import ACCELERATIONS, ANGLES, BadMotion
from .pieces import Straight
from .quantities import ACCELERATION_RANGE, ACCELERATION_UNITS, ANGLE_RANGE, ANGLE_UNITS, TIME_UNITS, shown


@dataclass(frozen=True)
class Settings:
    """The settings of a flight. file: the path of the file, relative to the current directory."""

    file: Path


class Flight(Straight):
    """A recorded motion. The rows have angles without jumps; `at` wraps them to -180 (not included) to 180 degrees."""

    def at(self, seconds: float) -> Sequence[float]:
        *angles, x, y, z = super().at(seconds)
        return [*(angle - 2 * pi * ceil((angle - pi) / (2 * pi)) for angle in angles), x, y, z]


def motion(settings: Settings) -> Flight:
    """Read a flight from a file. Raise BadCapture or BadMotion, with file and normally line, if it is invalid."""
    path = settings.file
    columns = {column.name: column for column in read(path)}
    times = _values(path, columns, "time", TIME_UNITS)
    late = np.flatnonzero(np.diff(times) <= 0)
    if len(late):
        row = int(late[0]) + 1
        raise _bad(path, row, f"time is {times[row]:.9g} s", f"more than {times[row - 1]:.9g} s, the row before")
    values = np.stack(
        [_values(path, columns, name, ANGLE_UNITS, ANGLE_RANGE) for name in ANGLES]
        + [_values(path, columns, name, ACCELERATION_UNITS, ACCELERATION_RANGE) for name in ACCELERATIONS],
        axis=1,
    )
    values[:, :3] = np.unwrap(values[:, :3], axis=0)
    return Flight((times - times[0]).tolist(), values.tolist())


def _values(
    path: Path, columns: Mapping[str, Column], name: str, units: Mapping[str, float], limit: float | None = None
) -> NDArray[np.float64]:
    if name not in columns:
        raise BadMotion(
            f"{path}, line 1: there is no column {name!r} among {len(columns)}; {did_you_mean(name, columns)}"
        )
    column = columns[name]
    if column.unit not in units:
        raise BadMotion(f"{path}, line 1: the unit of {name} is {column.unit!r}; expected {' or '.join(units)}")
    values: NDArray[np.float64] = column.values * units[column.unit]
    if limit is not None:
        beyond = np.flatnonzero(np.abs(values) > limit)
        if len(beyond):
            row = int(beyond[0])
            found = f"{name} is {column.values[row]:.6g} {column.unit}"
            raise _bad(path, row, found, shown(limit / units[column.unit], column.unit))
    return values


def _bad(path: Path, row: int, found: str, expected: str) -> BadMotion:
    return BadMotion(f"{path}, line {line_of_row(path, row)}: {found}; expected {expected}")
