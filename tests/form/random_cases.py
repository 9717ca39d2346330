"""Run and record random variants of the shipped cases, and print one line for each seed.

    python -m tests.form.random_cases --seed 7 --count 500

    seed --> shipped case, changed keys, answers to open questions, more budgets --> run --> SHA-256 of the records

The lines are equal in all forms of the core; `python -m tests.hard` compares them.
"""

from __future__ import annotations

import argparse
import dataclasses
from random import Random
from typing import Any

from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.timing.budget_schema import Budget
from tests.bench.record_hashes import TIMING, recorded
from tests.interfaces.commands.test_all_measures import MEASURED

CASES = sorted(path.stem for path in TIMING.glob("*.toml"))
COMPILED_BY_A_C_COMPILER = (
    "imu_hil_c"  # compiling it takes seconds, and its polls are interpreted in both forms of the core
)
OPTIONS: dict[str, type] = {"i2c": I2cOptions, "sci": SciOptions, "system": SystemOptions}
CHANGES = {
    "controller": {
        "rate": ("60 kHz", "100 kHz", "250 kHz", "400 kHz"),
        "ppm": ("-50", "-11.3", "0", "50"),
        "first": ("1 ms", "3.1 ms", "5.0007 ms"),
        "period": ("3.7 ms", "5 ms", "10.003 ms", "20 ms"),
        "jitter": ("0 ms", "1 ms"),
        "filter": ("0 ns", "50 ns"),
        "pointer_by": ("repeated START", "STOP"),
        "on_nack": ("go on", "give up"),
        "clear_after": ("30 ms",),
    },
    "host": {
        "baud": ("57600", "115200", "230400"),
        "period": ("3 ms", "7 ms", "10.003 ms", "20 ms"),
        "first": ("0 ms", "1.3 ms", "4 ms"),
        "jitter": ("0 ms", "1 ms"),
        "paced_by": ("schedule", "pause"),
        "gap": ("0", "1", "2.5"),
        "error": ("-1", "0", "0.16", "1"),
        "ppm": ("-2000", "-3.7", "0", "78", "2000"),
    },
    "unit": {
        "ppm": ("-80", "0", "3.7", "80"),
        "skip_polls": ("true", "false"),
        "code.between_accesses": ("0", "1", "15"),
        "code.poll_pass": ("7", "40", "400"),
        "code.isr_prologue": ("0", "6", "200"),
        "code.isr_epilogue": ("0", "40"),
    },
}
MAX_REFUSED = 200  # maximum number of consecutive drawn cases that are refused


@dataclasses.dataclass
class Drawn:
    """A drawn variant of a shipped case.

    name: the name of the shipped case.
    changes: changed keys, as `key=value`.
    measures: measures of the additional budgets.
    seconds: duration of the run.
    """

    name: str
    changes: list[str]
    measures: list[str]
    seconds: str


def draw(random: Random) -> Drawn:
    name = random.choice([one for one in CASES if one != COMPILED_BY_A_C_COMPILER])
    case = load(TIMING / f"{name}.toml")
    changes = [f"seed={random.randrange(1000)}"]
    tables = [(unit, CHANGES["unit"]) for unit in (f"unit.{one}" for one in case.unit)]
    tables += [(one, CHANGES[one]) for one in ("controller", "host") if getattr(case, one) is not None]
    for table, keys in tables:
        changes += [f"{table}.{key}={random.choice(some)}" for key, some in keys.items() if random.random() < 0.15]
    for unit in case.unit:
        changes += [
            f"unit.{unit}.options.{group}.{of.name}={random.choice(values_of(of))}"
            for group, kind in OPTIONS.items()
            for of in dataclasses.fields(kind)
            if random.random() < 0.04
        ]
    if random.random() < 0.25:
        changes.append("disable=bits")
    measures = random.sample(sorted(MEASURED), random.randrange(4))
    return Drawn(name, changes, measures, f"0.0{random.randint(20, 60)}")


def values_of(of: dataclasses.Field[Any]) -> list[str]:
    about = of.metadata
    values = about["values"] if "values" in about else (about["least"], of.default, about["most"])
    return [str(one).lower() if isinstance(one, bool) else str(one) for one in values]


def line_of(seed: int) -> tuple[str, Drawn]:
    """Return the line of the first drawn case that is not refused, and that case.

    The line contains the number of refused cases before it, so that forms that refuse different cases are not equal.
    """
    random = Random(seed)
    for refused in range(MAX_REFUSED):
        drawn = draw(random)
        try:
            case = load(TIMING / f"{drawn.name}.toml", drawn.changes)
            more = tuple(Budget(name=f"random {one}", measure=one, max="1 h") for one in drawn.measures)
            case = case.model_copy(update={"budget": (*case.budget, *more), "breaks": ()})
            return f"{seed} {refused} {recorded(drawn.name, case, drawn.seconds)}", drawn
        except BadCase:
            continue
        except Exception as error:  # an error that does not end the run in both forms is a difference
            return f"{seed} {refused} {drawn.name} {type(error).__name__}: {error}", drawn
    raise AssertionError(f"seed {seed}: {MAX_REFUSED} consecutive drawn cases were refused")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--show", action="store_true", help="also print the drawn case")
    given = parser.parse_args()
    for seed in range(given.seed, given.seed + given.count):
        line, drawn = line_of(seed)
        print(line, *([drawn] if given.show else []), flush=True)


if __name__ == "__main__":
    main()
