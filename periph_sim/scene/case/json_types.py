"""The JSON schema of types: for each annotation of a table, what a file may contain there, for editors.

    int, Annotated[...], a `Table` ... --schema_of--> {"type": "integer"} ...

Tables inside are written once each, in `definitions`. Only the loader checks what a schema cannot express.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Mapping
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import msgspec

from ...core.convert import Before, Key, is_table, keys_of

Schema = dict[str, Any]

LIMITS = {"ge": "minimum", "le": "maximum", "pattern": "pattern", "examples": "examples"}  # of msgspec.Meta
PLAIN: dict[Any, Schema] = {
    bool: {"type": "boolean"},
    int: {"type": "integer"},
    float: {"type": "number"},
    str: {"type": "string"},
    Path: {"type": "string", "format": "path"},
    datetime: {"type": "string", "format": "date-time"},
    Fraction: {"anyOf": [{"type": "integer"}, {"type": "number"}, {"type": "string"}]},
}


def schema_of(annotation: Any, definitions: Schema) -> Schema:
    """Return the JSON type of what a file may contain for a value of this type."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _annotated(arguments[0], arguments[1:], definitions)
    if origin in (Union, UnionType):
        there = [schema_of(kind, definitions) for kind in arguments if kind is not NoneType]
        return {"anyOf": there} if len(there) > 1 else there[0]
    if origin is Literal:
        return {"type": PLAIN[type(arguments[0])]["type"], "enum": [*arguments]}
    if origin is tuple and arguments[1] is not ...:
        entries = [schema_of(kind, definitions) for kind in arguments]
        return {
            "type": "array",
            "minItems": len(entries),
            "maxItems": len(entries),
            "items": entries,
        }  # as draft 7 says it
    if origin in (tuple, list):
        return {"type": "array", "items": schema_of(arguments[0], definitions)}
    if origin in (dict, Mapping):
        entry = schema_of(arguments[1], definitions)
        return {"type": "object", "additionalProperties": entry or True}
    if is_table(annotation):
        name = annotation.__name__
        if name not in definitions:
            definitions[name] = {}  # a placeholder, since a table may contain itself
            definitions[name] = schema_of_table(annotation, definitions)
        return {"$ref": f"#/$defs/{name}"}
    return {} if annotation in (Any, object) else PLAIN[annotation]


def _annotated(kind: Any, checks: tuple[Any, ...], definitions: Schema) -> Schema:
    said = next((check.said for check in checks if isinstance(check, Before) and check.said is not None), None)
    schema = schema_of(kind if said is None else said, definitions)
    for check in checks:
        if isinstance(check, msgspec.Meta) and "type" in schema:
            limits = {"minItems": check.min_length} if check.min_length is not None else {}
            limits |= {name: getattr(check, of) for of, name in LIMITS.items() if getattr(check, of) is not None}
            fits = schema["type"] != "string" or ("minimum" not in limits and "maximum" not in limits)
            schema = schema | limits if fits else schema  # limits of a text count in what it says
    return schema


def schema_of_table(kind: Any, definitions: Schema) -> Schema:
    """Return the schema of a table: its keys, with the defaults that a file can contain."""
    keys = keys_of(kind)
    properties = {said: _property(key, definitions) for said, key in keys.items()}
    schema: Schema = {
        "type": "object",
        "properties": properties,
        "additionalProperties": bool(getattr(kind, "OTHERS", "")),
    }
    about = inspect.cleandoc(kind.__doc__ or "")
    if about:
        schema["description"] = about
    required = [said for said, key in keys.items() if key.is_required]
    return schema | {"required": required} if required else schema


def _property(key: Key, definitions: Schema) -> Schema:
    schema = schema_of(key.annotation, definitions)
    default = key.default
    if isinstance(default, Fraction) and default.denominator == 1 and "pattern" not in schema:
        default = int(default)
    if default is None or "$ref" in schema:
        return schema
    try:
        told = json.loads(json.dumps(default))
    except TypeError:
        return schema
    texts_only = schema.get("type") == "string"
    pattern = schema.get("pattern")
    if (texts_only and not isinstance(told, str)) or (pattern is not None and re.search(pattern, told) is None):
        return schema
    return {**schema, "default": told}
