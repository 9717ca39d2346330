"""Questions of a scene: their keys, the answers that are tried, and which ones are tried in pairs."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from periph_sim.core.options import Answers, BoolOption, IntOption, Value, choice, number
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.interfaces.reports.questions.question import Answer, Question, other_answers, questions_of, shown
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.interfaces.reports.questions.small import written
from tests.scene.runs import TIMING


class Some(Answers):
    flag: BoolOption = choice(True, False, question="?")
    listed: IntOption = choice(0, 1, 2, question="?")
    counted: IntOption = number(2, 0, 15, unit="cycles", question="?")


FIELDS = {field.name: field for field in dataclasses.fields(Some)}  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "answer", "others"),
    [
        ("flag", True, (False,)),
        ("flag", False, (True,)),
        ("listed", 1, (0, 2)),
        ("counted", 2, (0, 1, 3, 15)),
        ("counted", 0, (1, 15)),
        ("counted", 1, (0, 2, 15)),
        ("counted", 15, (0, 14)),
    ],
)
def test_all_other_values_or_the_bounds_and_the_neighbours_are_tried(
    name: str, answer: Value, others: tuple[Value, ...]
) -> None:
    assert other_answers(FIELDS[name], answer) == others


def test_the_answer_of_the_case_replaces_the_default(tmp_path: Path) -> None:
    case = load(written(tmp_path), ["unit.dsp.options.system.pf2_read_ws=7"])
    one = questions_of(Scene(case), ["dsp.system.pf2_read_ws"])["dsp.system.pf2_read_ws"]
    assert (one.default, one.others) == (7, (0, 6, 8, 15))
    assert one.text.startswith("What does a read") and one.experiment.startswith("Measure")


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("imu_hil.toml", "dsp.i2c.rrdy_point"),
        ("imu_hil.toml", "dsp.i2c.nack_clears_dxr"),
        ("imu_hil.toml", "dsp.sci.break_bits"),  # its values are texts that look like numbers
        ("imu_hil.toml", "dsp.system.int_latency"),
        ("real_chips.toml", "itg3200.burst"),
    ],
)
def test_each_answer_is_a_valid_change_of_the_case(file: str, name: str) -> None:
    scene = Scene(load(TIMING / file))
    if name.startswith("itg3200"):
        name = f"{next(chip for chip, table in scene.case.chip.items() if table.model == 'itg3200')}.burst"
    question = questions_of(scene, [name])[name]
    for value in question.others:
        changed = Scene(load(TIMING / file, [Answer(question, value).change]))
        assert questions_of(changed, [name])[name].default == value


def question(name: str, *registers: str) -> Question:
    return Question(name, "", 0, (), frozenset(registers), "", "")


@pytest.mark.parametrize(
    ("one", "other", "related"),
    [
        (question("dsp.i2c.a", "I2CSTR", "I2CDRR"), question("dsp.i2c.b", "I2CSTR"), True),
        (question("dsp.i2c.a", "I2CDRR"), question("dsp.i2c.b", "I2CSTR"), False),
        (question("dsp.i2c.a"), question("dsp.i2c.b"), True),
        (question("dsp.i2c.a"), question("dsp.i2c.b", "I2CSTR"), False),
        (question("dsp.i2c.a", "I2CSTR"), question("other.i2c.b", "I2CSTR"), False),
        (question("dsp.system.a"), question("dsp.sci.b"), False),
        (question("chip.a"), question("chip.b"), True),
    ],
)
def test_questions_are_related_by_a_register_of_one_group_or_by_having_none(
    one: Question, other: Question, related: bool
) -> None:
    assert one.is_related(other) is other.is_related(one) is related


def test_values_are_shown_as_in_a_case() -> None:
    assert [shown(value) for value in (True, 3, "fall8")] == ["true", "3", "fall8"]


CPU_REGISTERS = {"IFR"}  # a register of the CPU, which belongs to no module


@pytest.mark.parametrize("group", ["i2c", "sci", "spi", "system"])
def test_the_registers_that_options_declare_are_registers_of_their_module(group: str) -> None:
    maps = [module.registers for module in PART.modules if module.options == group]
    known = {register.name for one in maps for register in one} | CPU_REGISTERS
    declared = {
        field.name: field.metadata["registers"].split() for field in dataclasses.fields(PART.options_classes()[group])
    }
    assert {name for names in declared.values() for name in names} <= known
    assert any(declared.values())
