"""Parameters have units, sources and ranges, and impossible values are refused."""

from __future__ import annotations

from fractions import Fraction
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.models.imu import Imu
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.models.quantity import BadParameter, Quantity, described, parameters_of
from periph_sim.imu.numeric.float64 import Float64
from periph_sim.imu.numeric.q import DoesNotFit, Q

SETS = [AccelerometerParameters, GyroscopeParameters, MagnetometerParameters, ImuParameters]


# Table 4.1, typed again from the dissertation: scale, cross-axis sensitivity, converter, full scale, noise density.
TABLE_4_1 = [
    (256, 0.01, (-512, 511), 2, (0.16e-4, 0.16e-4, 0.15e-4)),
    (14.375, 0.02, (-32768, 32767), 2000, (0.05e-3, 0.12e-3, 0.04e-3)),
    (660, 0.002, (-2048, 2047), 2.5, (0.58e-6, 0.77e-6, 0.20e-6)),
]


def test_defaults_are_table_4_1() -> None:
    imu = ImuParameters()
    assert imu.accelerometer.bias == (-0.02, 0.02, -0.00)
    assert imu.gyroscope.bias == (-3.10, 3.60, 0.04)
    assert imu.magnetometer.hard_iron == (-0.16, 0.17, -0.02)
    assert imu.period == 0.02
    chips = (imu.accelerometer, imu.gyroscope, imu.magnetometer)
    assert [(of.scale, of.cross_axis, of.limits, of.full_scale, of.noise_density) for of in chips] == TABLE_4_1


def test_every_parameter_has_a_source_and_every_number_a_range() -> None:
    rows = list(described(ImuParameters()))
    assert len({name for name, *_ in rows}) == len(rows) > 30
    assert all(source for *_, source in rows)
    assert ("gyroscope.bias", (-3.10, 3.60, 0.04), "deg/s", "dissertation, Table 4.1") in rows


@pytest.mark.parametrize("kind", SETS, ids=lambda kind: kind.__name__)
@given(data=st.data())
def test_values_that_are_no_numbers_or_out_of_range_are_refused(kind, data) -> None:
    numbers = [one for one in parameters_of(kind) if isinstance(one.says, Quantity)]
    one = data.draw(st.sampled_from(numbers))
    bad = data.draw(st.sampled_from([nan, inf, -inf, one.says.high * 2 + 1, one.says.low - 1, "1", None, True]))
    vector = one.kind not in (float, int)
    with pytest.raises(BadParameter) as refused:
        kind(**{one.name: (bad, bad, bad) if vector else bad})
    assert refused.value.name.startswith(f"{kind.__name__.removesuffix('Parameters').lower()}.{one.name}")
    if isinstance(bad, float):
        assert one.says.span in str(refused.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GyroscopeParameters(bias=(1.0, 2.0)), "gyroscope.bias: expected three numbers x, y, z, but it is 2"),
        (
            lambda: GyroscopeParameters(bias=[1.0, 2.0, 3.0]),
            "gyroscope.bias: expected three numbers x, y, z, but it is 3",
        ),
        (
            lambda: GyroscopeParameters(bits=15.5),
            "gyroscope.bits: expected a whole number, 2 to 16 bit, but it is 15.5",
        ),
        (
            lambda: GyroscopeParameters(rates="right"),
            "gyroscope.rates: expected one of as built, corrected, but it is 'right'",
        ),
        (
            lambda: GyroscopeParameters(mounting=(1, 1, 3)),
            "gyroscope.mounting: expected 1, 2 and 3 once each, with a sign",
        ),
        (lambda: ImuParameters(period=0), "imu.period: 0 s is out of range; expected 1e-06 to 3600 s"),
        (lambda: ImuParameters(gyroscope=AccelerometerParameters()), "imu.gyroscope: expected a set of parameters"),
    ],
)
def test_a_wrong_parameter_is_reported_with_name_value_and_range(make, message: str) -> None:
    with pytest.raises(BadParameter) as refused:
        make()
    assert str(refused.value).startswith(message)


@pytest.mark.parametrize(("period", "shown"), [(10.0, "10.000000 s"), (0.01, "10.000 ms"), (0.0200201, "20.020 ms")])
def test_another_period_is_reported_with_both_values(period: float, shown: str) -> None:
    with pytest.raises(BadParameter) as refused:
        ImuParameters(period=period).check_period(Fraction(1, 50), "once a round")
    assert str(refused.value) == (
        f"imu.period: the models' period is {shown}, but they run once a round, every 20.000 ms; "
        "make them the same, or every rate is off by their ratio"
    )


def test_a_period_whose_inverse_shrinks_in_q16_is_refused() -> None:
    """1/3600 is 18.2 / 2**16: Q16 has 18, so every rate would be 1.1 % low."""
    for a, period in ((Q(16), 0.02), (Q(16), 100.0), (Q(16), 640.0), (Float64(), 3600.0)):
        assert Imu(a, ImuParameters(period=period)).a is a
    with pytest.raises(DoesNotFit, match=r"^derivative: 1 / period: 0.000277778 is 1.12% off in q16; take more"):
        Imu(Q(16), ImuParameters(period=3600.0))
