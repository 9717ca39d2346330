"""The shipped bench: the IMU emulator with a sensor head in Verilog, in both simulators, and without a simulator."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.cosim import simulate
from periph_sim.cosim.simulate import missing
from periph_sim.outside import replay
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.profiles import explores

pytestmark = pytest.mark.uncounted
FOLDER = Path(__file__).parents[2] / "timing" / "rtl"
SOURCES = [FOLDER / "sensor_head.v", FOLDER / "i2c_master.v"]
IN_BOTH = pytest.mark.skipif(not explores(), reason="in `make explore`")


@pytest.mark.parametrize("simulator", ["icarus", pytest.param("verilator", marks=IN_BOTH)])
def test_the_bench_passes_and_its_replay_meets_the_budgets(simulator: str, tmp_path: Path) -> None:
    if lack := missing(simulator):
        pytest.skip(lack)
    given = ["-Wno-fatal"] if simulator == "verilator" else []
    log = simulate(
        SOURCES, "sensor_head", "timing.rtl.bench_imu", folder=tmp_path, simulator=simulator, build_args=given
    )
    note = "SDA and SCL are driven from outside, in place of [controller]"
    assert f"11 rounds, 297 bytes, {note}" in log.read_text()
    result = replay(load(FOLDER / "imu_hil_rtl.toml"), tmp_path / "outside.jsonl")
    assert (result.counts["rounds"], result.wire_bytes, result.verdict) == (11, 297, "pass")


def test_the_case_passes_with_its_own_controller() -> None:
    result = Scene(load(FOLDER / "imu_hil_rtl.toml")).run()
    assert result.verdict == "pass" and result.counts["rounds"] == 11
