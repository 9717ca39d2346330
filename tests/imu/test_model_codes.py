"""The bytes of chips whose firmware computes the sensors equal those of `Imu.step` with the same numbers."""

from __future__ import annotations

import warnings
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.devices.sensor_rounds import register_bytes
from periph_sim.imu.model_codes import REMEMBERED, ModelCodes, model_codes
from periph_sim.imu.models.imu import Codes, Imu, Noise
from periph_sim.imu.models.parameters import ImuParameters, MagnetometerParameters
from periph_sim.imu.noise import ImuNoise
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.sensors import SENSORS as CHIPS
from tests.profiles import examples

IMU = ImuParameters()
FRAMES = [(0, 0, 0, 0, 0, 0), (3000, -2000, 900, 120, -340, 560), (3100, -1700, 1000, 100, -300, 500)]


def bytes_of(codes: Codes) -> dict[int, bytes]:
    """Return x, y, z as in the data sheets: the magnetometer as x, z, y, the accelerometer low byte first."""
    order = {"gyroscope": (0, 1, 2), "accelerometer": (0, 1, 2), "magnetometer": (0, 2, 1)}
    ends = {"gyroscope": "big", "accelerometer": "little", "magnetometer": "big"}
    return {
        CHIPS[name].address: b"".join(int(xyz[axis]).to_bytes(2, ends[name], signed=True) for axis in order[name])
        for name, xyz in codes._asdict().items()
    }


@pytest.mark.parametrize("noise_seed", [None, 5])
@pytest.mark.parametrize("arithmetic", ["float64", "float32", "q12"])
def test_each_run_gives_the_bytes_of_a_step_of_the_models(arithmetic: str, noise_seed: int | None):
    """Angles are in 1e-4 rad and accelerations in 1e-3 g; the first frame has no rates."""
    codes, imu = ModelCodes(IMU, arithmetic, noise_seed), Imu(named.scalar(arithmetic), IMU)
    assert {address: codes.at_rest.data(address) for address in (0x68, 0x53, 0x1E)} == dict.fromkeys(
        (0x68, 0x53, 0x1E), bytes(6)
    )
    shown, state = codes.at_rest, None
    for number, values in enumerate(FRAMES):
        shown = codes.run(number, values, shown)
        angles = tuple(imu.a.scaled(value, Fraction(1, 10_000)) for value in values[:3])
        pushed = tuple(imu.a.scaled(value, Fraction(1, 1000)) for value in values[3:])
        before = imu.at_rest._replace(attitude=angles) if state is None else state
        expected, state = imu.step(angles, pushed, codes.noise(number), before)
        assert {address: shown.data(address) for address in (0x68, 0x53, 0x1E)} == bytes_of(expected)
    assert set(bytes_of(expected).values()) != {bytes(6)}


def test_the_bytes_of_a_chip_are_computed_once():
    codes = ModelCodes(IMU, "float64")
    shown = codes.run(0, FRAMES[1], codes.at_rest)
    assert shown.data(0x53) is shown.data(0x53) != bytes(6)


def test_float32_computes_without_warnings():
    """A field straight down has no azimuth: its model divides 0 by 0, and treats NaN as an infinity."""
    down = ImuParameters(magnetometer=MagnetometerParameters(earth_field=(0, 0, 0.5), hard_iron=(0, 0, 0)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        codes = ModelCodes(down, "float32")
        shown = codes.run(0, (0, 0, 0, 0, 0, 0), codes.at_rest).data(0x1E)
    assert shown in {(-2048).to_bytes(2, "big", signed=True) * 3, (2047).to_bytes(2, "big") * 3}


def test_codes_that_do_not_fit_are_refused():
    with pytest.raises(OverflowError, match=r"\(0, 32768, 0\): "):
        register_bytes(CHIPS["gyroscope"], (0, 0x8000, 0))


@settings(max_examples=examples(40), deadline=None)
@given(
    st.sampled_from(["q16", "q12 saturating", "q16 rounded", "float64"]),
    st.lists(st.tuples(*[st.integers(-32768, 32767)] * 6), max_size=8),
)
def test_a_cached_sample_equals_a_computed_one(arithmetic: str, frames: list[tuple[int, ...]]):
    shared, alone = model_codes(IMU, arithmetic, None), ModelCodes(IMU, arithmetic)
    for _ in range(2):
        shown, expected = shared.at_rest, alone.at_rest
        for number, values in enumerate(frames):
            shown, expected = shared.run(number, values, shown), alone.run(number, values, expected)
            assert all(shown.data(address) == expected.data(address) for address in shared.addresses)
            assert (shown.state, shown.overflows) == (expected.state, expected.overflows)


def test_a_second_user_gets_the_cached_results_of_the_first():
    codes, values = model_codes(IMU, "q16", None), (100, 200, 300, 0, 0, 0)
    first = codes.run(0, values, codes.at_rest)
    assert model_codes(IMU, "q16", None) is codes
    assert codes.run(0, tuple(values), codes.at_rest) is first
    assert codes.run(1, values, codes.at_rest) is not first
    assert codes.run(0, values, first) is not first


@given(st.integers(0, 10_000), st.lists(st.integers(0, 3 * REMEMBERED), min_size=1, max_size=20), st.data())
@settings(max_examples=examples(20), deadline=None)
def test_noise_depends_only_on_its_number(seed: int, asked: list[int], data: st.DataObject):
    arithmetic = data.draw(st.sampled_from(["q16", "float64"]))
    holders = [ModelCodes(IMU, arithmetic, seed), model_codes(IMU, arithmetic, seed)]
    constant = named.scalar(arithmetic).constant
    for number in asked:
        alone = ImuNoise(IMU, seed).at(number)
        expected = Noise(*(tuple(constant(x) for x in axes) for axes in alone))
        assert holders[data.draw(st.integers(0, 1))].noise(number) == expected
    silent = Imu(named.scalar(arithmetic), IMU).silence
    assert ModelCodes(IMU, arithmetic).noise(3) == silent
