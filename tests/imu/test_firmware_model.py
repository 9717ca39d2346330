"""The models' period must be that of the scene; otherwise the case is refused with the place."""

from __future__ import annotations

from math import radians
from pathlib import Path
from types import SimpleNamespace

import pytest

from periph_sim.imu.firmware_model import ImuFirmware, resting_attitude
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from tests.devices.aerospace import FIELD, at_rest
from tests.imu.moving.subjects import parameters
from tests.scene.runs import run_file


def models_with(period: str, folder: Path, *changes: str) -> None:
    run_file("imu_models", "0.001", parameters(folder, f'period = "{period}"'), *changes)


@pytest.mark.parametrize("period", ["10 s", "10 ms", "20.1 ms", "19.9 ms", "1 us"])
def test_another_period_than_the_rounds_is_refused_with_its_place(period: str, tmp_path: Path) -> None:
    with pytest.raises(BadCase) as refused:
        models_with(period, tmp_path)
    message = str(refused.value)
    assert "imu_models.toml" in message and "unit.dsp.settings.parameters: the models' period is " in message
    assert "but they run once a round (controller.period), every 20.000 ms; make them the same" in message


@pytest.mark.parametrize("period", ["20 ms", "20.01 ms", "19.99 ms"])
def test_clocks_may_differ_by_a_thousandth(period: str, tmp_path: Path) -> None:
    models_with(period, tmp_path)


def test_the_period_must_be_that_of_the_controller_and_not_of_the_host(tmp_path: Path) -> None:
    models_with("25 ms", tmp_path, "controller.period=25 ms")
    models_with("20 ms", tmp_path, "host.period=40 ms")
    with pytest.raises(BadCase, match=r"\(controller\.period\), every 25\.000 ms"):
        models_with("20 ms", tmp_path, "controller.period=25 ms")


def test_the_period_of_models_that_run_per_frame_must_be_that_of_the_host() -> None:
    case = load(Path("timing/imu_models.toml"), ["host.period=10 ms"])
    per_frame, per_round = SimpleNamespace(models_run="frame"), SimpleNamespace(models_run="round")
    ImuFirmware(ImuParameters(period=0.01), per_frame).check(case, "dsp")
    ImuFirmware(ImuParameters(), per_round).check(case, "dsp")
    with pytest.raises(BadCase, match=r"once a host frame \(host\.period\), every 10\.000 ms"):
        ImuFirmware(ImuParameters(), per_frame).check(case, "dsp")


def test_without_a_controller_the_period_must_be_that_of_the_host_and_without_a_host_any() -> None:
    case = load(Path("timing/imu_models.toml"), ["host.period=10 ms"])
    without_controller = case.model_copy(update={"controller": None})
    with pytest.raises(BadCase, match=r"\(host\.period\)"):
        ImuFirmware(ImuParameters(), None).check(without_controller, "dsp")
    ImuFirmware(ImuParameters(), None).check(without_controller.model_copy(update={"host": None}), "dsp")


@pytest.mark.parametrize("roll", [0.0, 25.0, -80.0, 150.0])
@pytest.mark.parametrize("pitch", [0.0, 40.0, -70.0])
@pytest.mark.parametrize("yaw", [0.0, 60.0, -100.0, 179.0])
def test_every_attitude_is_found(roll: float, pitch: float, yaw: float) -> None:
    accel, mag = at_rest(*map(radians, (roll, pitch, yaw)))
    assert resting_attitude(accel, mag, FIELD) == pytest.approx((roll, pitch, yaw))
