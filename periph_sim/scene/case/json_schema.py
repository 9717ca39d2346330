"""The JSON schema of case files, for editors: nothing goes in; what the models of a case take comes out.

All of it is read from the models: the tables of `Case`, the kinds of faults and motions with their settings, and the
options of a unit. What firmware takes as settings only the firmware knows, so that table is left open.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import TypeAdapter

from ...bus.faults import kinds as kinds_of_fault
from ...core.options import allowed
from ...devices.chips import chip_models
from ...devices.targets import Family, families
from ...f28335.i2c.options import I2cOptions
from ...f28335.sci.options import SciOptions
from ...f28335.system.options import SystemOptions
from ...sensors.host_frame import Encoding
from ...sensors.motion import kinds as kinds_of_motion
from .model import Case

DIALECT = "http://json-schema.org/draft-07/schema#"  # editors of TOML know nothing newer
NOT_OF_JSON_SCHEMA = ("title", "ge", "gt", "le", "lt")  # titles repeat the key
OPTIONS = {"i2c": I2cOptions, "sci": SciOptions, "system": SystemOptions}

Schema = dict[str, Any]


def case_schema() -> Schema:
    """The schema as a tree, for `json.dumps`."""
    faults = {f"fault {name}": kind.Settings for name, kind in kinds_of_fault().items()}
    motions = {f"motion {name}": kind.Settings for name, kind in kinds_of_motion().items()}
    devices = {f"device {family.MODELS[0]}": family for family in families().values()}
    settings = {name: family.Settings for name, family in devices.items()}
    types: dict[str, Any] = {"case": Case, **faults, **motions, **settings, "encoding": Encoding}
    adapters = [(name, "validation", TypeAdapter(kind)) for name, kind in types.items()]
    made, rest = TypeAdapter.json_schemas(adapters)  # type: ignore[arg-type]
    schemas = {name: schema for (name, _), schema in made.items()}
    definitions: Schema = rest["$defs"]
    case = _resolved(schemas["case"], definitions)
    case["properties"]["fault"]["items"] = _one_of(faults, schemas, definitions)
    host = definitions["HostTable"]["properties"]
    host["motion"] = _one_of(motions, schemas, definitions)
    host["encoding"] = _closed(_resolved(schemas["encoding"], definitions))
    definitions["ChipTable"]["properties"]["model"] = {"enum": [*chip_models()]}
    definitions["DeviceTable"] = {"anyOf": [*_devices(definitions["DeviceTable"], devices, schemas, definitions)]}
    definitions["Options"]["properties"] = {name: _options(kind) for name, kind in OPTIONS.items()}
    return {"$schema": DIALECT, "title": "periph-sim case", **_plain({**case, "$defs": definitions})}


def _resolved(schema: Schema, definitions: Schema) -> Schema:
    found: Schema = definitions[schema["$ref"].rpartition("/")[2]] if "$ref" in schema else schema
    return found


def _one_of(kinds: Mapping[str, object], schemas: Schema, definitions: Schema) -> Schema:
    """A table whose key `kind` says which other keys it has."""
    choices = []
    for name in kinds:
        schema = _closed(_resolved(schemas[name], definitions))
        kind = {"kind": {"enum": [name.partition(" ")[2]]}}
        required = ["kind", *schema.get("required", [])]
        choices.append({**schema, "properties": kind | schema["properties"], "required": required})
    return {"type": "object", "anyOf": choices}


def _devices(common: Schema, families: Mapping[str, Family], schemas: Schema, definitions: Schema) -> Iterator[Schema]:
    """A device's table by its model; the keys of a Python file only the file knows."""
    for name, family in families.items():
        own = _resolved(schemas[name], definitions)
        properties = {**common["properties"], **own["properties"], "model": {"enum": [*family.MODELS]}}
        required = [*common["required"], *own.get("required", [])]
        yield _closed({**common, "properties": properties, "required": required})
    properties = {**common["properties"], "model": {"type": "string", "pattern": r"\.py$"}}
    yield {**common, "properties": properties}


def _closed(schema: Schema) -> Schema:
    return {**schema, "additionalProperties": False}


def _options(kind: type) -> Schema:
    """The table of answers to open questions that a class of options takes."""
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


def _plain(schema: Any) -> Any:
    """Without what TOML cannot say, no editor shows, or is a default in other words than a file would use."""
    if isinstance(schema, list):
        return [_plain(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {
        key: {name: _plain(one) for name, one in value.items()} if key in ("properties", "$defs") else _plain(value)
        for key, value in schema.items()
        if key not in NOT_OF_JSON_SCHEMA
    }
    if "prefixItems" in plain:
        plain["items"] = plain.pop("prefixItems")  # as draft 7 says it
    if "anyOf" in plain:
        there = [one for one in plain.pop("anyOf") if one != {"type": "null"}]
        plain = {**plain, "anyOf": there} if len(there) > 1 else {**there[0], **plain}
    if "default" in plain and not _is_of_a_file(plain):
        del plain["default"]
    return plain


def _is_of_a_file(schema: Schema) -> bool:
    default = schema["default"]
    if default is None:
        return False
    pattern = schema.get("pattern")
    return pattern is None or (isinstance(default, str) and re.search(pattern, default) is not None)
