"""Numbers of operations in the equations, and constants that do not fit a format."""

from __future__ import annotations

import pytest

from periph_sim.imu.models.counts import PARTS, Counting, counts_of
from periph_sim.imu.models.imu import Imu
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.numeric.float64 import Float64
from periph_sim.imu.numeric.q import DoesNotFit, Q

RICH = ImuParameters(
    accelerometer=AccelerometerParameters(lever_arm=(0.1, -0.05, 0.02)),
    gyroscope=GyroscopeParameters(rates="corrected", mounting=(2, -1, 3)),
    magnetometer=MagnetometerParameters(board_azimuth=5.0, board_elevation=-3.0),
    wrap="unwrapped",
)


@pytest.mark.parametrize(
    "imu",
    [
        ImuParameters(),
        RICH,
        *(ImuParameters(magnetometer=MagnetometerParameters(spherical=way)) for way in ("plain", "rotation")),
    ],
)
def test_counts_of_the_parts_add_up_to_those_of_a_whole_sample(imu: ImuParameters) -> None:
    a = Counting(Float64())
    model = Imu(a, imu)
    model.step((0.1, 0.2, 0.3), (0.0, 0.0, 0.0), model.silence, model.at_rest)
    whole = a.pop_counts()
    parts = counts_of(imu)
    assert tuple(parts) == PARTS
    assert parts.pop("frame") == {"scaled": 6}
    assert sum((parts[part] for part in parts), start=type(whole)()) == whole


def test_operations_of_one_sample() -> None:
    """A change of these numbers is a change of the model or of its costs."""
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
    ("imu", "bits", "sentence"),
    [
        (
            ImuParameters(period=1e-6),
            16,
            "derivative: 1 / period: 1e+06 does not fit Q16, which ends at 32768; take fewer ",
        ),
        (ImuParameters(period=1.0), 29, "derivative: 6.28319 does not fit Q29, which ends at 4; take fewer "),  # 2 pi
        (ImuParameters(magnetometer=MagnetometerParameters(scale=1e5)), 16, "magnetometer: 100000 does not fit Q16"),
        (ImuParameters(accelerometer=AccelerometerParameters(scale=1e5)), 16, "accelerometer: 100000 does not fit Q16"),
    ],
)
def test_a_constant_that_does_not_fit_a_format_is_refused_with_its_part(
    imu: ImuParameters, bits: int, sentence: str
) -> None:
    with pytest.raises(DoesNotFit) as caught:
        Imu(Q(bits), imu)
    assert str(caught.value).startswith(sentence)
