"""Parameter sets as text: what is written reads back to the last bit."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import load, text_of

THREE = st.tuples(*[st.floats(-16, 16)] * 3)


@settings(deadline=None, max_examples=40)
@given(THREE, st.floats(1e-6, 3600), st.sampled_from(["nearest", "floor"]), st.integers(2, 16), st.floats(-0.5, 0.5))
def test_a_set_reads_back_to_the_last_bit(tmp_path_factory, bias, period, rounding, bits, cross_axis):
    path = tmp_path_factory.mktemp("set") / "set.toml"
    imu = ImuParameters(period=period)
    accelerometer = replace(imu.accelerometer, bias=bias, rounding=rounding, bits=bits, cross_axis=cross_axis)
    imu = replace(imu, accelerometer=accelerometer)
    path.write_text(text_of(imu), encoding="utf-8")
    assert load(path) == imu


def test_table_4_1_as_text():
    lines = text_of(ImuParameters()).splitlines()
    assert lines[:4] == ['period = "0.02 s"', 'wrap = "as built"', "", "[accelerometer]"]
    assert 'bias = "-3.1, 3.6, 0.04 deg/s"' in lines
    assert "bits = 12" in lines and "cross_axis = 0.002" in lines and "mounting = [1.0, 2.0, 3.0]" in lines
