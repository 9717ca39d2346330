"""The JSON schema of case files, for editors.

The schema is derived from the tables of `Case`, the kinds of faults, motions, devices and watchers with their settings,
and the options of a unit. The settings of firmware are defined in its source, so the schema allows any keys in the
table `settings`.

    int, Annotated[...], a `Table` ... --schema_of--> {"type": "integer"} ...

The schema of each inner table is stored once, in `definitions`, and referred to by name. Rules that a schema cannot
express are checked only when a case is loaded.
"""

from __future__ import annotations

import dataclasses
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

from ...bus.faults import kinds as kinds_of_fault
from ...core.convert import Before, Key, is_table, keys_of
from ...core.options import allowed
from ...devices.chips import chip_models
from ...devices.host_frames import host_frames
from ...devices.targets import families
from ...devices.watchers import watchers
from ...f28335.parts import part_names
from ...f28335.parts.f28335 import PART
from ..plugins import known
from .model import Case

Schema = dict[str, Any]

# LIMITS maps an attribute of msgspec.Meta to the keyword of a JSON schema with the same meaning.
LIMITS = {"ge": "minimum", "le": "maximum", "pattern": "pattern", "examples": "examples"}
KEY_LINE = re.compile(r"\n(\w+(?:, \w+)*): ")
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
    """Return the schema of the values that a case file may contain for a Python type.

    The schemas of the tables in this type are added to `definitions`.
    """
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
        # This is how draft 7 of JSON Schema describes a list of fixed length with a schema for each entry.
        return {
            "type": "array",
            "minItems": len(entries),
            "maxItems": len(entries),
            "items": entries,
        }
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
            # A schema cannot express numeric limits of a value that is written as a text, such as "10 ms".
            fits = schema["type"] != "string" or ("minimum" not in limits and "maximum" not in limits)
            schema = schema | (limits if fits else {}) | (check.extra_json_schema or {})
    return schema


def schema_of_table(kind: Any, definitions: Schema) -> Schema:
    """Return the schema of a table: its keys, with their defaults where the schema of the key can express them."""
    keys = keys_of(kind)
    about, of_keys = descriptions(kind)
    properties = {said: _property(key, definitions) for said, key in keys.items()}
    for said, what in of_keys.items():
        # In draft 7, other keywords next to "$ref" are ignored, so the reference is put into the list "allOf".
        one = properties[said]
        properties[said] = {"description": what, **({"allOf": [one]} if "$ref" in one else one)}
    schema: Schema = {
        "type": "object",
        "properties": properties,
        "additionalProperties": bool(getattr(kind, "OTHERS", "")),
    }
    if about:
        schema["description"] = about
    required = [said for said, key in keys.items() if key.is_required]
    return schema | {"required": required} if required else schema


def descriptions(kind: type) -> tuple[str, dict[str, str]]:
    """Return the description of a table, and the descriptions of its keys by name, from its class and bases.

    In the docstring of the class, the description of a key is a line such as "low, high: time ...". Indented lines
    continue this description. The description of the table is the text above the first key.
    """
    keys, found, about = keys_of(kind), dict[str, str](), ""
    for base in reversed(kind.__mro__):
        of_table, *lines = KEY_LINE.split("\n" + inspect.cleandoc(vars(base).get("__doc__") or ""))
        about = of_table.strip()
        for names, what in zip(lines[::2], lines[1::2], strict=True):
            found |= dict.fromkeys(names.split(", "), " ".join(what.split()))
    return about, {said: found[said] for said in keys if said in found}


def _property(key: Key, definitions: Schema) -> Schema:
    schema = schema_of(key.annotation, definitions)
    default = key.default
    if isinstance(default, Fraction) and default.denominator == 1 and "pattern" not in schema:
        default = int(default)
    if default is None or "$ref" in schema:
        return schema
    try:
        as_json = json.loads(json.dumps(default))
    except TypeError:
        return schema
    texts_only = schema.get("type") == "string"
    pattern = schema.get("pattern")
    if (texts_only and not isinstance(as_json, str)) or (pattern is not None and re.search(pattern, as_json) is None):
        return schema
    return {**schema, "default": as_json}


