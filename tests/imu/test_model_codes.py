"""The bytes that chips show where firmware computes the sensors, beside `Imu.step` with the same numbers."""

from __future__ import annotations

import warnings
from fractions import Fraction

import pytest

from periph_sim.devices.sensor_rounds import register_bytes
from periph_sim.imu.model_codes import ModelCodes
from periph_sim.imu.models.imu import Codes, Imu
from periph_sim.imu.models.parameters import ImuParameters, MagnetometerParameters
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.sensors import SENSORS as CHIPS
from periph_sim.imu.shared_models import model_noise

IMU = ImuParameters()
FRAMES = [(0, 0, 0, 0, 0, 0), (3000, -2000, 900, 120, -340, 560), (3100, -1700, 1000, 100, -300, 500)]


def bytes_of(codes: Codes) -> dict[int, bytes]:
    """x, y, z as the data sheets keep them: the magnetometer as x, z, y, the accelerometer low byte first."""
    order = {"gyroscope": (0, 1, 2), "accelerometer": (0, 1, 2), "magnetometer": (0, 2, 1)}
    ends = {"gyroscope": "big", "accelerometer": "little", "magnetometer": "big"}
    return {
        CHIPS[name].address: b"".join(int(xyz[axis]).to_bytes(2, ends[name], signed=True) for axis in order[name])
        for name, xyz in codes._asdict().items()
    }


@pytest.mark.parametrize("noise_seed", [None, 5])
@pytest.mark.parametrize("arithmetic", ["float64", "float32", "q12"])
def test_each_run_shows_what_a_step_of_the_models_gives(arithmetic: str, noise_seed: int | None):
    """Angles come in 1e-4 rad, accelerations in 1e-3 g; the first frame has no rates."""
    codes, imu = ModelCodes(IMU, arithmetic, noise_seed), Imu(named.scalar(arithmetic), IMU)
    noise = model_noise(arithmetic, IMU, noise_seed)
    assert {address: codes.at_rest.data(address) for address in (0x68, 0x53, 0x1E)} == dict.fromkeys(
        (0x68, 0x53, 0x1E), bytes(6)
    )
    shown, state = codes.at_rest, None
    for number, values in enumerate(FRAMES):
        shown = codes.run(number, values, shown)
        angles = tuple(imu.a.scaled(value, Fraction(1, 10_000)) for value in values[:3])
        pushed = tuple(imu.a.scaled(value, Fraction(1, 1000)) for value in values[3:])
        before = imu.at_rest._replace(attitude=angles) if state is None else state
        expected, state = imu.step(angles, pushed, noise(number), before)
        assert {address: shown.data(address) for address in (0x68, 0x53, 0x1E)} == bytes_of(expected)
    assert set(bytes_of(expected).values()) != {bytes(6)}


def test_the_bytes_of_a_chip_are_worked_out_once():
    codes = ModelCodes(IMU, "float64")
    shown = codes.run(0, FRAMES[1], codes.at_rest)
    assert shown.data(0x53) is shown.data(0x53) != bytes(6)


def test_float32_computes_without_warnings():
    """A field that points straight down has no azimuth: its model divides 0 by 0, and takes NaN for an infinity."""
    down = ImuParameters(magnetometer=MagnetometerParameters(earth_field=(0, 0, 0.5), hard_iron=(0, 0, 0)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        codes = ModelCodes(down, "float32")
        shown = codes.run(0, (0, 0, 0, 0, 0, 0), codes.at_rest).data(0x1E)
    assert shown in {(-2048).to_bytes(2, "big", signed=True) * 3, (2047).to_bytes(2, "big") * 3}


def test_codes_that_do_not_fit_are_refused():
    with pytest.raises(OverflowError, match=r"\(0, 32768, 0\): "):
        register_bytes(CHIPS["gyroscope"], (0, 0x8000, 0))
