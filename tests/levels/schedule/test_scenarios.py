"""Scenarios one after the other come to what all of them at once come to, in either form of the core."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from periph_sim.levels.schedule import BadSchedule, structure_of
from periph_sim.levels.schedule.inputs import inputs_of
from periph_sim.levels.schedule.kept import BYTES, EDGES, NOTHING, Memory
from periph_sim.levels.schedule.rounds import Rounds
from periph_sim.levels.schedule.scenarios import Scenarios, fits
from periph_sim.levels.schedule.structure import Structure
from periph_sim.levels.schedule.tally import Tally
from periph_sim.scene.case.load import load
from tests.levels.schedule.scenes import scene
from tests.levels.schedule.test_beside_edge import FOUND
from tests.profiles import explores
from tests.scene.runs import TIMING

PUBLISHED = TIMING / "imu_hil_published.toml"
SEEDS = range(1000) if explores() else range(8)


def differ(
    structure: Structure, changes: dict[str, NDArray[Any]], rounds: int, end: int | None = None
) -> tuple[list[str], Tally]:
    """What differs between the two, and what scenarios came to. Refused ones mean nothing."""
    inputs = inputs_of(structure, changes, rounds, end)
    at_once, one_by_one = Rounds(structure, inputs), Scenarios(structure, inputs)
    at_once.run()
    one_by_one.run()
    means = ~at_once.refused
    found = ["refused"] * (at_once.refused.tolist() != one_by_one.refused.tolist())
    found += ["hung_at"] * bool((at_once.hung_at != one_by_one.hung_at)[means].any())
    others = one_by_one.observables()
    for name, observable in at_once.observables().items():
        for part in ("worst", "least", "count"):
            if (getattr(observable, part) != getattr(others[name], part))[means].any():
                found.append(f"{name}, {part}")
    return found, one_by_one


BLIPS = ["host.period=3 ms"]
WINDOWS: dict[str, tuple[dict[str, tuple[int, int]], list[str], set[str]]] = {  # ranges, changes, what happens
    "one service routine in many places": ({}, ["host.jitter=1 ms", "host.paced_by=pause"], set()),
    "several a round": ({}, [*BLIPS, "unit.dsp.settings.frame_cost=20 us"], {"held"}),
    "STARTs of their own": ({"controller.first": (3_000_000, 23_000_000)}, ["unit.dsp.ppm=30"], set()),
    "rounds that begin late": ({}, ["controller.jitter=2 ms", "controller.ppm=-11.3"], set()),
    "clocks of their own": ({"unit.dsp.ppm": (-3, 4), "host.ppm": (-90, 91)}, [], set()),
    "NACK windows": ({"unit.dsp.settings.model_cost": (1_000, 17_700_000)}, [], {"nacked"}),
    "refused rounds": ({"unit.dsp.settings.model_cost": (1_000, 60_000_000)}, [], {"nacked", "refused"}),
    "hang windows": ({}, [*BLIPS, "unit.dsp.settings.frame_cost=300 us"], {"hung", "nacked", "held"}),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_are_the_same(name: str):
    ranges, changes, happens = WINDOWS[name]
    random = np.random.default_rng(3)
    drawn = {"host.first": (0, 22_000_000), "seed": (0, 9)} | ranges
    given = {key: random.integers(*range_, 40) for key, range_ in drawn.items()}
    found, tally = differ(structure_of(load(PUBLISHED, changes)), given, 6)
    assert not found
    told = {"hung": tally.hung_at >= 0, "nacked": tally.nacked, "refused": tally.refused, "held": tally.held}
    assert {what for what, there in told.items() if there.any()} == happens


@pytest.mark.parametrize("clocks", [1, 5])
def test_scenarios_that_go_in_parts_are_the_same(clocks: int, monkeypatch: pytest.MonkeyPatch):
    """The last part is shorter; those of one clock are in a row."""
    monkeypatch.setattr("periph_sim.levels.schedule.scenarios.TOGETHER", 7)
    given = {"host.first": np.arange(40) * 500_000, "seed": np.arange(40) % 9, "unit.dsp.ppm": np.arange(40) % clocks}
    found, tally = differ(structure_of(load(TIMING / "imu_hil.toml")), given, 3)
    assert not found and len(set(tally.values["age"].worst.tolist())) > 20


def test_runs_that_end_anywhere_in_a_round_are_the_same():
    structure = structure_of(load(PUBLISHED))
    given = {"host.first": np.arange(12) * 1_700_000, "controller.first": 5_000_000 + np.arange(12) * 260_000}
    for end in (88_000_000, 88_777_777, 90_000_000):  # ns
        found, tally = differ(structure, given, 5, end * structure.per_second // 10**9)
        assert not found and len(set(tally.over.tolist())) == 2


def test_drawn_costs_and_clocks_that_drift_through_all_phases_are_the_same():
    given = {"host.first": np.arange(20) * 1_000_000, "seed": np.arange(20) % 6}
    assert not differ(structure_of(load(TIMING / "imu_hil.toml")), given, 6)[0]


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_are_the_same(seed: int):
    case, changes, rounds = scene(seed)
    random = np.random.default_rng(seed)
    count = 200 if explores() else 12
    given = {"host.first": random.integers(0, 22_000_000, count), "seed": random.integers(0, 1 << 40, count)}
    given["controller.first"] = random.integers(3_000_000, 24_000_000, count)
    try:
        found, _ = differ(structure_of(case), given, rounds)
    except BadSchedule:
        return
    assert not found, (changes, rounds)


@pytest.mark.parametrize("name", FOUND)
def test_what_random_scenes_found_is_the_same(name: str):
    case, _, rounds = scene(FOUND[name])
    assert not differ(structure_of(case), {}, rounds)[0]


@pytest.mark.parametrize(("num", "den"), [(2_000_000, 100_003), (300, 1)])
def test_what_is_kept_of_a_start_is_found_for_each_that_is_alike_and_for_no_other(num: int, den: int):
    """Alike: the cycles in which each edge is seen, from that of the START on, are the same."""
    edges = [7, 0, 131, 4099, 90_001, 90_013, 1_000_003]
    memory = Memory(edges, 3)
    memory.of_clock(num, den)
    seen: dict[int, tuple[int, ...]] = {}
    for start in range(1_000_000, 1_000_400):
        cycle = -(-start * den // num)
        rest = cycle * num - start * den
        cycles = tuple(-(-(start + edge) * den // num) - cycle for edge in edges)
        for phase in range(3):
            assert seen.setdefault(id(memory.find(rest, phase)), (phase, *cycles)) == (phase, *cycles), start
    assert len(seen) == len(set(seen.values())) > 9
    assert memory.find(0, 3) is NOTHING


def test_a_memory_has_one_interval_more_than_edges():
    """The interval behind the last edge takes a place of the array, too."""
    memory = Memory(range(EDGES - 1), 1)
    memory.of_clock(20, 1)
    assert memory.find(19, 0) is not NOTHING
    with pytest.raises(AssertionError):
        Memory(range(EDGES), 1)


@pytest.mark.parametrize(
    ("bytes_of_each", "fit"), [((26, 26, 26, 25), True), ((26, 26, 26, 26), False), ((BYTES,), False)]
)
def test_reads_fit_while_their_edges_leave_a_place_for_the_last_interval(bytes_of_each: tuple[int, ...], fit: bool):
    terms = SimpleNamespace(bus=[SimpleNamespace(needs=[0] * count) for count in bytes_of_each])
    assert sum(count + 6 for count in bytes_of_each) == EDGES - fit or max(bytes_of_each) == BYTES
    assert fits(cast("Any", terms)) is fit
