"""Sensor parameters in TOML; errors are refused with file, line, name, value and range."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import load, named, text_of
from periph_sim.scene.case.model import BadCase

GOOD = """\
period = "10 ms"
wrap = "unwrapped"

[gyroscope]
bias = "-1, 2.5, 0 deg/s"
cross_axis = "1.5 %"
bits = 14
mounting = [2, -1, 3]
rates = "corrected"

[accelerometer]
lever_arm = "10, 5, -2 cm"
bias = "9.81, 0, 0 m/s^2"

[magnetometer]
earth_field = "20, -4, 15 uT"
spherical = "rotation"
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "sensors.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_changes_only_the_parameters_that_it_has(tmp_path: Path) -> None:
    imu = load(write(tmp_path, GOOD))
    assert (imu.period, imu.wrap) == (0.01, "unwrapped")
    assert imu.gyroscope.bias == (-1.0, 2.5, 0.0)
    assert (imu.gyroscope.bits, imu.gyroscope.mounting, imu.gyroscope.rates) == (14, (2, -1, 3), "corrected")
    assert imu.gyroscope.cross_axis == pytest.approx(0.015)
    assert imu.accelerometer.lever_arm == pytest.approx((0.1, 0.05, -0.02))
    assert imu.accelerometer.bias == pytest.approx((1.0, 0.0, 0.0))
    assert imu.magnetometer.earth_field == pytest.approx((0.2, -0.04, 0.15))
    assert imu.gyroscope.scale == ImuParameters().gyroscope.scale


def test_a_shipped_set_is_given_by_name_and_a_file_by_path(tmp_path: Path) -> None:
    assert named("table_5_1").gyroscope.bias == (-3.1041, 3.5997, 0.0438)
    assert named(str(write(tmp_path, GOOD))) == load(tmp_path / "sensors.toml")
    with pytest.raises(
        BadCase, match="there is no parameter set 'table_5'; give the path of a TOML file, or a shipped"
    ):
        named("table_5")


def test_an_empty_file_is_table_4_1(tmp_path: Path) -> None:
    assert load(write(tmp_path, "")) == ImuParameters()


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("period = 0.02", 1, "period: 0.02 has no unit; expected a number in s or ms or us or ns, 1e-06 to 3600 s"),
        ('\nperiod = "0 s"', 2, "period: 0 s is out of range; expected 1e-06 to 3600 s"),
        ('period = "20 m"', 1, "period: '20 m' has the unit 'm'; expected a number in s"),
        ('period = "ten ms"', 1, "period: 'ten ms' is not a number"),
        ("[gyro]", 1, "there is no parameter 'gyro'; did you mean gyroscope?"),
        ("gyroscope = 3", 1, "gyroscope: expected a table, but it is 3"),
        ('[gyroscope]\nbais = "1, 2, 3 deg/s"', 2, "there is no parameter 'gyroscope.bais'; did you mean"),
        ('[gyroscope]\n\nbias = "1, 2 deg/s"', 3, "gyroscope.bias: expected three numbers x, y, z, but it is 2"),
        (
            '[gyroscope]\nbias = "1, 2, 3 V"',
            2,
            "gyroscope.bias: '1, 2, 3 V' has the unit 'V'; expected three numbers in deg/s",
        ),
        ("[gyroscope]\nbias = [1, 2, 3]", 2, "gyroscope.bias: [1, 2, 3] has no unit"),
        ('[gyroscope]\nbias = "1, nan, 3 deg/s"', 2, "gyroscope.bias.y: expected a finite number, -2000 to 2000 deg/s"),
        ('[gyroscope]\nbias = "1, 2, -inf deg/s"', 2, "gyroscope.bias.z: expected a finite number"),
        ("[gyroscope]\nbits = 99", 2, "gyroscope.bits: 99 bit is out of range; expected 2 to 16 bit"),
        ('[gyroscope]\nbits = "nan bit"', 2, "gyroscope.bits: expected a finite number"),
        ("[gyroscope]\nbits = true", 2, "gyroscope.bits: True is not a number"),
        (f"[gyroscope]\nbits = 1{'0' * 400}", 2, "gyroscope.bits: it is too large a number"),
        ('[gyroscope]\nrates = ["corrected"]', 2, "gyroscope.rates: expected one of as built, corrected"),
        ("[gyroscope]\nmounting = [1, 1, 3]", 2, "gyroscope.mounting: expected 1, 2 and 3 once each"),
    ],
)
def test_errors_in_a_file_are_refused_with_their_line(tmp_path: Path, text: str, line: int, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(BadCase) as refused:
        load(path)
    assert str(refused.value).startswith(f"{path}, line {line}: {message}")


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadCase, match=r"cannot be read .* give the path of a parameter file"):
        load(tmp_path / "none.toml")
    with pytest.raises(BadCase, match="it is not TOML"):
        load(write(tmp_path, "period = = 1"))


@given(name=st.sampled_from(["bias", "scale", "bits", "rates", "mounting"]), value=st.text(max_size=12))
def test_any_text_is_accepted_or_refused_in_one_sentence(tmp_path_factory, name: str, value: str) -> None:
    import json

    path = write(tmp_path_factory.getbasetemp(), f"[gyroscope]\n{name} = {json.dumps(value)}\n")
    try:
        load(path)
    except BadCase as error:
        assert str(error).startswith(str(path))


THREE = st.tuples(*[st.floats(-16, 16)] * 3)


@settings(deadline=None, max_examples=40)
@given(THREE, st.floats(1e-6, 3600), st.sampled_from(["nearest", "floor"]), st.integers(2, 16), st.floats(-0.5, 0.5))
def test_a_written_set_is_read_back_exactly(tmp_path_factory, bias, period, rounding, bits, cross_axis):
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
