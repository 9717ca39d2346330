"""Equal scenes give equal records, byte for byte; a seed changes only what is random."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from periph_sim import Case, Scene, load
from periph_sim.records.recording import recording
from periph_sim.traces import formats
from tests.scene.runs import TIMING

SECONDS = Fraction(30, 1000)
JITTER = ("controller.jitter=1 ms", "host.jitter=1 ms")


def record(path: Path, *changes: str, name: str = "imu_hil_published") -> Path:
    case: Case = load(TIMING / f"{name}.toml", list(changes))
    with recording(path, case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        scene.run(SECONDS)
        ended_at(scene.kernel.now, {})
    return path


def rows(path: Path) -> list[list[object]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()[1:]]


@pytest.mark.parametrize("suffix", [".jsonl", ".vcd"])
@pytest.mark.parametrize("changes", [(), (*JITTER, "seed=7")], ids=["plain", "jitter"])
def test_the_same_case_twice_gives_the_same_bytes(tmp_path: Path, suffix: str, changes: tuple[str, ...]):
    first = record(tmp_path / f"a{suffix}", *changes).read_bytes()
    assert first == record(tmp_path / f"b{suffix}", *changes).read_bytes()
    assert len(first) > 10_000


def test_two_units_on_one_bus_are_repeatable(tmp_path: Path):
    first, second = (record(tmp_path / f"{which}.jsonl", name="two_dsps").read_bytes() for which in "ab")
    assert first == second


def test_another_seed_gives_other_times_where_something_is_random(tmp_path: Path):
    seven = record(tmp_path / "7.jsonl", *JITTER, "seed=7")
    eight = record(tmp_path / "8.jsonl", *JITTER, "seed=8")
    assert seven.read_bytes() != eight.read_bytes()


def test_another_seed_changes_nothing_where_nothing_is_random(tmp_path: Path):
    seven, eight = (record(tmp_path / f"{seed}.jsonl", f"seed={seed}") for seed in (7, 8))
    assert seven.read_bytes() == eight.read_bytes()


def test_records_are_numbered_in_order_and_come_after_their_causes(tmp_path: Path):
    columns = rows(record(tmp_path / "run.jsonl"))
    numbers = [row[0] for row in columns]
    assert numbers == list(range(1, len(columns) + 1))
    assert all(isinstance(row[7], int) and isinstance(row[0], int) and row[7] < row[0] for row in columns)


def test_the_edges_of_each_wire_alternate_and_do_not_go_back_in_time(tmp_path: Path):
    for name in ("SCL", "SDA", "RX"):
        edges = [(row[1], row[5]) for row in rows(record(tmp_path / "run.jsonl")) if row[2:4] == ["edge", name]]
        assert [level for _, level in edges] == [n % 2 for n in range(len(edges))]
        assert all(a < b for (a, _), (b, _) in pairwise(edges))


@pytest.mark.parametrize("name", ["SCL", "SDA", "RX", "MODEL"])
def test_a_vcd_read_back_has_the_edges_of_the_jsonl(tmp_path: Path, name: str):
    path = record(tmp_path / "run.jsonl")
    per_second = json.loads(path.read_text(encoding="utf-8").splitlines()[0])["ticks_per_second"]
    ticks = [row[1] for row in rows(path) if row[2:4] == ["edge", name]]
    channel = formats.read(record(tmp_path / "run.vcd")).channel(f"wires.{name}")
    assert ticks and channel.edges.tolist() == [-(-t * 10**9 // per_second) for t in ticks]


def test_recording_changes_nothing_that_is_measured(tmp_path: Path):
    case = load(TIMING / "imu_hil_published.toml", list(JITTER))
    plain = Scene(case).run(SECONDS)
    with recording(tmp_path / "run.jsonl", case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        recorded = scene.run(SECONDS)
        ended_at(scene.kernel.now, {})
    assert recorded.budgets == plain.budgets
    assert recorded.counts == plain.counts
    assert recorded.unknowns == plain.unknowns
