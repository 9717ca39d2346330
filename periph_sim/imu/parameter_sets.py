"""Sets of sensor parameters, loaded from TOML and checked, and written as TOML.

    period = "20 ms"                      [gyroscope]
    wrap = "unwrapped"                    bias = "-3.1, 3.6, 0.04 deg/s"

Keys that a file does not contain have the defaults in `models.parameters`, which are those of the dissertation's Table
4.1 if it has a value. A unit is written after a number, or after the last number of a vector. A number without a unit
is accepted only for parameters that have no unit or are whole numbers. Sets that come with periph_sim (in
`models/sets`) are loaded by name.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

from ..core.phrases import did_you_mean
from ..scene.case.model import BadCase
from ..scene.case.origin import Place, Source
from ..scene.case.toml_file import read
from .models.parameters import STANDARD_GRAVITY, ImuParameters
from .models.quantity import BadParameter, Checked, Parameter, Quantity, Vector, parameters_of

C = TypeVar("C", bound=Checked)

# For each unit of a parameter: the other units that are accepted, each with the factor that converts it to this unit.
OTHERS: dict[str, dict[str, float]] = {
    "s": {"ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "m": {"cm": 1e-2, "mm": 1e-3},
    "g": {"mg": 1e-3, "m/s^2": 1 / STANDARD_GRAVITY},
    "gauss": {"mgauss": 1e-3, "uT": 1e-2, "nT": 1e-5},
    "": {"%": 1e-2},
}


SHIPPED = Path(__file__).parent / "models" / "sets"


def named(name: str) -> ImuParameters:
    """Return the parameters of the shipped set with this name, such as "table_5_1", or of the file with this path.

    Raise BadCase if neither exists, or the file is invalid.
    """
    shipped = {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}
    if name in shipped:
        return load(shipped[name])
    if not Path(name).suffix and not Path(name).exists():
        known = ", ".join(shipped)
        raise BadCase(f"there is no parameter set {name!r}; give the path of a TOML file, or a shipped set: {known}")
    return load(Path(name))


def load(path: Path) -> ImuParameters:
    """Return the parameters in a file.

    Raise BadCase if the file cannot be read, or if a parameter is unknown or invalid. For an invalid number, the
    message has file, line, name, value and range.
    """
    text, tree = read(path, "parameter")
    return _set(Source(path, text), (), ImuParameters, tree)


def _set(source: Source, place: Place, kind: type[C], table: Any) -> C:
    if not isinstance(table, dict):
        raise _wrong(source, place, f"expected a table, but it is {table!r}")
    known = {one.name: one for one in parameters_of(kind)}
    for name in table:
        if name not in known:
            key = ".".join(str(part) for part in (*place, name))
            raise BadCase(f"{source.where((*place, name))}: there is no parameter {key!r}; {did_you_mean(name, known)}")
    given = {name: _value(source, (*place, name), known[name], value) for name, value in table.items()}
    try:
        return kind(**given)
    except BadParameter as error:
        _, key, *inside = error.name.split(".")
        raise _wrong(source, (*place, key), error.what, inside) from None


def _value(source: Source, place: Place, parameter: Parameter, value: Any) -> Any:
    says = parameter.says
    if says is None:
        return _set(source, place, parameter.kind, value)
    if not isinstance(says, Quantity):
        return value
    try:
        numbers, factor = _numbers(value, says.unit, bare=parameter.kind is int or not says.unit)
    except ValueError as error:
        raise _wrong(source, place, f"{error}; expected {_expected(parameter, says)}") from None
    if parameter.kind == Vector:
        return tuple(number * factor for number in numbers)
    if len(numbers) != 1:
        raise _wrong(source, place, f"{value!r} is {len(numbers)} numbers; expected {_expected(parameter, says)}")
    return int(numbers[0]) if parameter.kind is int and numbers[0].is_integer() else numbers[0] * factor


def _numbers(value: Any, unit: str, bare: bool) -> tuple[list[float], float]:
    """Parse the value of a key. Return its numbers, and the factor that converts them to `unit`.

    value: a text such as "-3.1, 3.6, 0.04 deg/s", a number, or a list of numbers.
    bare: True if numbers without a unit are accepted.

    Raise ValueError, whose message is a phrase, if a number or the unit is invalid.
    """
    if isinstance(value, str):
        *numbers, last = [part.strip() for part in value.split(",")]
        number, _, said = last.partition(" ")
        factor = 1.0 if said.strip() == unit else OTHERS.get(unit, {}).get(said.strip())
        if factor is None:
            raise ValueError(f"{value!r} has the unit {said.strip()!r}" if said else f"{value!r} has no unit")
        try:
            return [float(one) for one in (*numbers, number)], factor
        except ValueError:
            raise ValueError(f"{value!r} is not a number") from None
    entries = value if isinstance(value, list) else [value]
    if not all(isinstance(one, int | float) and not isinstance(one, bool) for one in entries):
        raise ValueError(f"{value!r} is not a number")
    if not bare:
        raise ValueError(f"{value!r} has no unit")
    try:
        return [float(one) for one in entries], 1.0
    except OverflowError:
        raise ValueError("it is too large a number") from None


def _expected(parameter: Parameter, says: Quantity) -> str:
    units = " or ".join(unit for unit in (says.unit, *OTHERS.get(says.unit, {})) if unit)
    numbers = "three numbers" if parameter.kind == Vector else "a number"
    return f"{numbers}{f' in {units}' if units else ''}, {says.span}"


def _wrong(source: Source, place: Place, what: str, inside: list[str] | None = None) -> BadCase:
    key = ".".join(str(part) for part in (*place, *(inside or [])))
    return BadCase(f"{source.where(place)}: {key}: {what}")


def text_of(imu: ImuParameters) -> str:
    """Format all parameters as TOML, first those that belong to no sensor. `load` reads exactly these values back."""
    parts = parameters_of(ImuParameters)
    lines = [_line(imu, one) for one in parts if one.says is not None]
    for one in parts:
        if one.says is None:
            sensor: Checked = getattr(imu, one.name)
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
