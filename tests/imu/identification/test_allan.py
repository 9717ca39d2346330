"""Overlapping Allan variance agrees with allantools and with its definition, also at extremes."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.identification.allan import BadSeries, allan, octaves

PERIOD = 0.02


def noise(count: int, seed: int = 1) -> np.ndarray:
    """Return white noise with some random walk, so that no slope is special."""
    chance = np.random.default_rng(seed)
    return chance.normal(size=count) + 0.05 * np.cumsum(chance.normal(size=count))


def by_definition(samples: np.ndarray, m: int) -> float:
    """Return equation 4.15 with overlapping clusters, computed directly."""
    averages = [samples[k : k + m].mean() for k in range(len(samples) - m + 1)]
    changes = [averages[k + m] - averages[k] for k in range(len(averages) - m)]
    return float(np.mean(np.square(changes)) / 2)


@settings(deadline=None, max_examples=25)
@given(st.integers(4, 400), st.integers(0, 1000), st.floats(0.001, 100))
def test_all_taus_agree_with_allantools(count: int, seed: int, period: float):
    import allantools  # here, because the import takes seconds

    samples = noise(count, seed)
    found = allan(samples, period, range(1, count // 2 + 1))
    # allantools needs one phase more than necessary, so it omits the longest tau
    taus, deviation, _, _ = allantools.oadev(samples, rate=1 / period, data_type="freq", taus="all")
    assert len(taus) >= len(found.taus) - 1
    assert found.taus[: len(taus)] == pytest.approx(taus)
    assert found.deviation[: len(taus)] == pytest.approx(deviation, rel=1e-9)
    assert found.variance[-1] == pytest.approx(by_definition(samples, count // 2))


def test_a_long_series_agrees_with_allantools_at_octaves():
    import allantools  # here, because the import takes seconds

    samples = noise(200_000)
    found = allan(samples, PERIOD)
    taus, deviation, _, _ = allantools.oadev(samples, rate=50, data_type="freq", taus=found.taus)
    assert len(taus) == len(found.taus) == 17
    assert found.deviation == pytest.approx(deviation, rel=1e-9)


def test_octaves_go_up_to_half_the_samples():
    assert octaves(2) == [1] and octaves(3) == [1] and octaves(9) == [1, 2, 4] and octaves(1) == []


@pytest.mark.parametrize("offset", [0.0, 1e3, -1e9])
def test_a_constant_offset_has_no_effect(offset: float):
    samples = np.round(noise(4096) * 2**20) / 2**20  # so that adding the offset is exact, or nearly so
    digits = 1e-9 if abs(offset) < 1e6 else 1e-3
    assert allan(samples + offset, PERIOD).variance == pytest.approx(allan(samples, PERIOD).variance, rel=digits)


def test_a_constant_has_no_allan_variance():
    assert not allan(np.full(1000, 3.7), PERIOD).variance.any()


def test_a_series_of_two_million_samples_needs_little_more_memory_than_its_running_sum():
    samples = np.random.default_rng(1).normal(size=2_000_000)
    tracemalloc.start()
    allan(samples, PERIOD, [1, 4096, 1_000_000])
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2.2 * samples.nbytes


@pytest.mark.parametrize("m", [0, 6, -1])
def test_an_average_over_too_many_samples_is_refused(m: int):
    with pytest.raises(BadSeries, match=rf"^an average over {m} of 10 samples; expected 1 to 5$"):
        allan(noise(10), PERIOD, [m])
