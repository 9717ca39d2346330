"""A validation error goes in; one sentence with file, line, key, what was found and the way out comes out."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from ..core.nearest import near
from .model import Budget, Case, Controller, HostTable, Options, RequestTable, Table, Unit
from .source import Source

SHOWN = 60  # characters of a wrong value that a message repeats
EXPECTED = {"model_type": "expected a table", "dict_type": "expected a table", "tuple_type": "expected a list"}


def explain(source: Source, error: ValidationError) -> str:
    """One sentence about the first thing wrong."""
    first = error.errors()[0]
    place = tuple(part for part in first["loc"] if isinstance(part, int) or not part.startswith("function-"))
    key = ".".join(str(part) for part in place)
    where = source.where(place)
    if first["type"] == "extra_forbidden":
        return f"{where}: there is no key {key!r}; {near(str(place[-1]), known_keys(place[:-1]))}"
    if first["type"] == "missing":
        return f"{where}: {key} is missing"
    return f"{where}: {key or 'the case'}: {complaint(first)}"


def complaint(first: Any) -> str:
    """What is wrong with a value, and what it is: one entry of `ValidationError.errors()` as a phrase."""
    if first["type"] in ("missing", "missing_argument"):
        return "it is missing"
    message = EXPECTED.get(first["type"]) or str(first["msg"]).removeprefix("Value error, ")
    found = repr(first.get("input"))
    about_a_table = first["type"] == "value_error" and isinstance(first.get("input"), dict)
    if found not in message and len(found) <= SHOWN and not about_a_table:
        message = f"{message[0].lower()}{message[1:]}, but it is {found}"
    return message


def known_keys(place: tuple[str | int, ...]) -> list[str]:
    """The keys of the table at a place in a case."""
    tables: dict[str, type[Table]] = {
        "unit": Unit,
        "controller": Controller,
        "host": HostTable,
        "budget": Budget,
        "request": RequestTable,
        "options": Options,
    }
    for part in reversed(place):
        if isinstance(part, str) and part in tables:
            return list(tables[part].model_fields)
    return list(Case.model_fields)
