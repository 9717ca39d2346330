"""A case judged on edges and at level `schedule`: a case goes in, what is not equal in the two results comes out.

python -m tests.levels.schedule.judged --first 0 --count 100
"""

from __future__ import annotations

import argparse
from fractions import Fraction
from random import Random

from periph_sim.levels.schedule import BadSchedule
from periph_sim.levels.schedule.scheduled_scene import FORGOTTEN, ScheduledScene
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.budget_schema import Budget
from tests.levels.schedule.scenes import scene

BUDGETS = {
    "response": {"max": "6 us", "p50": "5 us"},
    "stretch": {"max": "1 us"},
    "round": {"min": "1 ms", "max": "3 ms", "p95": "2700 us"},
    "slack": {"min": "1 ms"},
    "age": {"max": "30 ms", "p99": "25 ms"},
    "margin of I2CDXR": {"min": "2 us"},
    "span:model": {"max": "1 ms"},
    "missed rounds": {"max": 0},
    "nacked rounds": {"max": 0},
    "nacked": {"max": 0},
}
LATER = {f"{measure} later": (measure, limits) for measure, limits in BUDGETS.items() if measure in ("age", "round")}
JOINED = {"name": "old and held", "measure": "age", "max": "20 ms", "and": [{"measure": "stretch", "max": "0 us"}]}


def judged(case: Case, length: Fraction) -> list[str]:
    """What differs between the two, each a text; empty if nothing does. BadSchedule where the level refuses."""
    tables = [{"name": measure, "measure": measure, **limits} for measure, limits in BUDGETS.items()]
    tables += [{"name": name, "measure": of, **limits, "after": "20 ms"} for name, (of, limits) in LATER.items()]
    budgets = tuple(Budget.model_validate(table) for table in [*tables, JOINED])
    case = case.model_copy(update={"budget": budgets, "breaks": ()})
    quick = ScheduledScene(case).run(length)
    edges = Scene(case)
    slow = edges.run(length)
    differ = []
    for one, other in zip(slow.budgets, quick.budgets, strict=True):
        if one != other and not other.found.startswith(FORGOTTEN):
            differ.append(f"edge {one}\n    schedule {other}")
    for name in ("rounds", "missed", "nacked", "frames"):
        if slow.counts[name] != quick.counts[name]:
            differ.append(f"{name}: edge {slow.counts[name]}, schedule {quick.counts[name]}")
    if edges.bus.wire_bytes != quick.wire_bytes:  # of transfers that are over
        differ.append(f"wire_bytes: edge {edges.bus.wire_bytes}, schedule {quick.wire_bytes}")
    for name in ("simulated_s", "sci_bytes"):
        if getattr(slow, name) != getattr(quick, name):
            differ.append(f"{name}: edge {getattr(slow, name)}, schedule {getattr(quick, name)}")
    return differ


def cut(seed: int) -> tuple[Case, Fraction]:
    """A random scene, and a length that ends anywhere in a round."""
    case, _, rounds = scene(seed)
    controller = case.controller
    assert controller is not None
    part = Fraction(Random(f"{seed} end").randrange(1_000_000), 1_000_000)
    if part < Fraction(1, 2):  # in the transfers of a round
        part /= 4
    return case, controller.first + controller.period * (rounds - 1 + part)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    given = parser.parse_args()
    equal = refused = 0
    for seed in range(given.first, given.first + given.count):
        try:
            differ = judged(*cut(seed))
        except BadSchedule:
            refused += 1
            continue
        equal += not differ
        if differ:
            print(seed, *differ, sep="\n    ", flush=True)
    print(f"{equal} equal, {refused} refused, {given.count - equal - refused} differ")


if __name__ == "__main__":
    main()
