"""The models' period against that at which they run."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.imu.models.imu import Imu
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.models.period import check_period
from periph_sim.imu.models.quantity import BadParameter
from periph_sim.imu.numeric.float64 import Float64
from periph_sim.imu.numeric.q import DoesNotFit, Q


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


@pytest.mark.parametrize(("period", "refused"), [(0.02, False), (100.0, False), (640.0, False), (3600.0, True)])
def test_a_period_whose_inverse_shrinks_in_q16_is_refused(period: float, refused: bool) -> None:
    """1/3600 is 18.2 / 2**16: Q16 takes 18, and every rate would be 1.1 % low."""
    imu = ImuParameters(period=period)
    if not refused:
        assert Imu(Q(16), imu).a.name == "q16"
        return
    with pytest.raises(DoesNotFit, match=r"^derivative, 1 / period: 0.000277778 is 1.12% off in q16; take more"):
        Imu(Q(16), imu)
    assert Imu(Float64(), imu).a.name == "float64"
