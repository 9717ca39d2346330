"""The models over arrays: the same codes as one sample after the other, however the arrays are cut."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.imu.models.arrays import codes_of
from periph_sim.imu.models.counts import PARTS, Counting, counts_of
from periph_sim.imu.models.imu import Imu, Noise, State
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.numeric.float64 import Float64
from periph_sim.imu.numeric.q import DoesNotFit, Q

LONG = 1000
T = np.arange(LONG) * 0.02
ATTITUDE = (np.sin(T), 0.7 * np.sin(1.3 * T), np.sin(0.5 * T) * 3)
ACCELERATION = (np.cos(T), np.sin(3 * T), 0.1 * T)
RANDOM = np.random.default_rng(5)
NOISE = Noise(*(tuple(RANDOM.normal(scale=s, size=LONG) for _ in range(3)) for s in (0.1, 0.03, 0.005)))
RICH = ImuParameters(
    accelerometer=AccelerometerParameters(lever_arm=(0.1, -0.05, 0.02)),
    gyroscope=GyroscopeParameters(rates="corrected", mounting=(2, -1, 3)),
    magnetometer=MagnetometerParameters(board_azimuth=5.0, board_elevation=-3.0),
    wrap="unwrapped",
)


@pytest.mark.parametrize("imu", [ImuParameters(), RICH], ids=["as built", "everything"])
def test_arrays_and_single_samples_agree(imu: ImuParameters) -> None:
    model = Imu(Float64(), imu)
    state = State(tuple(float(angle[0]) for angle in ATTITUDE), (0.0, 0.0, 0.0))
    alone = []
    for k in range(LONG):
        noise = Noise(*(tuple(float(axis[k]) for axis in chip) for chip in NOISE))
        attitude, pushed = (tuple(float(axis[k]) for axis in three) for three in (ATTITUDE, ACCELERATION))
        codes, state = model.step(attitude, pushed, noise, state)
        alone.append([code for chip in codes for code in chip])
    together = codes_of(imu, ATTITUDE, ACCELERATION, NOISE)
    assert np.array([axis for chip in together for axis in chip]).T.tolist() == alone
    assert together.gyroscope[0].dtype == np.int16


@pytest.mark.parametrize("piece", [1, 7, 999, 1000, 4096])
def test_the_length_of_pieces_does_not_show(piece: int) -> None:
    whole, cut = (codes_of(RICH, ATTITUDE, ACCELERATION, NOISE, piece=n) for n in (LONG, piece))
    assert np.array_equal(np.array(whole), np.array(cut))


def test_a_step_shows_in_its_sample_alone() -> None:
    turned = (np.array([0.0, 0.1, 0.1, 0.1]), np.zeros(4), np.zeros(4))
    rates = codes_of(ImuParameters(), turned, (np.zeros(4),) * 3).gyroscope[0]
    assert rates[1] > 4000 and rates[0] == rates[2] == rates[3]


def test_arrays_of_different_length_are_refused_and_none_is_none() -> None:
    with pytest.raises(ValueError, match="expected the same of all"):
        codes_of(ImuParameters(), ATTITUDE, (np.zeros(3),) * 3)
    nothing = (np.zeros(0),) * 3
    assert all(len(axis) == 0 for chip in codes_of(ImuParameters(), nothing, nothing) for axis in chip)


@pytest.mark.parametrize(
    "imu",
    [
        ImuParameters(),
        RICH,
        *(ImuParameters(magnetometer=MagnetometerParameters(spherical=way)) for way in ("plain", "rotation")),
    ],
)
def test_counts_of_the_parts_are_those_of_a_whole_sample(imu: ImuParameters) -> None:
    a = Counting(Float64())
    model = Imu(a, imu)
    model.step((0.1, 0.2, 0.3), (0.0, 0.0, 0.0), model.silence, model.at_rest)
    whole = a.pop_counts()
    parts = counts_of(imu)
    assert tuple(parts) == PARTS
    assert parts.pop("frame") == {"scaled": 6}
    assert sum((parts[part] for part in parts), start=type(whole)()) == whole


def test_what_one_sample_costs_in_operations() -> None:
    """A guard on the equations: a change of these numbers is a change of the model, or of its price."""
    counts = counts_of(ImuParameters())
    assert {part: sum(kinds.values()) for part, kinds in counts.items()} == {
        "frame": 6,
        "derivative": 12,
        "angles": 3,
        "gyroscope": 36,
        "accelerometer": 69,
        "magnetometer": 62,
    }
    assert counts["angles"] == {"sincos": 3}
    assert counts["magnetometer"]["atan2"] == 2 and counts["magnetometer"]["sqrt"] == 2


@pytest.mark.parametrize(
    ("imu", "sentence"),
    [
        (
            ImuParameters(period=1e-6),
            "derivative, 1 / period: 1e+06 does not fit Q16, which ends at 32768; take fewer ",
        ),
        (ImuParameters(magnetometer=MagnetometerParameters(scale=1e5)), "magnetometer: 100000 does not fit Q16"),
        (ImuParameters(accelerometer=AccelerometerParameters(scale=1e5)), "accelerometer: 100000 does not fit Q16"),
    ],
)
def test_a_constant_that_a_format_cannot_hold_is_told_with_its_part(imu: ImuParameters, sentence: str) -> None:
    with pytest.raises(DoesNotFit) as caught:
        Imu(Q(16), imu)
    assert str(caught.value).startswith(sentence)
