"""What a unit of a scene is built of."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.scene import unit as unit_module
from periph_sim.scene.scene import Scene
from tests.scene.small import case


def test_the_answers_of_a_case_are_those_of_its_modules(monkeypatch: pytest.MonkeyPatch):
    plans: list[DspPlan] = []

    def built(kernel: Any, timebase: Any, recorder: Any, plan: DspPlan) -> Dsp:
        plans.append(plan)
        return Dsp(kernel, timebase, recorder, plan)

    monkeypatch.setattr(unit_module, "Dsp", built)
    options = {"i2c": {"bcm_reset": 0}, "sci": {"break_bits": "9.625"}, "system": {"flash_model": "beside_reads"}}
    Scene(case(unit={"dsp": {"firmware": "responder", "modules": ["I2C-A", "SCI-A"], "options": options}}))
    (plan,) = plans
    assert plan.answers(I2cOptions).bcm_reset.unrecorded() == 0
    assert plan.answers(SciOptions).break_bits.unrecorded() == "9.625"
    assert plan.system.flash_model.unrecorded() == "beside_reads"
