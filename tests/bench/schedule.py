"""How many scenarios of the level `schedule` a second of CPU time makes, by what differs between them.

python -m tests.bench.schedule [--scenarios 100000] [--rounds 50]

The shipped case timing/imu_hil.toml with all that it has: three clocks that are off, a host that drifts through all
phases, drawn costs; NACK windows, hangs, stretches and margins are told of each scenario. Then the published case where
many scenarios lie in such a window. One core. Draws are those of Python's generator, made for many seeds at once, but
each seed costs its seeding: scenarios that share seeds share that.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from periph_sim.levels.schedule import Structure, schedule, structure_of
from periph_sim.scene.case.load import load

from .scenes import CASE
from .timed import median_of

SHARED = 1000  # seeds that scenarios share
APART = 20  # the part of the scenarios that is run where each goes read by read


def changes(scenarios: int) -> dict[str, Mapping[str, NDArray[np.int64]]]:
    """By what differs between scenarios."""
    random = np.random.default_rng(1)
    phases = random.integers(2_000_000, 22_000_000, scenarios)
    seeds = np.arange(scenarios)
    few = scenarios // APART
    return {
        "phases of the host": {"host.first": phases},
        f"phases, {SHARED} seeds": {"host.first": phases, "seed": seeds % SHARED},
        "phases, a seed of its own each": {"host.first": phases, "seed": seeds},
        "phases of the controller": {"controller.first": phases[:few] + 3_000_000, "seed": seeds[:few] % SHARED},
    }


def windows(scenarios: int) -> dict[str, tuple[list[str], Mapping[str, NDArray[np.int64]]]]:
    """Changes of the published case, and of its scenarios, by which window they lie in."""
    random = np.random.default_rng(1)
    phases = {"host.first": random.integers(2_000_000, 22_000_000, scenarios), "seed": np.arange(scenarios) % SHARED}
    costs = random.integers(17_300_000, 17_420_000, scenarios)
    drifts = ["host.jitter=1 ms", "host.paced_by=pause", "controller.first=30 ms"]
    return {
        "a third with refused rounds": (drifts, phases | {"unit.dsp.settings.model_cost": costs}),
        "four of five hang": ([*drifts, "unit.dsp.settings.frame_cost=300 us"], phases),
    }


def report(structure: Structure, changed: Mapping[str, Mapping[str, NDArray[np.int64]]], rounds: int) -> None:
    for name, given in changed.items():
        found, time = median_of(3, lambda given=given: schedule(structure, given, rounds=rounds))
        each = found.scenarios / time.cpu
        print(f"{name:32} {found.scenarios:7} scenarios of {rounds} rounds: {each:10,.0f} /s of cpu")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.schedule", description="Scenarios a second.")
    parser.add_argument("--scenarios", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=50)
    given = parser.parse_args()
    structure, time = median_of(3, lambda: structure_of(load(CASE.with_name("imu_hil.toml"))))
    print(f"terms measured on edges: {time.cpu * 1e3:.0f} ms of cpu")
    report(structure, changes(given.scenarios), given.rounds)
    for name, (changed, scenarios) in windows(given.scenarios).items():
        report(structure_of(load(CASE, changed)), {name: scenarios}, given.rounds)


if __name__ == "__main__":
    main()
