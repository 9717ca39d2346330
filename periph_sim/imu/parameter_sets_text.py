"""Sensor parameters as TOML text, which `parameter_sets.load` reads back to the last bit."""

from __future__ import annotations

from typing import Any

from .models.parameters import ImuParameters
from .models.quantity import Checked, Parameter, Quantity, parameters_of


def text_of(imu: ImuParameters) -> str:
    """Return the text of all parameters: those of the whole set first, then a table for each sensor."""
    parts = parameters_of(ImuParameters)
    lines = [_line(imu, one) for one in parts if one.says is not None]
    for one in parts:
        if one.says is None:
            sensor = getattr(imu, one.name)
            lines += ["", f"[{one.name}]", *(_line(sensor, inner) for inner in parameters_of(type(sensor)))]
    return "\n".join([*lines, ""])


def _line(given: Checked, parameter: Parameter) -> str:
    return f"{parameter.name} = {_said(parameter, getattr(given, parameter.name))}"


def _said(parameter: Parameter, value: Any) -> str:
    if not isinstance(parameter.says, Quantity):
        return f'"{value}"'
    if parameter.kind is int:
        return str(value)
    numbers = ", ".join(repr(float(one)) for one in (value if isinstance(value, tuple) else (value,)))
    if parameter.says.unit:
        return f'"{numbers} {parameter.says.unit}"'
    return f"[{numbers}]" if isinstance(value, tuple) else numbers
