"""Units of a scene: their options, their stubs, and programs that are not Python."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.user_code import Misuse
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
    assert plan.options["i2c"].unrecorded()["bcm_reset"] == 0
    assert plan.options["sci"].unrecorded()["break_bits"] == "9.625"
    assert plan.system.flash_model.unrecorded() == "beside_reads"


POLLS = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          .sect ".text", 0x9000
_c_int00: MOV   @SP,#0x400
          MOVW  DP,#0x7119 >> 6
again:    MOV   AL,@0x19
          TBIT  AL,#2
          SB    again,NTC
          ESTOP0
"""


@pytest.mark.parametrize(("start", "after", "us"), [("0 s", "0 s", 1), ("0 s", "0.4 ms", 400), ("1 s", "0.4 ms", 400)])
def test_a_stub_answers_after_a_time_that_counts_from_the_start(tmp_path: Path, start: str, after: str, us: int):
    path = tmp_path / "polls.asm"
    path.write_text(POLLS)
    stub = [{"register": "ADC.ADCST", "value": 4, "after": after}]
    scene = Scene(case(start=start, unit={"dsp": {"image": str(path), "modules": ["TIMER0"], "stub": stub}}))
    (note,) = [note for note in scene.run(Fraction(1, 1000)).notes if "ESTOP0" in note]
    ended = re.search(r"at ([0-9.]+) us", note)
    assert ended and float(ended[1]) == pytest.approx(us, abs=2)


def test_an_image_has_no_main_for_python(tmp_path: Path):
    path = tmp_path / "polls.asm"
    path.write_text(POLLS)
    scene = Scene(case(unit={"dsp": {"image": str(path), "modules": ["TIMER0"]}}))
    with pytest.raises(Misuse, match=r"^dsp runs an image or C sources, which have no main that Python could call$"):
        scene.firmware["dsp"].main(scene.units["dsp"], None)
