"""Identified parameters agree with those injected, over many seeds; useless recordings are refused."""

from __future__ import annotations

from math import nan

import numpy as np
import pytest
import scipy

from periph_sim.imu.identification.allan import BadSeries
from periph_sim.imu.identification.confidence import LEVELS
from periph_sim.imu.identification.identify import identify
from periph_sim.imu.noise import AxisNoise, NoiseTerms

PERIOD, COUNT, SEEDS = 0.02, 10_000, 200
DENSITY, BIAS = 1.2e-4, 3.6  # the gyroscope's y axis, Table 4.1
LSB = 1 / 14.375


def recording(
    seed: int, terms: NoiseTerms | None = None, count: int = COUNT, lsb: float | None = None, period: float = PERIOD
) -> np.ndarray:
    values = AxisNoise(terms or NoiseTerms(DENSITY), period, seed, "gyroscope/y").values(0, count) + BIAS
    return values if lsb is None else np.rint(values / lsb) * lsb


def likely(hits: int, of: int, part: float) -> bool:
    """True if the number of hits is expected by chance, with an error of one in a thousand."""
    low, high = scipy.stats.binom.interval(0.999, of, part)
    return bool(low <= hits <= high)


@pytest.mark.parametrize("lsb", [None, LSB])
def test_intervals_contain_the_injected_values_with_their_probability(lsb: float | None):
    found = [identify("y", recording(seed, lsb=lsb), PERIOD) for seed in range(SEEDS)]
    for part in LEVELS.values():
        z = scipy.stats.norm.isf((1 - part) / 2)
        bounds = [(one.density.bounds(part), one.quantisation_density) for one in found]
        assert likely(sum(low - q <= DENSITY <= high - q for (low, high), q in bounds), SEEDS, part)
        assert likely(sum(abs(one.bias.value - BIAS) <= z * one.bias.error for one in found), SEEDS, part)
    assert all((one.series.lsb is None) == (lsb is None) for one in found)


def test_the_errors_are_as_small_as_ten_thousand_samples_allow():
    one = identify("y", recording(1), PERIOD)
    assert one.density.error / one.density.value == pytest.approx((2.1 / COUNT) ** 0.5, rel=0.05)
    assert one.bias.error == pytest.approx((DENSITY / PERIOD / COUNT) ** 0.5, rel=0.05)
    assert one.density.region == slice(0, 11)  # 0.02 to 20.48 s, the range of useful variances
    assert one.notes == () and one.slow is None


def test_hard_iron_is_the_mean_with_less_the_mean_without():
    hits = 0
    for seed in range(SEEDS):
        one = identify("y", recording(seed) + 0.17, PERIOD, undisturbed=recording(seed + 1000))
        assert one.bias.error == pytest.approx((2 * DENSITY / PERIOD / COUNT) ** 0.5, rel=0.06) or one.bias.drift
        hits += abs(one.bias.value - 0.17) <= one.bias.error
    assert likely(hits, SEEDS, LEVELS["68 %"])


def test_the_region_of_white_noise_ends_where_a_random_walk_begins():
    terms = NoiseTerms(DENSITY, random_walk=3e-3)
    one = identify("y", recording(1, terms, 100_000), PERIOD)
    left = one.allan.taus[one.density.region.stop]
    assert left * 3e-3**2 / 3 > 0.1 * DENSITY / left  # it does not end before the walk is a tenth of the white part
    assert one.density.value == pytest.approx(DENSITY, rel=0.05)
    assert one.bias.drift > 0
    assert one.notes == (
        f"y: the averages drift by {one.bias.drift:.2g}, more than white noise does; averaging longer does not "
        "improve the bias",
    )


def test_the_error_of_a_drifting_mean_is_not_underestimated():
    """1/f noise has no mean: the error must describe how much the means of consecutive recordings differ."""
    terms = NoiseTerms(DENSITY, bias_instability=0.01)
    off, naive = [], []
    for seed in range(60):
        both = recording(seed, terms, 2 * COUNT)
        first, second = (identify("y", part, PERIOD, slow=True).bias for part in (both[:COUNT], both[COUNT:]))
        off.append((first.value - second.value) / np.hypot(first.error, second.error))
        naive.append((first.value - second.value) / np.hypot(first.white, second.white))
    assert np.std(naive) > 4
    assert np.std(off) < 1.5


