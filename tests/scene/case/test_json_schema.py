"""The JSON schema for editors accepts every shipped case and rejects what the loader rejects."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

import jsonschema
import pytest
from click.testing import CliRunner
from msgspec import Meta, field

from periph_sim.bus.faults import kinds
from periph_sim.core.convert import Before
from periph_sim.core.table import Duration, Table
from periph_sim.interfaces.commands.schema import schema
from periph_sim.scene.case.json_schema import case_schema, schema_of, schema_of_table
from periph_sim.scene.case.load import apply
from tests.scene.runs import TIMING

CASES = sorted(TIMING.glob("*.toml"))


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft7Validator:
    made = case_schema()
    jsonschema.Draft7Validator.check_schema(made)
    return jsonschema.Draft7Validator(made)


def test_the_command_prints_the_schema():
    came = CliRunner().invoke(schema)
    assert came.exit_code == 0 and json.loads(came.output) == json.loads(json.dumps(case_schema()))


def test_every_shipped_case_is_valid(validator: jsonschema.Draft7Validator):
    for case in CASES:
        validator.validate(tomllib.loads(case.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "change",
    [
        "dura=10 ms",
        "duration=10",
        "duration=10 parsecs",
        "controller.perod=10 ms",
        "controller.rate=100",
        "controller.pointer_by=stop",
        "unit.dsp.modles=[]",
        "unit.dsp.pll=11",
        "unit.dsp.options.i2c.aas_sdir_pint=fall8",
        "unit.dsp.options.i2c.aas_sdir_point=fall7",
        "budget.0.maxx=3",
        "budget.0.coverage=90",
        "fault.0.wdth=50 ns",
        "fault.0.kind=spkie",
        "fault.0.at=3",
        "host.encoding.byte_order=middle",
        "host.motion.kind=loop",
        "host.lose=[[1, 12]]",
        "device.memory.model=24lc65",
        "device.memory.pages=8",
        "device.memory.fault.0.kind=dead",
        "device.adc.register.0.width=12",
        "device.adc.register.0.reed_only=true",
        "device.adc.stretch.byte=3",
        "chip.gyroscope.model=mpu6050",
        "chip.gyroscope.modle=itg3200",
        "watch.led.kind=blik",
        "watch.led.rat=1 kHz",
        "watch.led.duty=half",
    ],
)
def test_a_misspelt_key_or_value_is_invalid(validator: jsonschema.Draft7Validator, change: str):
    tree = whole()
    validator.validate(tree)
    apply(tree, change)
    assert not validator.is_valid(tree)


def whole() -> dict[str, Any]:
    """Return a case with all tables that the changes touch."""
    tree = tomllib.loads((TIMING / "imu_hil_published.toml").read_text(encoding="utf-8"))
    tree["fault"] = [{"kind": "spike", "wire": "SCL", "at": "1 ms", "width": "50 ns"}]
    tree["unit"]["dsp"]["options"] = {"i2c": {"aas_sdir_point": "fall9"}}
    tree["host"]["motion"] = {"kind": "static", "phi": "3 deg"}
    tree["host"]["encoding"] = {"byte_order": "big"}
    tree["chip"] = {"gyroscope": {"model": "itg3200", "values": {"fixed": [0, 0, 0]}}}
    tree["watch"] = {"led": {"kind": "blink", "wire": "LED", "tolerance": "1 us", "rate": "1 Hz", "duty": "50 %"}}
    tree["device"] = {
        "memory": {"model": "24lc64", "contents": "image.hex", "fault": [{"kind": "nack"}], "stretch": "1 us"},
        "adc": {"model": "registers", "register": [{"name": "A", "at": 0}], "stretch": {"length": "1 us to 2 us"}},
        "mine": {"model": "my_device.py", "address": 0x42, "speed": 3},
    }
    return tree


def test_kinds_of_faults_and_defaults_are_as_written_in_a_case_file():
    made = case_schema()
    choices = made["properties"]["fault"]["items"]["anyOf"]
    assert [one["properties"]["kind"]["enum"][0] for one in choices] == [*kinds()]
    text = json.dumps(made)
    assert '"null"' not in text and '"default": null' not in text and '"default": "1/50"' not in text


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
        (Annotated[str, Meta(ge=1)], {"type": "string"}),  # the limit applies to the number in the text
        (Annotated[str, Meta(pattern="^a", examples=["a"])], {"type": "string", "pattern": "^a", "examples": ["a"]}),
        (Annotated[int, Before(int, int | str)], {"anyOf": [{"type": "integer"}, {"type": "string"}]}),
        (Annotated[int, Before(int)], {"type": "integer"}),
    ],
)
def test_the_schema_of_a_type(annotation: object, schema: dict[str, Any]):
    definitions: dict[str, Any] = {}
    assert schema_of(annotation, definitions) == schema and definitions == {}


def test_a_table_is_defined_once_and_may_contain_itself():
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
    assert "default" not in keys["time"]  # a duration cannot be written as a number
