"""Noise by sample number: splitting, streams, distribution, and densities recovered from the Allan deviation."""

from __future__ import annotations

from math import log, pi

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.noise import BLOCK, AxisNoise, Gaussian, ImuNoise, NoiseTerms

ALL = NoiseTerms(density=1.6e-5, bias_instability=2e-3, random_walk=5e-3)
PERIOD = 0.02


def axis(terms: NoiseTerms = ALL, seed: int = 1, stream: str = "gyroscope/x") -> AxisNoise:
    return AxisNoise(terms, PERIOD, seed, stream)


@given(st.lists(st.integers(0, 900), min_size=1, max_size=8), st.integers(0, 3))
@settings(deadline=None, max_examples=40)
def test_noise_of_all_terms_may_be_split_resumed_and_read_singly(counts: list[int], skipped: int):
    whole = axis().values(0, sum(counts))
    split, at = axis(), 0
    for number, count in enumerate(counts):
        if number != skipped:  # a resumed run has not drawn the earlier samples
            if number % 2:
                assert np.array_equal(split.values(at, count), whole[at : at + count])
            else:
                assert [split.at(n) for n in range(at, at + count)] == whole[at : at + count].tolist()
        at += count


@given(st.lists(st.integers(0, 5000), min_size=1, max_size=20))
@settings(deadline=None, max_examples=30)
def test_samples_may_be_read_in_any_order(numbers: list[int]):
    whole = axis().values(0, 5001)
    asked = axis()
    assert [asked.at(n) for n in numbers] == [whole[n] for n in numbers]


def test_late_samples_do_not_need_the_earlier_ones():
    month = 30 * 86400 * 50
    terms = NoiseTerms(1.6e-5, bias_instability=2e-3)
    assert axis(terms).at(month) == axis(terms).values(month - 3, 7)[3]


def test_the_first_values_are_the_recorded_ones():
    """A numpy that draws other values would change every recorded run, which must be noticed."""
    assert Gaussian(1, "gyroscope/x/white").values(0, 3).tolist() == FIRST
    assert Gaussian(1, "gyroscope/x/white").values(10**12, 1).tolist() == [FAR]


FIRST = [2.1781161687618162, -0.19104262291253837, -1.6081671258350314]
FAR = 0.9090676090883633


def test_seeds_axes_sensors_and_terms_are_uncorrelated():
    count = 20_000
    names = ["a/x/white", "a/y/white", "a/z/white", "b/x/white", "a/x/random walk", "a/x/bias instability/0"]
    series = np.array([Gaussian(seed, name).values(0, count) for seed in (0, 1, 2) for name in names])
    pairs = np.corrcoef(series)[np.triu_indices(len(series), 1)] * np.sqrt(count)
    assert np.abs(pairs).max() < scipy.stats.norm.isf(0.5e-3 / len(pairs))  # 1 in 1000 over all pairs
    assert scipy.stats.kstest(pairs, "norm").pvalue > 1e-3


def test_blocks_follow_each_other_uncorrelated():
    values = Gaussian(3, "s").values(0, 200 * BLOCK)
    for lag in (1, 2, BLOCK - 1, BLOCK, BLOCK + 1):
        assert abs(np.mean(values[lag:] * values[:-lag])) * np.sqrt(len(values)) < 4


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_values_are_gaussian(seed: int):
    values = Gaussian(seed, "accelerometer/z/white").values(0, 100_000)
    edges = scipy.stats.norm.ppf(np.linspace(0, 1, 101))
    found, _ = np.histogram(values, edges)
    assert scipy.stats.chisquare(found).pvalue > 1e-3
    assert scipy.stats.kstest(values, "norm").pvalue > 1e-3
    assert scipy.stats.jarque_bera(values).pvalue > 1e-3


def test_white_noise_has_the_variance_density_over_period():
    count = 200_000
    variance = axis(NoiseTerms(1.6e-5)).values(0, count).var()
    assert abs(variance / 8e-4 - 1) < 4 * np.sqrt(2 / count)  # Table 5.1: 0.0008 g**2


def allan_variances(terms: NoiseTerms, count: int, octaves: range) -> tuple[np.ndarray, np.ndarray]:
    """Return averaging times, and the means of the overlapping Allan variances of twelve seeds."""
    import allantools  # here, because the import takes seconds

    taus = PERIOD * 2.0 ** np.array(octaves)
    series = [axis(terms, seed).values(0, count) for seed in range(12)]
    found = [allantools.oadev(one, rate=50, data_type="freq", taus=taus)[:2] for one in series]
    return found[0][0], np.mean([deviation**2 for _, deviation in found], axis=0)


def test_bias_instability_has_the_floor_of_ieee_952():
    """The floor of the Allan deviation is B sqrt(2 ln 2 / pi) = 0.664 B."""
    _, variances = allan_variances(NoiseTerms(0.0, bias_instability=1.0), 1 << 17, range(3, 12))
    floor = np.sqrt(variances) / np.sqrt(2 * log(2) / pi)
    assert floor == pytest.approx(np.ones(9), abs=0.06)


def test_the_allan_variance_of_random_walk_is_k_squared_tau_over_three():
    taus, variances = allan_variances(NoiseTerms(0.0, random_walk=0.5), 1 << 15, range(4, 9))
    assert variances / (0.25 * taus / 3) == pytest.approx(np.ones(5), abs=0.1)


def test_an_imu_has_nine_streams():
    sensor = replace(ImuParameters().magnetometer, noise_density=(1.0, 1.0, 0.0))
    noise = ImuNoise(replace(ImuParameters(), magnetometer=sensor), 5)
    values = np.array(noise.values(10, 4))
    assert values.shape == (3, 3, 4)
    assert values.transpose(2, 0, 1).tolist() == [np.array(noise.at(n)).tolist() for n in range(10, 14)]
    assert not values[2, 2].any() and (values[2, 0] != values[2, 1]).all()
