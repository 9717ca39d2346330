"""The models' period against that at which they run."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.sensors.models.parameters import ImuParameters
from periph_sim.sensors.models.period import check_period
from periph_sim.sensors.models.quantity import BadParameter


@pytest.mark.parametrize(("period", "shown"), [(10.0, "10.000000 s"), (0.01, "10.000 ms"), (0.0200201, "20.020 ms")])
def test_another_period_is_told_with_both_values(period: float, shown: str) -> None:
    with pytest.raises(BadParameter) as refused:
        check_period(ImuParameters(period=period), Fraction(1, 50), "once a round")
    assert str(refused.value) == (
        f"imu.period: the models' period is {shown}, but they run once a round, every 20.000 ms; "
        "make them the same, or every rate is off by their ratio"
    )


@pytest.mark.parametrize("period", [0.02, 0.02002, 0.01998])
def test_a_thousandth_is_what_clocks_may_differ_by(period: float) -> None:
    check_period(ImuParameters(period=period), Fraction(1, 50), "once a round")
