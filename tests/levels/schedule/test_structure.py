"""A case of another structure is refused in a sentence that says why, and which level takes it."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.levels.schedule import BadSchedule, schedule, structure_of
from periph_sim.levels.schedule.clock import CpuClock, check_length
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

REFUSED = {
    ("responder", ()): "it has no [host]",
    ("imu_hil_published", ("unit.dsp.firmware=imu_hil_robust",)): "its firmware is 'imu_hil_robust', not imu_hil",
    ("imu_hil_published", ("unit.dsp.settings.models_run=frame",)): "models_run is 'frame'",
    ("imu_hil_published", ("unit.dsp.settings.sdir_wait=false",)): "does not wait for AAS, RRDY, SDIR, XRDY per byte",
    ("imu_hil_published", ("unit.dsp.settings.mask_during_i2c=true",)): "interrupts masked",
    ("imu_hil_published", ("unit.dsp.settings.fifo_level=6",)): "more than one service routine",
    ("imu_hil_published", ("unit.dsp.options.i2c.dxr_to_xsr_copy_point=eager",)): "dxr_to_xsr_copy_point is 'eager'",
    ("imu_hil_published", ("host.lose=[[1, 2]]",)): "host.lose is given",
    ("imu_hil_published", ("host.error=4",)): "of 24 bytes of the host reach the SCI's FIFO",
    ("imu_hil_published", ("controller.pointer_by=STOP",)): "requests come by STOP",
    ("imu_hil_published", ("host.period=1 ms",)): "while the one before is still sent",
}


@pytest.mark.parametrize(
    ("program", "runs"),
    [
        ({"image": "build/imu.out"}, "the image imu.out"),
        ({"sources": ("src/imu.c", "src/i2c.c")}, "C sources, imu.c and others"),
    ],
)
def test_a_unit_that_runs_no_python_is_refused_as_such(program: dict[str, object], runs: str):
    case = load(TIMING / "imu_hil_published.toml")
    unit = case.unit["dsp"].model_copy(update={"firmware": "", "settings": {}, **program})
    with pytest.raises(BadSchedule) as error:
        structure_of(case.model_copy(update={"unit": {"dsp": unit}}))
    said = f"unit.dsp runs {runs}, and terms are measured in Python firmware; "
    assert said + 'the level "schedule" does not know that, use fidelity = "edge"' in str(error.value)


@pytest.mark.parametrize(("name", "changes"), REFUSED)
def test_another_structure_is_refused(name: str, changes: tuple[str, ...]):
    with pytest.raises(BadSchedule) as error:
        schedule(load(TIMING / f"{name}.toml", list(changes)), rounds=2)
    said = str(error.value)
    assert REFUSED[name, changes] in said and 'fidelity = "edge"' in said and "\n" not in said


CHANGES = {
    ("host.frist", 1): "scenarios cannot change 'host.frist'; did you mean host.first or",
    ("host.first", 1.5): "expected one row of whole numbers",
    ("host.first", -1): "holds -1; expected 0 ns or more",
    ("seed", "x"): "expected one row of whole numbers",
    ("host.ppm", "x"): "expected one row of numbers",
}


@pytest.mark.parametrize(("name", "value"), CHANGES)
def test_a_change_that_cannot_be_is_a_sentence(name: str, value: object):
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    with pytest.raises(BadSchedule) as error:
        schedule(structure, {name: np.array([value, value])}, rounds=2)
    assert CHANGES[name, value] in str(error.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"seed": np.array([2**63, 1], np.uint64)}, "holds 9223372036854775808; expected less than 2^62"),
        ({"host.first": np.array([2**64 - 1], np.uint64)}, "holds 18446744073709551615; expected less than 2^62"),
        ({"unit.dsp.settings.model_cost": [1, 10**12]}, "a run of "),
        ({"unit.dsp.settings.model_cost": [1, 10**18]}, "a run of "),
        ({"unit.dsp.ppm": 0.001, "unit.dsp.settings.model_cost": 10**9}, "a run of "),
        ({"seed": [2**61]}, ""),
    ],
)
def test_numbers_that_int64_does_not_hold_are_refused_and_never_wrap(changes: dict[str, object], said: str):
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    if said:
        with pytest.raises(BadSchedule) as error:
            schedule(structure, changes, rounds=2)  # type: ignore[arg-type]
        assert said in str(error.value)
    else:
        assert schedule(structure, changes, rounds=2)["response"].count.tolist() == [6]  # type: ignore[arg-type]


def test_models_that_take_more_cycles_than_32_bits_hold():
    """29 s: the run ends long before they do, and no interrupt is taken for one that never comes."""
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    found = schedule(structure, {"unit.dsp.settings.model_cost": [250_000, 29 * 10**9]}, rounds=2)
    assert found["response"].count.tolist() == [6, 0] and found["nacked"].worst.tolist() == [0, 6]
    assert found.seconds(found["span:model"].worst).tolist() == pytest.approx([250e-6, 0.044999], abs=1e-5)


def test_a_seed_of_the_case_that_int64_does_not_hold_is_refused():
    structure = structure_of(load(TIMING / "imu_hil_published.toml", [f"seed={2**62}"]))
    with pytest.raises(BadSchedule, match=r"seed is 4611686018427387904; expected less than 2\^62"):
        schedule(structure, rounds=2)


def test_arrays_of_different_length_and_rounds_that_are_none():
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    with pytest.raises(BadSchedule, match=r"different numbers of scenarios \(seed: 2, host.first: 3\)"):
        schedule(structure, {"seed": [1, 2], "host.first": [1, 2, 3]})
    with pytest.raises(BadSchedule, match="rounds is 0; expected a whole number above 0"):
        schedule(structure, rounds=0)


def test_a_run_whose_ticks_do_not_fit_is_refused_with_the_longest():
    structure = structure_of(load(TIMING / "imu_hil.toml"))
    with pytest.raises(BadSchedule, match=r"a run of .* takes numbers beyond 2\^62; .* the longest is .* s; ask for"):
        schedule(structure, {"unit.dsp.ppm": [0.000001, 1.0]}, rounds=1000)
    with pytest.raises(BadSchedule, match=r"a run of .* takes numbers beyond 2\^62; .* the longest is .* s; ask for"):
        schedule(structure, {"host.ppm": 0, "unit.dsp.ppm": 0.001, "host.first": [10**12, 10**15]}, rounds=2)
    longest = CpuClock(2_000_000, 100_003).longest
    check_length(longest, longest, 3_000_000_000)
    with pytest.raises(BadSchedule):
        check_length(longest + 1, longest, 3_000_000_000)
    tick = CpuClock(2_000_000, 100_003).tick(np.array([longest // 20]))
    assert tick.tolist() == [longest // 20 * 2_000_000 // 100_003]
