"""Self-describing parameters: frozen structs whose annotations contain unit, range and source.

    bias: Annotated[Vector, Quantity("g", -16, 16, "Table 4.1")] = (-0.02, 0.02, 0.0)

A set of parameters is an object of a class that is derived from `Checked`. It checks its values at construction, and
raises BadParameter, with the parameter, the value and the range, if a value is invalid.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import isfinite
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from msgspec import Struct

from ...core.input_error import InputError

Vector = tuple[float, float, float]  # x, y, z


class BadParameter(InputError):
    """A parameter is invalid.

    name: the name of the parameter, such as "gyroscope.bias".
    what: what was found and expected.
    """

    def __init__(self, name: str, what: str) -> None:
        super().__init__(f"{name}: {what}")
        self.name = name
        self.what = what


class Quantity(Struct, frozen=True):
    """Unit, range and source of a number, or of each number of a vector. low, high: the inclusive limits."""

    unit: str
    low: float
    high: float
    source: str

    @property
    def span(self) -> str:
        return f"{self.low:g} to {self.high:g} {self.unit}".rstrip()


class Choice(Struct, frozen=True):
    """Annotation of a parameter whose value is one of several names. source: the source of its default."""

    source: str


class Parameter(Struct, frozen=True):
    """An entry of a class that is derived from `Checked`, as declared by its annotation.

    kind: the type: Vector, float, int, a Literal, or a class that is derived from `Checked`.
    says: the Quantity or Choice in its annotation; None if the entry is itself a set of parameters.
    """

    name: str
    kind: Any
    says: Quantity | Choice | None


@cache  # reading annotations takes longer than all checks
def parameters_of(kind: type[Checked]) -> tuple[Parameter, ...]:
    """Return all parameters of a class that is derived from `Checked`, in the order of their definition."""
    hints = get_type_hints(kind, include_extras=True)
    found = []
    for name in kind.__struct_fields__:
        annotated = get_origin(hints[name]) is Annotated
        found.append(Parameter(name, *(get_args(hints[name]) if annotated else (hints[name], None))))
    return tuple(found)


class Checked(Struct, frozen=True):
    """Base class of all sets of parameters. The constructor raises BadParameter for an invalid value."""

    def __post_init__(self) -> None:
        for one in parameters_of(type(self)):
            _check(f"{type(self).__name__.removesuffix('Parameters').lower()}.{one.name}", one, getattr(self, one.name))


def _check(name: str, parameter: Parameter, value: Any) -> None:
    kind, says = parameter.kind, parameter.says
    if isinstance(says, Choice):
        if value not in get_args(kind):
            raise BadParameter(name, f"expected one of {', '.join(get_args(kind))}, but it is {value!r}")
    elif kind == Vector:
        if not isinstance(value, tuple) or len(value) != 3:
            found = f"{len(value)}" if isinstance(value, tuple | list) else repr(value)
            raise BadParameter(name, f"expected three numbers x, y, z, but it is {found}")
        for axis, number in zip("xyz", value, strict=True):
            _check_number(f"{name}.{axis}", says, number)
    elif says is not None:
        _check_number(name, says, value, whole=kind is int)
    elif not isinstance(value, kind):
        raise BadParameter(name, f"expected a set of parameters, but it is {value!r}")


def _check_number(name: str, says: Quantity | None, number: object, whole: bool = False) -> None:
    assert says is not None
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise BadParameter(name, f"expected a number, but it is {number!r}")
    if not isfinite(number):
        raise BadParameter(name, f"expected a finite number, {says.span}, but it is {number}")
    if whole and number != int(number):
        raise BadParameter(name, f"expected a whole number, {says.span}, but it is {number:g}")
    if not says.low <= number <= says.high:
        raise BadParameter(name, f"{number:g} {says.unit}".rstrip() + f" is out of range; expected {says.span}")


def described(parameters: Checked) -> Iterator[tuple[str, object, str, str]]:
    """Yield name, value, unit and source of every parameter of a set, such as ("gyroscope.scale", 14.375, ...)."""
    for one in parameters_of(type(parameters)):
        value = getattr(parameters, one.name)
        if isinstance(value, Checked):
            yield from ((f"{one.name}.{name}", inner, unit, why) for name, inner, unit, why in described(value))
        elif one.says is not None:
            yield one.name, value, one.says.unit if isinstance(one.says, Quantity) else "", one.says.source
