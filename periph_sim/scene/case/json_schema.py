"""The JSON schema of case files, for editors.

All of it is read from the models: the tables of `Case`, the kinds of faults and motions with their settings, and the
options of a unit. Only the firmware knows its settings, so the schema allows any keys in that table.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ...bus.faults import kinds as kinds_of_fault
from ...core.options import allowed
from ...devices.chips import chip_models
from ...devices.host_frames import host_frames
from ...devices.targets import Family, families
from ...devices.watchers import watchers
from ...f28335.parts import part_names
from ...f28335.parts.f28335 import PART
from ..plugins import known
from .json_types import Schema, schema_of_table
from .model import Case

DIALECT = "http://json-schema.org/draft-07/schema#"  # editors of TOML know nothing newer


def case_schema() -> Schema:
    """Return the schema as a tree, for `json.dumps`."""
    here = Path()  # the folder whose project may have plugins
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
    definitions["DeviceTable"] = {"anyOf": [*_devices(definitions["DeviceTable"], devices, schemas)]}
    definitions["WatchTable"] = {"anyOf": [*_watches(definitions["WatchTable"], watches, schemas)]}
    options = {name: _options(kind) for name, kind in PART.options_classes().items()}
    definitions["Unit"]["properties"]["part"]["enum"] = [*part_names()]
    definitions["Unit"]["properties"]["options"] = _closed({"type": "object", "properties": options})
    return {"$schema": DIALECT, "title": "periph-sim case", **case, "$defs": definitions}


def _one_of(kinds: Mapping[str, object], schemas: Schema) -> Schema:
    """Return the schema of a table whose key `kind` decides which other keys it has."""
    choices = []
    for name in kinds:
        schema = schemas[name]
        kind = {"kind": {"enum": [name.partition(" ")[2]]}}
        required = ["kind", *schema.get("required", [])]
        choices.append({**schema, "properties": kind | schema["properties"], "required": required})
    return {"type": "object", "anyOf": choices}


def _devices(common: Schema, families: Mapping[str, Family], schemas: Schema) -> Iterator[Schema]:
    """Yield a device table's schema for each family of models, and one for Python files, whose keys are not known."""
    for name, family in families.items():
        own = schemas[name]
        properties = {**common["properties"], **own["properties"], "model": {"enum": [*family.MODELS]}}
        required = [*common["required"], *own.get("required", [])]
        yield _closed({**common, "properties": properties, "required": required})
    properties = {**common["properties"], "model": {"type": "string", "pattern": r"\.py$"}}
    yield {**common, "properties": properties}


def _watches(common: Schema, kinds: Mapping[str, object], schemas: Schema) -> Iterator[Schema]:
    """Yield the schema of the table of each kind of watcher."""
    for name in kinds:
        own = schemas[name]
        properties = {**common["properties"], **own["properties"], "kind": {"enum": [name.partition(" ")[2]]}}
        required = [*common["required"], *own.get("required", [])]
        yield _closed({**common, "properties": properties, "required": required})


def _closed(schema: Schema) -> Schema:
    return {**schema, "additionalProperties": False}


def _options(kind: type) -> Schema:
    """Return the schema of a table of answers to the open questions in a class of options."""
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
