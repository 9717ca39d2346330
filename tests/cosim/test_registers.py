"""Registers are read by name, and unknown names are refused."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.cosim.registers import peek
from periph_sim.outside.errors import OutsideError
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

DSP = {"unit": {"dsp": {"firmware": "responder", "modules": ["I2C-A"]}}}
TWO = {"unit": {name: {"firmware": "responder", "modules": ["I2C-A"]} for name in ("left", "right")}}
MEMORY = {"device": {"memory": {"model": "24lc64"}}}


def scene(tables: dict[str, Any]) -> Scene:
    return Scene(Case.model_validate({"name": "x", "duration": "1 ms", **tables}))


def test_a_field_of_the_only_unit_needs_no_unit():
    assert peek(scene(DSP), "I2C-A.I2CMDR.IRS") == peek(scene(DSP), "dsp.I2C-A.I2CMDR.IRS")


@pytest.mark.parametrize(
    ("tables", "place", "sentence"),
    [
        (MEMORY, "I2C-A.I2CSTR", "I2C-A.I2CSTR: the scene has no unit, and only units have registers"),
        (TWO, "I2C-A.I2CSTR", "I2C-A.I2CSTR: give the unit; "),
        (DSP, "I2C-A", "'I2C-A': expected MODULE.REGISTER or MODULE.REGISTER.FIELD, such as"),
        (DSP, "SCI-A.SCICCR", "SCI-A.SCICCR: dsp has no module 'SCI-A'; "),
        (DSP, "I2C-A.I2CSTX", "I2C-A has no register 'I2CSTX'; did you mean I2CSTR or "),
        (DSP, "I2C-A.I2CSTR.SCX", "I2CSTR has no field 'SCX'; did you mean SCD?"),
    ],
)
def test_an_unknown_name_is_refused_in_one_sentence(tables: dict[str, Any], place: str, sentence: str):
    with pytest.raises(OutsideError) as caught:
        peek(scene(tables), place)
    assert sentence in str(caught.value)
