"""Degrees of freedom agree with allantools, intervals with scipy.stats, covariance with its definition."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.identification.allan import Allan, allan
from periph_sim.imu.identification.confidence import LEVELS, edf, interval, slopes, white_covariance


def curve(length: int, power: float) -> Allan:
    """Return Allan variances that are proportional to tau**power."""
    counts = 2 ** np.arange(int(np.log2(length)) - 1)
    taus = counts * 0.02
    return Allan(counts, taus, taus**power, length)


@pytest.mark.parametrize(("power", "alpha"), [(-1, 0), (0, -1), (1, -2)])  # white, flicker, random walk
@pytest.mark.parametrize("length", [100, 10_000])
def test_degrees_of_freedom_agree_with_nist_sp_1065(power: float, alpha: int, length: int):
    import allantools  # here, because the import takes seconds

    found = curve(length, power)
    first = 1 if alpha == -1 else 0  # at m = 1 allantools omits the square of table 5 in flicker noise
    theirs = [allantools.edf_simple(length + 1, int(m), alpha) for m in found.counts[first:]]
    assert edf(found)[first:] == pytest.approx(np.maximum(theirs, 1.0))


def test_degrees_of_freedom_of_flicker_noise_at_one_sample_agree_with_table_5():
    assert edf(curve(100, 0))[0] == pytest.approx(2 * 99**2 / (2.3 * 101 - 4.9))


def test_the_nearest_slope_is_used_and_a_constant_counts_as_white():
    assert slopes(curve(100, -2)).tolist() == slopes(curve(100, -1)).tolist() == [-1] * 5
    assert slopes(curve(100, 0.3)).tolist() == [0] * 5
    assert slopes(allan(np.ones(100), 1.0)).tolist() == [-1] * 6


@given(st.floats(1, 1e5), st.sampled_from(list(LEVELS.values())))
def test_intervals_agree_with_chi_square(freedom: float, level: float):
    low, high = interval(np.array([freedom]), level)
    tail = (1 - level) / 2
    assert low[0] == pytest.approx(freedom / scipy.stats.chi2.isf(tail, freedom), rel=1e-6)
    assert high[0] == pytest.approx(freedom / scipy.stats.chi2.isf(1 - tail, freedom), rel=1e-6)
    assert low[0] < 1 < high[0] or freedom < 3


def differences(m: int, length: int) -> np.ndarray:
    """Return the weights of the samples in each difference of adjacent averages."""
    rows = np.zeros((length - 2 * m + 1, length))
    for k, row in enumerate(rows):
        row[k : k + m], row[k + m : k + 2 * m] = -1 / m, 1 / m
    return rows


@settings(deadline=None, max_examples=60)
@given(st.integers(4, 60), st.data())
def test_the_covariance_of_white_noise_agrees_with_its_definition(length: int, data: st.DataObject):
    m, n = (data.draw(st.integers(1, length // 2)) for _ in range(2))
    of_m, of_n = differences(m, length), differences(n, length)
    exact = 2 * np.square(of_m @ of_n.T).sum() / (4 * len(of_m) * len(of_n)) * m * n
    assert white_covariance(np.array([m, n]), length)[0, 1] == pytest.approx(exact, rel=1e-9)


def test_degrees_of_freedom_of_white_noise_are_nearly_exact():
    found = curve(10_000, -1)
    exact = 2 / np.diag(white_covariance(found.counts, found.length))
    assert edf(found)[:-2] == pytest.approx(exact[:-2], rel=0.06)
