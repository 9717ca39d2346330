"""How many scenarios of the level `schedule` a second of CPU time makes, by what differs between them.

The shipped case timing/imu_hil.toml with all that it has: three clocks that are off, a host that drifts through all
phases, drawn costs; NACK windows, hangs, stretches and margins are told of each scenario. Then the published case where
many scenarios lie in such a window. One core, in the form of the core that is there. Draws are those of Python's
generator, made for many seeds at once, but each seed costs its seeding: scenarios that share seeds share that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from periph_sim.form import COMPILED, running
from periph_sim.levels.schedule import Structure, schedule, structure_of
from periph_sim.scene.case.load import load

from .child import TIMING
from .timed import median_of

Row = dict[str, Any]

CASE = TIMING / "imu_hil_published.toml"
SHARED = 1000  # seeds that scenarios share
APART = 20  # the part of the scenarios that is run where each goes read by read, as the core is interpreted


def changes(scenarios: int) -> dict[str, Mapping[str, NDArray[np.int64]]]:
    """By what differs between scenarios."""
    random = np.random.default_rng(1)
    phases = random.integers(2_000_000, 22_000_000, scenarios)
    seeds = np.arange(scenarios)
    few = scenarios if running == COMPILED else scenarios // APART
    starts = {"controller.first": phases[:few] + 3_000_000, "seed": seeds[:few] % SHARED}
    return {
        "phases of the host": {"host.first": phases},
        f"phases, {SHARED} seeds": {"host.first": phases, "seed": seeds % SHARED},
        "phases, a seed of its own each": {"host.first": phases, "seed": seeds},
        "a START of its own each": starts,
        "STARTs, and one of 11 clocks each": starts | {"unit.dsp.ppm": seeds[:few] % 11 * 5 - 25},
        "STARTs, and one of 1000 clocks each": starts | {"unit.dsp.ppm": (seeds[:few] % 1000 - 500) / 10},
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


def rows(scenarios: int = 100_000, rounds: int = 50) -> Iterator[Row]:
    structure, time = median_of(3, lambda: structure_of(load(CASE.with_name("imu_hil.toml"))))
    yield {"what": "terms measured on edges", "cpu_s": time.cpu}
    yield from report(structure, changes(scenarios), rounds)
    for name, (changed, given) in windows(scenarios).items():
        yield from report(structure_of(load(CASE, changed)), {name: given}, rounds)


def report(structure: Structure, changed: Mapping[str, Mapping[str, NDArray[np.int64]]], rounds: int) -> Iterator[Row]:
    for name, given in changed.items():
        found, time = median_of(3, lambda given=given: schedule(structure, given, rounds=rounds))
        each = found.scenarios / time.cpu
        yield {"what": name, "scenarios": found.scenarios, "rounds": rounds, "per_s": each, "cpu_s": time.cpu}


def line(row: Row) -> str:
    if "per_s" not in row:
        return f"{row['what']:35} {row['cpu_s'] * 1e3:.0f} ms of cpu"
    return f"{row['what']:35} {row['scenarios']:7} scenarios of {row['rounds']} rounds: {row['per_s']:10,.0f} /s of cpu"