def test_slow_terms_are_recovered_with_realistic_errors():
    terms = NoiseTerms(5e-5, bias_instability=5e-3, random_walk=1e-3)
    found = [identify("y", recording(seed, terms, 18_000, period=0.2), 0.2, slow=True) for seed in range(40)]
    instability = np.array([one.slow.bias_instability.value for one in found])
    walk = np.array([one.slow.random_walk.value for one in found])
    assert instability.mean() == pytest.approx(5e-3, rel=0.03) and instability.std() < 4e-4
    assert walk.mean() == pytest.approx(1e-3, rel=0.08) and walk.std() < 2.5e-4
    assert np.mean([one.density.value for one in found]) == pytest.approx(5e-5, rel=0.01)
    off = [(one.slow.bias_instability.squared - 25e-6) / one.slow.bias_instability.squared_error for one in found]
    assert 0.7 < np.std(off) < 1.6
    assert all(one.slow.bias_instability.found and one.slow.random_walk.found for one in found)


def test_slow_terms_that_are_absent_are_not_significant():
    found = [identify("y", recording(seed), PERIOD, slow=True).slow for seed in range(40)]
    assert sum(one.bias_instability.found for one in found) <= 4
    assert sum(one.random_walk.found for one in found) <= 4
    low, high = found[0].random_walk.bounds(1.96)
    assert low == 0 < high


def test_a_recording_without_a_slope_of_minus_a_half_is_refused_with_advice():
    with pytest.raises(BadSeries) as caught:
        identify("y", np.cumsum(recording(1) - BIAS), PERIOD)
    assert str(caught.value).startswith("y: the Allan deviation has slope 0.")
    assert str(caught.value).endswith(" in a row on a slope of -0.5, that of white noise; fit the slow terms with it")


# Whole LSB ------------------------------------------------------------------------


@pytest.mark.parametrize("noise", [0.15, 0.25, 0.35, 0.5, 1.0])  # in LSB
def test_the_error_of_a_mean_of_few_lsb_includes_rounding(noise: float):
    chance = np.random.default_rng(3)
    off, errors = [], []
    for _ in range(60):
        true = chance.uniform(-0.5, 0.5)
        one = identify("y", np.rint(true + noise * chance.normal(size=3000)), PERIOD)
        off.append(one.bias.value - true)
        errors.append(one.bias.error)
    rms = np.sqrt(np.mean(np.square(off)))
    assert 0.5 < rms / np.sqrt(np.mean(np.square(errors))) < 1.35


def test_noise_much_smaller_than_an_lsb_gets_a_note():
    one = identify("y", np.rint(0.3 + 0.2 * np.random.default_rng(1).normal(size=3000)), PERIOD)
    assert one.series.lsb == 1
    assert len(one.notes) == 1 and one.notes[0].endswith("rounding hides it, and the density is unreliable")


@pytest.mark.parametrize("decimals", [4, 6])
def test_the_lsb_is_found_in_printed_values(decimals: int):
    values = np.round(np.rint(recording(1) / LSB) * LSB, decimals)
    assert identify("y", values, PERIOD).series.lsb == pytest.approx(LSB, rel=1e-3)


def test_values_without_a_common_step_have_no_lsb():
    values = np.random.default_rng(1).choice([0.0, 1.0, 2.5, 3.1], 3000)
    assert identify("y", values, PERIOD).series.lsb is None


# Recordings that are refused ----------------------------------------------------


def refusal(samples: object, period: float = PERIOD) -> str:
    with pytest.raises(BadSeries) as caught:
        identify("gyroscope_y", samples, period)
    return str(caught.value)


def test_useless_recordings_are_refused_in_one_sentence():
    assert refusal([1.0, 2.0]) == "gyroscope_y: 2 samples; expected 32 or more"
    assert refusal([]) == "gyroscope_y: 0 samples; expected 32 or more"
    assert refusal(np.full(10_000, 2.5)) == (
        "gyroscope_y: all 10000 samples are 2.5; the noise is less than the resolution, so neither it nor the error of "
        "the mean can be determined"
    )
    assert refusal([0.0] * 40 + [nan, 1.0, nan]) == ("gyroscope_y: sample 40 is nan, and 2 of 43 are no finite numbers")
    assert refusal([0.0, 1.0] * 50) == "gyroscope_y: an Allan variance is 0, so there is no noise to be found"
    assert refusal([1e300, -1e300] * 50) == (
        "gyroscope_y: a sample is 1e+300 in size; expected 1e+100 or less, as of any sensor"
    )
    assert refusal(np.zeros((50, 3))) == "gyroscope_y: the samples have the shape (50, 3); expected one dimension"
    assert refusal(recording(1), 0.0) == ("gyroscope_y: the sampling period is 0.0 s; expected a finite number above 0")
    assert refusal(recording(1), nan).startswith("gyroscope_y: the sampling period is nan s; ")


def test_the_shortest_accepted_series_gives_wide_intervals():
    found = [identify("y", recording(seed, count=32), PERIOD) for seed in range(SEEDS)]
    bounds = [one.density.bounds(0.95) for one in found]
    assert min(high / low for low, high in bounds) > 2
    assert sum(low <= DENSITY <= high for low, high in bounds) > 0.9 * SEEDS
