"""timing/imu_hil.toml and its fault cases prove what they say: both firmwares, dead hosts, late writes."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.board.firmware import Firmware, load_firmware
from periph_sim.board.result import Result
from periph_sim.board.scene import Scene
from periph_sim.case.load import load
from tests.board.runs import TIMING, run_file
from tests.firmware_mutants.trials import compiled

ROOT = Path(__file__).parents[2]
PUBLISHED, ROBUST = "unit.dsp.firmware=imu_hil", "unit.dsp.firmware=imu_hil_robust"
FAULTS = {  # what breaks with the published firmware
    "imu_hil_lost_byte": {"wrong bytes", "data age"},
    "imu_hil_broken_line": {"wrong bytes", "data age"},
    "imu_hil_silent_host": {"fresh again"},
    "imu_hil_doubled_frame": {"data age"},
    "imu_hil_spikes": {"data age"},
    "imu_hil_stuck_sda": {"data age"},
    "imu_hil_reset": {"wrong bytes", "data age"},
}


@pytest.mark.parametrize("name", ["imu_hil", "imu_hil_400k"])
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_both_firmwares_keep_every_budget_of_the_bench(name: str, firmware: str):
    assert run_file(name, "0.6", firmware).result.verdict == "pass"


def test_the_hosts_frames_drift_through_all_phases_of_the_rounds():
    """488 frames in 10 s end in each millisecond of a period, and in each tenth of the 2.62 ms that a round takes."""
    case = load(TIMING / "imu_hil.toml", [])
    scene = Scene(case.model_copy(update={"unit": {}, "controller": None, "budget": ()}))
    ends: list[Fraction] = []
    assert scene.host is not None
    scene.host.sent.append(lambda number, values, tick: ends.append(scene.timebase.seconds(tick)))
    scene.run()
    phases = [(end * 1000 / (1 + Fraction(30, 10**6)) - 5) % 20 for end in ends]
    assert len(ends) == 488
    assert {int(phase) for phase in phases} == set(range(20))
    assert {int(phase / Fraction(262, 1000)) for phase in phases} >= set(range(10))


@pytest.mark.parametrize("frames", [0, 1, 2, 3, 4, 7, 20, 50])
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_a_host_that_dies_at_any_frame_fails(frames: int, firmware: str):
    ran = run_file("imu_hil", "1.3" if frames == 50 else "0.7", firmware, f"host.frames={frames}")
    assert ran.result.verdict != "pass"
    (age,) = (verdict for verdict in ran.result.budgets if verdict.name == "data age")
    assert not age.passed


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_costs_the_robust_firmware_what_its_case_allows(name: str):
    robust, published = (run_file(name, "1.2", firmware) for firmware in (ROBUST, PUBLISHED))
    assert robust.broken() == []
    assert FAULTS[name] >= set(published.broken()) != set()


def test_glitches_hang_the_published_firmware_only():
    robust, published = (run_file("imu_hil_glitches", "3", firmware) for firmware in (ROBUST, PUBLISHED))
    assert robust.result.verdict == "pass"
    assert {"missed rounds", "bus stuck"} <= set(published.broken())


# A line of firmware is late ----------------------------------------------------------


def late(statement: str, cycles: int, case: str = "imu_hil", seconds: str = "0.3") -> tuple[Result, Scene]:
    """The published firmware with so many cycles before a statement."""
    source = (ROOT / "firmware" / "python" / "imu_hil.py").read_text(encoding="utf-8")
    (line,) = (line for line in source.splitlines() if line.strip() == statement)
    indent = line[: len(line) - len(line.lstrip())]
    changed = source.replace(line, f"{indent}dsp.compute({cycles})\n{line}") if cycles else source
    module = compiled(changed, "late")
    program = {"dsp": Firmware("late", module.main, module.Settings)}
    scene = Scene(load(TIMING / f"{case}.toml", []), programs=program, keep_values=True)
    return scene.run(Fraction(seconds)), scene


WRITE = "i2c.I2CDXR.all = next(buffer)"


def kept(scene: Scene, budget: str) -> list[int]:
    (measure,) = (limit.measure for limit in scene.limits if limit.budget.name == budget)
    return [int(value) for value in measure.all_kept()[0]]


PASS = 17  # cycles of a pass of the wait behind each write: XRDY and SCD are two reads


def moved(cycles: int, budget: str) -> list[float]:
    """By how many cycles each value of a budget moves, byte by byte, with so many before each write."""
    _, plain = late(WRITE, 0)
    _, later = late(WRITE, cycles)
    cycle = plain.timebase.per_second / plain.units["dsp"].clock.hz
    return [float((b - a) / cycle) for a, b in zip(kept(plain, budget), kept(later, budget), strict=True)]


@pytest.mark.parametrize("cycles", [PASS, 20 * PASS])
def test_cycles_before_each_write_come_off_the_margin_of_each_byte(cycles: int):
    steps = moved(cycles, "I2CDXR margin")
    assert len(steps) == 15 * 18 and steps == pytest.approx([-cycles] * len(steps), abs=0.06)  # a tick


def test_twenty_cycles_move_each_byte_by_twenty_to_within_a_pass_of_its_poll():
    steps = moved(20, "I2CDXR margin")
    assert all(20 - PASS - 0.1 < -step < 20 + PASS + 0.1 for step in steps)
    assert sum(steps) / len(steps) == pytest.approx(-20, abs=PASS / 2)


@pytest.mark.parametrize(
    "code",
    [
        {"between_accesses": 1, "poll_pass": 7, "isr_prologue": 6, "isr_epilogue": 3},
        {"between_accesses": 15, "poll_pass": 21, "isr_prologue": 22, "isr_epilogue": 18},
    ],
    ids=["short code", "long code"],
)
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_every_budget_holds_at_both_ends_of_what_compiled_code_costs(code: dict[str, int], firmware: str):
    changes = [f"unit.dsp.code.{key}={value}" for key, value in code.items()]
    assert run_file("imu_hil", "0.6", firmware, *changes).broken() == []


def test_three_hundred_cycles_before_each_write_break_the_reaction_and_nothing_else():
    result, _ = late(WRITE, 300)
    assert {verdict.name for verdict in result.budgets if verdict.broken} == {"reaction"}


def test_a_head_at_400_khz_is_stretched_only_by_a_write_that_is_later_than_it_leaves():
    kept, _ = late(WRITE, 300, "imu_hil_400k")
    assert "stretch" not in {verdict.name for verdict in kept.budgets if verdict.broken}
    broken, _ = late(WRITE, 600, "imu_hil_400k")
    assert "stretch" in {verdict.name for verdict in broken.budgets if verdict.broken}


def test_the_robust_firmware_refuses_a_guard_that_is_shorter_than_its_models():
    with pytest.raises(ValueError, match="guard must be longer than the models take"):
        load_firmware("imu_hil_robust").settings(guard=Fraction(1, 10_000))  # type: ignore[operator]