DIALECT = "http://json-schema.org/draft-07/schema#"  # the newest draft that editors of TOML support


def case_schema() -> Schema:
    """Return the schema of case files as a tree of dicts and lists, for `json.dumps`."""
    here = Path()  # the current folder; plugins of its project are included in the schema
    faults = {f"fault {name}": kind.Settings for name, kind in known(here, "attach", kinds_of_fault()).items()}
    frames = host_frames()
    motions = {f"motion {name}": settings for name, settings in frames.motion_settings().items()}
    devices = {f"device {family.MODELS[0]}": family for family in known(here, "MODELS", families()).values()}
    settings = {name: family.Settings for name, family in devices.items()}
    watches = {f"watch {name}": family.Settings for name, family in known(here, "KIND", watchers()).items()}
    definitions: Schema = {}
    types: dict[str, Any] = {**faults, **motions, **settings, **watches, "encoding": frames.encoding_type()}
    schemas = {name: schema_of_table(kind, definitions) for name, kind in types.items()}
    case = schema_of_table(Case, definitions)
    case["properties"]["fault"]["items"] = _one_of(faults, schemas)
    host = definitions["HostTable"]["properties"]
    host["motion"] = _one_of(motions, schemas)
    host["encoding"] = schemas["encoding"]
    host["lose"]["items"]["items"][1] = {"type": "integer", "minimum": 0, "maximum": frames.FRAME_BYTES - 1}
    definitions["ChipTable"]["properties"]["model"] = {"enum": [*known(here, "CHIP", chip_models())]}
    device = definitions["DeviceTable"]
    own = [_with_own_keys(device, schemas[name], "model", [*family.MODELS]) for name, family in devices.items()]
    of_file = {"type": "string", "pattern": r"\.py$"}  # the keys that a device of a Python file adds are not known
    definitions["DeviceTable"] = {
        "anyOf": [*own, {**device, "properties": {**device["properties"], "model": of_file}}],
    }
    definitions["WatchTable"] = {
        "anyOf": [
            _with_own_keys(definitions["WatchTable"], schemas[name], "kind", [name.partition(" ")[2]])
            for name in watches
        ]
    }
    options = {name: _options(kind) for name, kind in PART.options_classes().items()}
    definitions["Unit"]["properties"]["part"]["enum"] = [*part_names()]
    definitions["Unit"]["properties"]["options"] = _closed({"type": "object", "properties": options})
    return {"$schema": DIALECT, "title": "periph-sim case", **case, "$defs": definitions}


def _one_of(kinds: Mapping[str, object], schemas: Schema) -> Schema:
    """Return the schema of a table whose key `kind` decides which other keys the table has.

    kinds: the kinds, with the name of the table, such as "fault spike".
    schemas: a dictionary from each of these names to the schema of the keys that only this kind has.
    """
    common = {"properties": {}, "required": ["kind"]}
    choices = [_with_own_keys(common, schemas[name], "kind", [name.partition(" ")[2]]) for name in kinds]
    return {"type": "object", "anyOf": choices}


def _with_own_keys(common: Schema, own: Schema, key: str, values: list[str]) -> Schema:
    """Return the schema of a table with the keys of `common` and `own`, in which `key` has one of `values`."""
    properties = {**common["properties"], **own["properties"], key: {"enum": values}}
    required = [*common["required"], *own.get("required", [])]
    return _closed({**own, **common, "properties": properties, "required": required})


def _closed(schema: Schema) -> Schema:
    return {**schema, "additionalProperties": False}


def _options(kind: type) -> Schema:
    """Return the schema of a table of options. kind: the class whose fields are the options."""
    found: Schema = {}
    for field in dataclasses.fields(kind):
        about = field.metadata
        limits = (
            {"enum": [*about["values"]]}
            if "values" in about
            else {"type": "integer", "minimum": about["least"], "maximum": about["most"]}
        )
        found[field.name] = {
            "description": f"{about['question']} ({allowed(field)})",
            "default": field.default,
            **limits,
        }
    return {"type": "object", "properties": found, "additionalProperties": False}
