"""Lateness of one series of attitudes behind another comes back, whatever the step of time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.moving.lag import lag_between
from periph_sim.imu.rotations import quaternions

TIMES = np.arange(400) * 0.02


def attitude(times: np.ndarray) -> np.ndarray:
    angles = np.stack([np.sin(2 * times), 0.7 * np.sin(1.3 * times), 3 * np.sin(0.9 * times)], axis=1)
    return quaternions(angles)


@settings(max_examples=15)
@given(st.integers(0, 100))
def test_the_lateness_that_was_put_in_is_found(milliseconds: int):
    late = lag_between(TIMES, attitude(TIMES - milliseconds / 1000), attitude(TIMES))
    assert late.seconds == pytest.approx(milliseconds / 1000, abs=0.0011)
    assert late.apart.total.max() < 0.15 and len(late.apart.total) == 395


def test_signs_of_quaternions_do_not_matter():
    signs = np.where(np.arange(400) % 3, 1.0, -1.0)[:, np.newaxis]
    late = lag_between(TIMES, attitude(TIMES - 0.03), attitude(TIMES) * signs)
    assert late.seconds == pytest.approx(0.03, abs=0.0011) and late.apart.total.max() < 0.15


@pytest.mark.parametrize("rounds", [0, 1, 5])
def test_too_short_a_series_tells_no_lateness(rounds: int):
    late = lag_between(TIMES[:rounds], attitude(TIMES[:rounds]), attitude(TIMES[:rounds]))
    assert (late.seconds, len(late.apart.total)) == (0.0, 0)
