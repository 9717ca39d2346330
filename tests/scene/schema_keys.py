"""All keys that a case can have, by their paths, with values to draw for each, taken from the schema.

"controller.request.0.address" --> [{"type": "integer", "minimum": 0, "maximum": 127}] --values--> 0, 1, 127
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from periph_sim import case_schema

Schema = dict[str, Any]

NAMED = "*"  # in a path: a name that the user gives, of a unit, a chip or a setting
TEXTS = ("SCL", "gyroscope", "10 deg", "0.5 Hz", "dsp.SCI-A", "1 us", "nobody")
TYPICAL = {"ns|us": ("1 us", "2.5 ms", "40 us"), "kHz": ("50 kHz", "20 MHz"), "%": ("20 %", "80 %")}


def keys() -> dict[str, list[Schema]]:
    """Return the alternatives of each key's value by its path, in which 0 is any entry of a list of tables."""
    schema = case_schema()
    found: dict[str, list[Schema]] = {}
    _collect(schema, schema, (), found)
    return found


def values(alternatives: list[Schema]) -> list[str]:
    """Return texts that can follow the "=" in a change of the key."""
    found: list[object] = []
    for one in alternatives:
        found += _values(one)
    return [value if isinstance(value, str) else json.dumps(value) for value in found]


def _collect(whole: Schema, schema: Schema, path: tuple[str, ...], found: dict[str, list[Schema]]) -> None:
    for one in _alternatives(whole, schema):
        more = one.get("additionalProperties")
        if "properties" in one or isinstance(more, dict):
            for key, inner in one.get("properties", {}).items():
                _collect(whole, inner, (*path, key), found)
            if isinstance(more, dict):
                _collect(whole, more, (*path, NAMED), found)
        elif one.get("type") == "array" and _has_tables(whole, one.get("items", {})):
            _collect(whole, one["items"], (*path, "0"), found)
        else:
            found.setdefault(".".join(path), []).append(one)


def _has_tables(whole: Schema, items: object) -> bool:
    return isinstance(items, dict) and any("properties" in one for one in _alternatives(whole, items))


def _alternatives(whole: Schema, schema: Schema) -> Iterator[Schema]:
    while "$ref" in schema:
        schema = whole["$defs"][schema["$ref"].rpartition("/")[2]]
    several = schema.get("anyOf") or schema.get("oneOf")
    if several is None:
        yield schema
    else:
        for one in several:
            yield from _alternatives(whole, one)


def _values(schema: Schema) -> list[object]:
    if "enum" in schema:
        return list(schema["enum"])
    kind = schema.get("type")
    if kind == "boolean":
        return [True, False]
    if kind in ("integer", "number"):
        least, most = schema.get("minimum", -3), schema.get("maximum", 1000)
        return [least, min(least + 1, most), min(least + 7, most), most]
    if kind == "array":
        items = schema.get("items", {})
        inner = [_values(one)[0] for one in items] if isinstance(items, list) else (_values(items) or ["nobody"])[:2]
        return [[], [inner] if isinstance(items, list) else inner]
    pattern = str(schema.get("pattern", ""))
    for part, texts in TYPICAL.items():
        if part in pattern:
            return list(texts)
    return ["1d 00", "ff"] if "fA-F" in pattern else list(TEXTS)
