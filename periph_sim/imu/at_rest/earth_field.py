"""Earth field of the dissertation's laboratory, from Table 5.1, Table 4.1 and section 5.2.

    m = H_rt + d V --> d --> H_rt --> x, y, z at a yaw of 270, 180, 90, 0 degrees

    m       mean of the real magnetometer, level and pointing north (Table 5.1)
    H_rt    earth field in the axes of a level body that points north
    V       hard iron (Table 4.1)
    d       1 if m includes the hard iron, else 0; Table 5.1 does not state which

Section 5.2 has two statements that determine d. For the turn about z (Figure 5.1), the section says that y is
approximately the bias at 0 and 180 degrees, so the field has hardly any y component. The section also says that the
field is nearly horizontal, so the field has hardly any z component. Each statement gives a value of d by least squares:

    y: (m_y - d V_y)^2 is least at d = m_y / V_y        z: d = m_z / V_z

Both values are below 0, and so nearer to 0 than to 1: the mean is the undisturbed field.

Equation 4.10 agrees: the hard iron is the mean measured near iron minus the undisturbed mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, degrees, radians

import numpy as np

from ...core.text_table import text_table
from ..models.parameters import ImuParameters, MagnetometerParameters
from ..models.quantity import Vector
from .rest import Floats, lsb_at_rest
from .static_table import REAL, numbers

MEAN = REAL["magnetometer"].mean
HARD_IRON = MagnetometerParameters().hard_iron
YAWS = (270, 180, 90, 0)  # yaws of the turn in degrees, in the order of Figure 5.1


@dataclass(frozen=True)
class Fit:
    """The earth field H_rt for d = 0 and d = 1, and the values of d by least squares (see the head of this module).

    along_y, along_z: the values of d that follow from the statements of section 5.2 about y and about z.
    fields: the field H_rt in gauss for d = 0 (the mean is undisturbed) and for d = 1 (it includes the hard iron).
    """

    along_y: float
    along_z: float
    fields: tuple[Vector, Vector]

    @property
    def disturbed(self) -> bool:
        """True if the mean of `along_y` and `along_z` is nearer to d = 1 than to d = 0."""
        return self.along_y + self.along_z > 1

    @property
    def field(self) -> Vector:
        """The field H_rt in gauss for the value of d, 0 or 1, that fits the statements of section 5.2 better."""
        return self.fields[self.disturbed]


def off_north(field: Vector) -> float:
    """Return the angle in degrees from the x axis to the horizontal part of a field, positive toward y."""
    return degrees(atan2(field[1], field[0]))


def fit(mean: Vector = MEAN, hard_iron: Vector = HARD_IRON) -> Fit:
    """Determine the earth field for d = 0 and d = 1, and d by least squares (see the head of this module).

    mean: the mean m of the magnetometer at rest, as x, y, z in gauss.
    hard_iron: the hard iron V, as x, y, z in gauss.
    """
    along_y, along_z = (mean[axis] / hard_iron[axis] for axis in (1, 2))
    x, y, z = (m - v for m, v in zip(mean, hard_iron, strict=True))
    return Fit(along_y, along_z, (mean, (x, y, z)))


def turn(imu: ImuParameters, yaws: tuple[int, ...] = YAWS) -> Floats:
    """Return the values that the magnetometer of a level body measures at each yaw, in gauss, float64[n, 3].

    The values include the hard iron and the limits of the converter, but no noise and no rounding.

    yaws: the yaws in degrees.
    """
    fields = [lsb_at_rest(imu, (0.0, 0.0, radians(yaw)))["magnetometer"] for yaw in yaws]
    return np.array(fields).clip(*imu.magnetometer.limits) / imu.magnetometer.scale


def text(imu: ImuParameters, found: Fit) -> str:
    """Format the earth field, and a table of the magnetometer's values at the yaws of Figure 5.1 (see `turn`).

    imu: the parameters of the magnetometer in the table.
    found: the result of `fit`.
    """
    ys, zs = ([f"{abs(field[axis]):.4f}" for field in found.fields] for axis in (1, 2))
    says = [
        ("y at 0 and 180 is about the bias: |Hy|", *ys, f"d = {found.along_y:.2f}"),
        ("the field is nearly horizontal: |Hz|", *zs, f"d = {found.along_z:.2f}"),
        ("x points north: degrees between x and H", *(f"{abs(off_north(field)):.1f}" for field in found.fields), ""),
    ]
    turned = [
        (str(yaw), *(f"{value:.4f}" for value in row), f"{row[1] - imu.magnetometer.hard_iron[1]:.4f}")
        for yaw, row in zip(YAWS, turn(imu), strict=True)
    ]
    lines = [
        f"Earth field H from Table 5.1's real mean {numbers(MEAN, 4)} gauss",
        "= H + d V, V the hard iron of Table 4.1",
        "",
        *text_table(("section 5.2 says", "d = 0", "d = 1", "least squares"), says, range(1, 4)),
        "",
        f"result: d = {int(found.disturbed)}, H = ({numbers(found.field, 4)}) gauss",
        "",
        f"Turn about z as in Figure 5.1, with hard iron {numbers(imu.magnetometer.hard_iron, 4)} gauss",
        "",
        *text_table(("yaw", "x", "y", "z", "y less the bias"), turned, range(5)),
    ]
    return "\n".join(lines)
