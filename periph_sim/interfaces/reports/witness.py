"""Case files that repeat the worst value of a budget: the case of a coverage with [inputs] and a duration.

worst value: phases, seed --[inputs]--> case file --run--> the same value
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ...proof.stretch import CoveredCase
from ...scene.case.inputs_table import InputsTable
from ...scene.case.load import apply, case_of
from ...scene.case.toml_file import read
from ...scene.scene import Scene
from ...timing.budget_plan import PER_MILLE
from ...timing.verdict import Verdict
from ...traces.formats import atomic_write
from .case_text import Tree, move_files, toml

NAME = re.compile(r"[^A-Za-z0-9]+")
IN_FILES = re.compile(r"[^\w.-]+")
DIGITS = 12  # decimals of a second; more if a tick is shorter than a picosecond


def witness_file(
    covered: CoveredCase,
    worst: Verdict,
    run: tuple[InputsTable, Fraction, int],
    case: Path,
    changes: Sequence[str],
    folder: Path,
) -> Path:
    """Write the case of one run, in which a budget has the value `worst`. Run it, and return its path.

    run: the inputs, the duration in seconds, and the seed.
    case, changes: the path of the case, and its changes as "key=value" texts, as the user gave them.
    folder: the folder of the new file.

    Raise BadCapture if the file cannot be written.
    """
    inputs, duration, seed = run
    _, tree = read(case, "case")
    for change in changes:
        apply(tree, change)
    move_files(tree, case.parent, folder)
    name = f"{IN_FILES.sub('_', covered.case.name)}_{_part_of_name(covered, worst.name)}"
    if "budget" in tree:  # without percentiles, because a coverage judges only the worst value
        names = {one.name for one in covered.case.budget}
        kept = [budget for budget in tree["budget"] if budget["name"] in names]
        tree["budget"] = [{key: value for key, value in one.items() if key not in PER_MILLE} for one in kept]
    tree["name"] = name
    tree["about"] = f"The worst value of {worst.name!r} that prove found for {covered.case.name}."
    tree["duration"], tree["seed"] = _seconds(covered, duration), seed
    tree["inputs"] = {**tree.get("inputs", {}), **input_texts(covered, inputs)}
    file = folder / f"{name}.toml"
    written = case_of(tree, file)
    result = Scene(written.model_copy(update={"budget": covered.case.budget})).run()
    (verdict,) = (one for one in result.budgets if one.name == worst.name)
    assert verdict.worst == worst.worst, f"{file}: {verdict.worst} instead of {worst.worst}"
    with atomic_write(file) as unfinished:
        unfinished.write_text(toml(tree), encoding="utf-8")
    return file


def _part_of_name(covered: CoveredCase, budget: str) -> str:
    """Return the part of a file name that denotes a budget. Each budget of the case has a different one."""
    parts = {one.name: NAME.sub("_", one.name).strip("_") for one in covered.case.budget}
    part = parts[budget]
    if part and [*parts.values()].count(part) == 1:
        return part
    return f"{part}_{[*parts].index(budget)}".strip("_")


def input_texts(covered: CoveredCase, inputs: InputsTable) -> Tree:
    """Return the keys `sends_later`, `frames` and `rounds` of a table [inputs], with times as texts for a case file.

    Keys without a time are left out.
    """
    texts: Tree = {"sends_later": _seconds(covered, inputs.sends_later)} if inputs.sends_later else {}
    for key in ("frames", "rounds"):
        times = getattr(inputs, key)
        texts |= {key: [_seconds(covered, time) for time in times]} if times else {}
    return texts


def _seconds(covered: CoveredCase, time: Fraction) -> str:
    digits = max(DIGITS, len(str(covered.phases.ticks_per_second)))
    whole, rest = divmod(round(time * 10**digits), 10**digits)
    return f"{whole}.{rest:0{digits}} s"
