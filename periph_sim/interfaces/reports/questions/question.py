"""Open questions of a case, made from the declarations of its options: the answers that can be tried."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, cast

from ....core.options import Answers, Value
from ....f28335.experiments import EXPERIMENTS
from ....scene.scene import Scene


@dataclass(frozen=True)
class Question:
    """An option on which a run depends.

    name: the name of the option as in `Result.unknowns`: UNIT.GROUP.OPTION or CHIP.OPTION.
    key: the option's key in the case.
    default: the answer in the run of the case as it is, by default or because the case states it.
    others: the other answers that are tried.
    registers: the registers that the answer concerns.
    text: the question.
    experiment: the experiment on hardware that would decide it; "" if none is declared.
    """

    name: str
    key: str
    default: Value
    others: tuple[Value, ...]
    registers: frozenset[str]
    text: str
    experiment: str

    def is_related(self, other: Question) -> bool:
        """Return True if answers to both questions are tried in pairs.

        Both questions are about the same chip, or the same group of options of a unit. They have a register in common,
        or both have none.
        """
        same_group = self.name.rpartition(".")[0] == other.name.rpartition(".")[0]
        return same_group and bool(self.registers & other.registers or self.registers == other.registers)


class Answer(NamedTuple):
    """An answer to a question."""

    question: Question
    value: Value

    def __str__(self) -> str:
        return f"{self.question.name} = {shown(self.value)}, not {shown(self.question.default)}"

    @property
    def change(self) -> str:
        """The answer as a text for `--set`."""
        return f"{self.question.key}={json.dumps(self.value)}"


def shown(value: Value) -> str:
    """Return a value as in a case file, without quotes."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def questions_of(scene: Scene, names: Iterable[str]) -> dict[str, Question]:
    """Return the questions with these names, which are options of units and chips of the scene."""
    found: dict[str, Question] = {}
    for name in names:
        owner, _, rest = name.partition(".")
        given: Mapping[str, Value]
        kind: type[Answers]
        if owner in scene.units:
            plan = scene.units[owner].plan
            group, _, option = rest.partition(".")
            experiment = EXPERIMENTS.get(group, {}).get(option, "")
            kind = type(plan.system if group == "system" else plan.options[group])
            given = scene.case.unit[owner].options.get(group, {})
            key = f"unit.{owner}.options.{rest}"
        else:
            experiment = ""
            option, kind, given = rest, scene.chips[owner].chip.OPTIONS, scene.case.chip[owner].options
            key = f"chip.{owner}.options.{rest}"
        field = {one.name: one for one in dataclasses.fields(kind)}[option]  # type: ignore[arg-type]
        about = field.metadata
        default = cast(Value, given.get(option, field.default))
        others = other_answers(field, default)
        registers = frozenset(about["registers"].split())
        found[name] = Question(name, key, default, others, registers, about["question"], experiment)
    return found


def other_answers(field: dataclasses.Field[Any], default: Value) -> tuple[Value, ...]:
    """Return the answers that are tried in place of `default`.

    They are all other values of an option with a list of values. For a range, they are its two bounds and the two
    neighbours of `default`.
    """
    about = field.metadata
    if "values" in about:
        return tuple(value for value in about["values"] if value != default)
    assert isinstance(default, int)
    least, most = about["least"], about["most"]
    return tuple(n for n in sorted({least, default - 1, default + 1, most}) if least <= n <= most and n != default)
