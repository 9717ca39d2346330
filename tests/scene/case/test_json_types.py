"""The schema of a table, type by type: what editors are told of each key."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from msgspec import Meta, field

from periph_sim.core.convert import Before
from periph_sim.core.settings import Duration
from periph_sim.core.table import Table
from periph_sim.scene.case.json_types import schema_of, schema_of_table

NUMBER = {"anyOf": [{"type": "integer"}, {"type": "number"}, {"type": "string"}]}


class Inner(Table, frozen=True, kw_only=True):
    """A table inside another one."""

    size: int
    inner: Inner | None = None  # type: ignore[name-defined]


class Outer(Table, frozen=True, kw_only=True):
    OTHERS = "own"

    address: Annotated[int, Meta(ge=0, le=0x7F)] = 3
    inner: Inner = field(name="in")
    text: Annotated[str, Meta(pattern="^a")] = "abc"
    wrong: Annotated[str, Meta(pattern="^a")] = "bcd"
    share: Fraction = Fraction(1, 2)
    whole: Fraction = Fraction(4)
    time: Duration = Fraction(2)
    own: dict[str, Any] = {}


@pytest.mark.parametrize(
    ("annotation", "schema"),
    [
        (bool, {"type": "boolean"}),
        (int, {"type": "integer"}),
        (float, {"type": "number"}),
        (str, {"type": "string"}),
        (Path, {"type": "string", "format": "path"}),
        (datetime, {"type": "string", "format": "date-time"}),
        (Fraction, NUMBER),
        (Any, {}),
        (int | None, {"type": "integer"}),
        (int | str, {"anyOf": [{"type": "integer"}, {"type": "string"}]}),
        (Literal["low", "high"], {"type": "string", "enum": ["low", "high"]}),
        (Literal[8, 16], {"type": "integer", "enum": [8, 16]}),
        (
            tuple[int, str],
            {"type": "array", "minItems": 2, "maxItems": 2, "items": [{"type": "integer"}, {"type": "string"}]},
        ),
        (tuple[int, ...], {"type": "array", "items": {"type": "integer"}}),
        (list[str], {"type": "array", "items": {"type": "string"}}),
        (dict[str, int], {"type": "object", "additionalProperties": {"type": "integer"}}),
        (Mapping[str, Any], {"type": "object", "additionalProperties": True}),
        (Annotated[int, Meta(ge=1, le=9)], {"type": "integer", "minimum": 1, "maximum": 9}),
        (Annotated[list[int], Meta(min_length=2)], {"type": "array", "items": {"type": "integer"}, "minItems": 2}),
        (Annotated[str, Meta(ge=1)], {"type": "string"}),  # the limit is of the number that the text names
        (Annotated[str, Meta(pattern="^a", examples=["a"])], {"type": "string", "pattern": "^a", "examples": ["a"]}),
        (Annotated[int, Before(int, int | str)], {"anyOf": [{"type": "integer"}, {"type": "string"}]}),
        (Annotated[int, Before(int)], {"type": "integer"}),
    ],
)
def test_the_schema_of_a_type(annotation: object, schema: dict[str, Any]):
    definitions: dict[str, Any] = {}
    assert schema_of(annotation, definitions) == schema and definitions == {}


def test_a_table_is_defined_once_and_may_be_in_itself():
    definitions: dict[str, Any] = {}
    assert schema_of(Inner, definitions) == schema_of(Inner, definitions) == {"$ref": "#/$defs/Inner"}
    assert definitions == {
        "Inner": {
            "type": "object",
            "properties": {"size": {"type": "integer"}, "inner": {"$ref": "#/$defs/Inner"}},
            "additionalProperties": False,
            "description": "A table inside another one.",
            "required": ["size"],
        }
    }


def test_the_keys_of_a_table_have_their_names_limits_and_defaults():
    made = schema_of_table(Outer, {})
    assert made["additionalProperties"] is True and made["required"] == ["in"]
    keys = made["properties"]
    assert keys["address"] == {"type": "integer", "minimum": 0, "maximum": 0x7F, "default": 3}
    assert keys["in"] == {"$ref": "#/$defs/Inner"}
    assert keys["text"]["default"] == "abc" and "default" not in keys["wrong"]
    assert keys["whole"] == {**NUMBER, "default": 4} and keys["share"] == NUMBER
    assert "default" not in keys["time"]  # a number is no length of time
