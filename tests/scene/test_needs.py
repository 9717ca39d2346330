"""A budget on something that the scene does not have is refused: it could only ever pass."""

from __future__ import annotations

import re

import pytest

from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.measures.registry import MEASURES
from tests.timing.events_by_hand import make


def alone(measure: str, limit: object, module: str = "I2C-A") -> Case:
    """One unit with nothing around it, and one budget."""
    unit = {"firmware": "responder", "modules": [module]}
    budget = {"name": "b", "measure": measure, "max": limit}
    return Case.model_validate({"name": "alone", "duration": "1 ms", "unit": {"dsp": unit}, "budget": [budget]})


@pytest.mark.parametrize("measure", MEASURES)
def test_every_measure_says_what_it_needs(measure):
    kind = make(measure)
    limit = "1 ms" if kind.unit == "time" else 0
    case = alone(measure, limit, "GPIO" if kind.needs == "I2C-A" else "I2C-A")
    needs = "[controller], or [rounds] for a unit that is the master," if kind.needs == "rounds" else kind.needs
    with pytest.raises(BadCase, match=re.escape(f"'{measure}' needs {needs} in the scene, which has none")):
        Scene(case)


def test_a_span_needs_nothing_but_its_firmware():
    assert Scene(alone("span:model", "1 ms")).run().verdict == "fail"  # it was never measured
