"""Each open question of a chip has its own test, which runs with every answer."""

from __future__ import annotations

import dataclasses
from types import ModuleType

import pytest

from periph_sim.devices.chips.adxl345 import Adxl345Options
from periph_sim.devices.chips.hmc5883l import Hmc5883lOptions
from periph_sim.devices.chips.itg3200 import Itg3200Options
from tests.devices.chips import test_adxl345, test_hmc5883l, test_itg3200


@pytest.mark.parametrize(
    ("options", "module"),
    [(Adxl345Options, test_adxl345), (Itg3200Options, test_itg3200), (Hmc5883lOptions, test_hmc5883l)],
)
def test_each_open_question_is_tested_with_every_answer(options: type, module: ModuleType):
    fields = {field.name: field for field in dataclasses.fields(options)}
    tests = {name.removeprefix("test_open_"): test for name, test in vars(module).items() if "test_open_" in name}
    assert set(tests) == set(fields)
    for name, test in tests.items():
        (mark,) = test.pytestmark
        answers = {row[0] if isinstance(row, tuple) else row for row in mark.args[1]}
        assert answers == set(fields[name].metadata["values"]), name
