"""Parameters of an IMU from the identified columns of a recording. A column is named after its sensor and axis.

    gyroscope_x, _y, _z [deg/s] --> three means ------> cross-axis sensitivity removed ---> bias
                                --> three densities --> density of rounding subtracted --> noise_density

With these parameters, the models have the same means at rest as the recording. The part of gravity that cross-axis
sensitivity adds to other axes is not counted as bias.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from ..identification.identify import Identified
from ..models.parameters import ImuParameters
from ..models.quantity import BadParameter, Vector
from ..noise import AXES
from .rest import SENSORS, UNITS, Sensor

GRAVITY = np.array([0.0, 0.0, -1.0])  # output of an ideal level accelerometer at rest in g (section 4.3.4)


def parameters_of_axes(axes: Mapping[str, Identified], hard_iron: bool) -> ImuParameters:
    """Return the parameter set of Table 4.1, updated with the identified columns of a recording.

    The magnetometer's mean minus its hard iron becomes the earth field. A slow term of the noise (bias instability or
    random walk) that does not differ significantly from 0 becomes 0.

    axes: the identified parameters of each column, by the name of the column, such as "gyroscope_x".
    hard_iron: True if the magnetometer's bias is the difference from a recording without the disturbance, so that the
        bias is the hard iron. False to keep the hard iron of Table 4.1.

    Raise BadParameter if a column belongs to no sensor, an axis is missing, a unit differs from that of the model, or
    an identified value is out of the range of its parameter.
    """
    imu = ImuParameters()
    wanted = {f"{sensor}_{axis}": sensor for sensor in SENSORS for axis in AXES}
    for name in axes:
        if name not in wanted:
            raise BadParameter(name, f"it is not a column of a sensor model; expected {', '.join(wanted)}")
    for sensor in dict.fromkeys(wanted[name] for name in axes):
        three = []
        for axis in AXES:
            name = f"{sensor}_{axis}"
            if name not in axes:
                raise BadParameter(name, f"it is missing; a set needs all three axes of the {sensor}")
            if axes[name].unit != UNITS[sensor]:
                raise BadParameter(name, f"its unit is {axes[name].unit!r}; expected {UNITS[sensor]!r}")
            three.append(axes[name])
        changes: dict[str, Any] = {sensor: _identified(sensor, getattr(imu, sensor), three, hard_iron)}
        imu = replace(imu, **changes)
    return imu


def _identified(name: str, sensor: Any, three: list[Identified], hard_iron: bool) -> Sensor:
    matrix = np.array(sensor.matrix) / sensor.scale
    felt = np.linalg.solve(matrix, [axis.series.samples.mean() for axis in three])
    changes: dict[str, Vector] = {"noise_density": _vector([axis.sensor_density for axis in three])}
    if name == "accelerometer":
        changes["bias"] = _vector(felt - GRAVITY)
    elif name == "gyroscope":
        changes["bias"] = _vector(felt)
    else:
        iron = np.array(sensor.hard_iron)
        if hard_iron:
            iron = np.linalg.solve(matrix, [axis.bias.value for axis in three])
            changes["hard_iron"] = _vector(iron)
        changes["earth_field"] = _vector(felt - iron)
    slow = [axis.slow for axis in three]
    terms = [one for one in slow if one is not None]
    if terms:
        for key in ("bias_instability", "random_walk"):
            found = [getattr(one, key) for one in terms]
            changes[key] = _vector([term.value if term.found else 0.0 for term in found])
    identified: Sensor = replace(sensor, **changes)
    return identified


def _vector(values: list[float] | NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
