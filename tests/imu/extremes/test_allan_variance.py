"""The Allan variance of large offsets and steep ramps: within rounding of the exact one, and a lost digit is seen."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from periph_sim.imu.extremes import allan_variance
from periph_sim.imu.extremes.allan_variance import allan_variances, exact_variance
from periph_sim.imu.identification.allan import allan


def test_every_row_agrees():
    assert [(one.extreme, one.happens) for one in allan_variances()] == [
        ("Allan variance, offset of 1e+09", "agrees"),
        ("Allan variance, offset of 1e+15", "agrees"),
        ("Allan variance, ramp of 1e+03", "agrees"),
        ("Allan variance, ramp of 1e+09", "agrees"),
    ]


def test_the_exact_variance_of_a_ramp_is_half_the_square_of_what_it_climbs():
    """Averages over m samples of a ramp of 3 are 3 m apart; alternating samples change by 2 from one to the next."""
    assert exact_variance([3 * n for n in range(20)], 4) == Fraction((3 * 4) ** 2, 2)
    assert exact_variance([0, 2] * 8, 1) == 2 and exact_variance([0, 2] * 8, 2) == 0


class WithoutMean(np.ndarray):
    """Samples from which no mean is taken."""

    def mean(self, *_: object) -> float:  # type: ignore[override]
        return 0.0


@pytest.mark.parametrize(
    ("spoiled", "happens"),
    [
        (lambda samples: samples.view(WithoutMean), ["agrees", "off", "agrees", "agrees"]),
        (lambda samples: samples.astype(np.float32).astype(np.float64), ["off", "off", "agrees", "off"]),
    ],
    ids=["an offset in the running sum", "samples of 24 bits"],
)
def test_lost_digits_would_be_seen(monkeypatch: pytest.MonkeyPatch, spoiled: Any, happens: list[str]):
    monkeypatch.setattr(allan_variance, "allan", lambda samples, period: allan(spoiled(samples), period))
    assert [one.happens for one in allan_variances()] == happens
