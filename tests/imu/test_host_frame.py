"""From motion to the 16-bit counts of a host frame: scales, rounding, and values out of range."""

from __future__ import annotations

from fractions import Fraction
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.host_frame import LEAST, MOST, Encoding, MotionFrames
from periph_sim.imu.motion import VALUES, BadMotion, pieces, sines, static
from periph_sim.imu.motion.quantities import six_values
from tests.reachable import held

SIX = st.lists(st.floats(-12, 12), min_size=6, max_size=6)


def frames(motion, encoding: Encoding) -> MotionFrames:
    return MotionFrames(motion, encoding, Fraction(2, 1000), Fraction(20, 1000))


def test_default_scales_are_a_tenth_of_a_milliradian_and_a_milli_g():
    counts, beyond = Encoding().counts([0.1, -0.2, pi, 1.0, -1.0, 0.0005])
    assert counts == (1000, -2000, 31416, 1000, -1000, 0)  # half a count is rounded to even
    assert not beyond


@given(SIX)
def test_counts_are_rounded_and_only_values_out_of_range_saturate_or_wrap(values: list[float]):
    saturated, beyond = Encoding(beyond="saturate").counts(values)
    wrapped, also = Encoding(beyond="wrap").counts(values)
    assert beyond == also
    for name, value, scale, one, other in zip(VALUES, values, six_values(Encoding()), saturated, wrapped, strict=True):
        assert abs(one - value / scale) <= 0.5 + 1e-9 if name not in beyond else one in (LEAST, MOST)
        assert name in beyond or one == other
        assert (other - round(value / scale)) % 0x10000 == 0
        assert LEAST <= other <= MOST


def test_a_value_out_of_range_is_refused_with_its_name_range_and_advice():
    with pytest.raises(BadMotion) as caught:
        frames(static.motion(static.Settings(theta=-3.3)), Encoding())(3)
    assert str(caught.value) == (
        "frame 3, due at 0.062 s: theta is -3.3, which is -33000 counts of 0.0001; expected -3.2768 to 3.2767, "
        'or another scale, or beyond = "saturate" or "wrap"'
    )


@pytest.mark.parametrize(("value", "saturated"), [(1e308, MOST), (-1e308, LEAST)])
def test_a_value_whose_count_exceeds_any_float(value: float, saturated: int):
    values = [value, 0.0, 0.0, 0.0, 0.0, 0.0]
    with pytest.raises(BadMotion, match=r"^phi is -?1e\+308, which is -?inf counts of 0.0001; expected "):
        Encoding().counts(values)
    assert Encoding(beyond="saturate").counts(values) == ((saturated, 0, 0, 0, 0, 0), ("phi",))
    assert Encoding(beyond="wrap").counts(values) == ((0, 0, 0, 0, 0, 0), ("phi",))


def test_values_out_of_range_are_counted_once_per_frame_by_name():
    motion = static.motion(static.Settings(theta=4.0, psi=-4.0))
    saturating, wrapping = (frames(motion, Encoding(beyond=beyond)) for beyond in ("saturate", "wrap"))
    assert saturating(0)[:3] == (0, MOST, LEAST)
    assert wrapping(0)[:3] == (0, 40000 - 65536, 65536 - 40000)
    saturating(0)
    saturating(1)
    assert saturating.beyond == {"theta": 2, "psi": 2}


def test_frame_n_has_the_motion_at_first_plus_n_periods():
    wave = sines.AngleWave("phi", 1.0, 0.7)
    sent = frames(sines.motion(sines.Settings((wave,))), Encoding())
    month = 30 * 86400 * 50
    for n in (0, 1, 50, month):
        assert sent(n)[0] == round(1e4 * np.sin(2 * pi * 0.7 * (0.002 + n * 0.02)))


@given(st.lists(st.integers(0, 700), min_size=1, max_size=40))
def test_a_frame_does_not_depend_on_earlier_calls(numbers: list[int]):
    """The frames are not all kept."""
    waves = tuple(sines.AngleWave(of, 0.3, frequency) for of, frequency in (("phi", 0.31), ("psi", 0.17)))
    motion = sines.motion(sines.Settings(waves, (sines.AccelerationWave("ax", 0.1, 0.7),)))
    sent = frames(motion, Encoding())
    for number in [*range(130), *numbers]:
        assert sent(number) == frames(motion, Encoding())(number)


def test_only_the_last_frames_are_kept():
    sent = frames(static.motion(static.Settings()), Encoding())
    for number in range(500):
        sent(number)
    before = held(sent)
    for number in range(500, 1500):
        sent(number)
    assert abs(held(sent) - before) < 1000


def test_a_frame_is_refused_or_counted_only_when_it_is_requested():
    """theta increases without limit: it exceeds 16 bits from frame 33 on, and its range of motion after frame 62."""
    rising = pieces.Straight([0.0, 10.0], [[0.0] * 6, [0, 50.0, 0, 0, 0, 0]])
    refusing = frames(rising, Encoding())
    assert [refusing(number)[1] for number in range(33)] == [100 + 1000 * number for number in range(33)]
    for number in (33, 40, 33):
        with pytest.raises(BadMotion, match=rf"^frame {number}, due at [0-9.]+ s: theta is "):
            refusing(number)
    assert refusing(32)[1] == 32100
    saturating = frames(rising, Encoding(beyond="saturate"))
    for number in range(35):
        saturating(number)
    assert saturating.beyond == {"theta": 2}
