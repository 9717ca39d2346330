"""A validation error goes in; one sentence with file, line, key, what was found and the way out comes out."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ValidationError

from ...core.suggest import did_you_mean
from ...timing.budget_schema import Budget, Condition
from .device_tables import DeviceFault, StretchTable
from .model import BadCase, Case, ChipTable, Code, Controller, HostTable, Options, RequestTable, Unit, ValueTable
from .origin import Source, key_of
from .serial import ExpectTable, SendTable, SerialTable
from .transceiver import TransceiverTable
from .wiring import Cable

SHOWN = 60  # characters of a wrong value that a message repeats
EXPECTED = {"model_type": "expected a table", "dict_type": "expected a table", "tuple_type": "expected a list"}


def explain(source: Source, error: ValidationError, tree: object = None) -> str:
    """One sentence about the first thing wrong. tree: what was to be a case, for the names of its entries."""
    wrong = error.errors()
    first = next((one for one in wrong if one["type"] == "extra_forbidden"), wrong[0])  # a misspelt key is missing, too
    place = place_of(first)
    key = key_of(place, tree)
    where = source.where(place)
    if first["type"] == "extra_forbidden":
        return f"{where}: there is no key {key!r}; {did_you_mean(str(place[-1]), known_keys(place[:-1]))}"
    if first["type"] == "missing":
        return f"{where}: {key} is missing"
    return f"{where}: {key or 'the case'}: {complaint(first)}"


def place_of(first: Any) -> tuple[str | int, ...]:
    """Keys and numbers that lead to a wrong value, without the checks that pydantic counts among them."""
    return tuple(part for part in first["loc"] if isinstance(part, int) or not part.startswith("function-"))


def complaint(first: Any) -> str:
    """What is wrong with a value, and what it is: one entry of `ValidationError.errors()` as a phrase."""
    if first["type"] in ("missing", "missing_argument"):
        return "it is missing"
    message = EXPECTED.get(first["type"]) or str(first["msg"]).removeprefix("Value error, ")
    found = repr(first.get("input"))
    about_a_table = first["type"] == "value_error" and isinstance(first.get("input"), dict)
    has_a_place = isinstance(first.get("ctx", {}).get("error"), BadCase)  # of a file that the value names
    told = found in message or "but it is" in message or has_a_place
    if not told and len(found) <= SHOWN and not about_a_table:
        message = f"{message[0].lower()}{message[1:]}, but it is {found}"
    return message


def known_keys(place: tuple[str | int, ...]) -> list[str]:
    """The keys of the table at a place in a case."""
    tables: dict[str, type[BaseModel]] = {
        "unit": Unit,
        "cable": Cable,
        "transceiver": TransceiverTable,
        "controller": Controller,
        "host": HostTable,
        "serial": SerialTable,
        "send": SendTable,
        "expect": ExpectTable,
        "chip": ChipTable,
        "values": ValueTable,
        "stretch": StretchTable,
        "fault": DeviceFault,
        "budget": Budget,
        "request": RequestTable,
        "options": Options,
        "code": Code,
        "and": Condition,
    }
    for part in reversed(place):
        if isinstance(part, str) and part in tables:
            return [field.alias or name for name, field in tables[part].model_fields.items()]
    return list(Case.model_fields)
