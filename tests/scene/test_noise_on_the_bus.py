"""Noise through the whole chain: the sensor head reads from the emulator the samples that arrays give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.at_rest.rest import at_rest
from periph_sim.imu.models.parameters import ImuParameters
from tests.scene.runs import run_file

pytestmark = pytest.mark.long

STILL = 'host.motion={kind = "static"}'
ROUNDS = 40


def read(arithmetic: str, seed: int | None = 5) -> np.ndarray:
    """Return the codes of the gyroscope that the sensor head reads, one row a round."""
    changes = [STILL, f"unit.dsp.settings.arithmetic={arithmetic}", "unit.dsp.settings.model_cost=250 us"]
    if seed is not None:
        changes.append(f"unit.dsp.settings.noise_seed={seed}")
    ran = run_file("imu_models", str(ROUNDS * 0.02), *changes)
    assert ran.broken() == []
    return np.array([np.frombuffer(bytes.fromhex(gyroscope), ">i2") for gyroscope, _, _ in ran.read()])


def test_the_sensor_head_reads_one_sample_of_the_arrays_in_each_round():
    """The n-th run of the models computes the n-th sample and ends before round n, as in Fig. A.2."""
    received = read("float64")
    codes = np.rint(at_rest(ImuParameters(), ROUNDS, 5)["gyroscope"] * ImuParameters().gyroscope.scale)
    assert len(received) == ROUNDS
    assert np.array_equal(received, codes)


def test_samples_in_q16_rarely_differ_and_by_one_lsb():
    exact, fixed = read("float64"), read("q16")
    assert np.abs(exact - fixed).max() <= 1
    assert np.mean(exact != fixed) < 0.05


def test_without_a_seed_there_is_no_noise():
    still = read("float64", None)
    assert (still == still[0]).all()
    assert len(np.unique(read("float64")[:, 0])) > 3


def test_the_noise_of_a_parameter_file_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "quiet.toml").write_text('[gyroscope]\nnoise_density = "0, 0, 0 (deg/s)^2/Hz"\n', encoding="utf-8")
    settings = f'unit.dsp.settings.parameters="{tmp_path / "quiet.toml"}"'
    ran = run_file("imu_models", "0.2", STILL, settings, "unit.dsp.settings.noise_seed=1")
    gyroscope, accelerometer = ({one[place] for one in ran.read()} for place in (0, 1))
    assert len(gyroscope) == 1 and len(accelerometer) > 5
