"""The schema for editors: it takes every shipped case, and refuses what the loader refuses."""

from __future__ import annotations

import json
import tomllib
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from periph_sim.bus.faults import kinds
from periph_sim.interfaces.commands.schema import schema
from periph_sim.scene.case.json_schema import case_schema
from periph_sim.scene.case.load import apply
from tests.scene.runs import TIMING

CASES = sorted(TIMING.glob("*.toml"))


@pytest.fixture(scope="module")
def judge() -> jsonschema.Draft7Validator:
    made = case_schema()
    jsonschema.Draft7Validator.check_schema(made)
    return jsonschema.Draft7Validator(made)


def test_the_command_prints_it():
    came = CliRunner().invoke(schema)
    assert came.exit_code == 0 and json.loads(came.output) == json.loads(json.dumps(case_schema()))


def test_every_shipped_case_is_valid(judge: jsonschema.Draft7Validator):
    for case in CASES:
        judge.validate(tomllib.loads(case.read_text(encoding="utf-8")))


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
def test_a_misspelt_key_or_value_is_not(judge: jsonschema.Draft7Validator, change: str):
    tree = whole()
    judge.validate(tree)
    apply(tree, change)
    assert not judge.is_valid(tree)


def whole() -> dict[str, Any]:
    """A case with all that the changes touch."""
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


def test_every_kind_of_fault_and_every_default_is_in_words_of_a_file():
    made = case_schema()
    choices = made["properties"]["fault"]["items"]["anyOf"]
    assert [one["properties"]["kind"]["enum"][0] for one in choices] == [*kinds()]
    text = json.dumps(made)
    assert '"null"' not in text and '"default": null' not in text and '"default": "1/50"' not in text
