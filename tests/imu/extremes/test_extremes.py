"""The report of extremes: each row has the expected effect and the first input with it."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import pytest

from periph_sim.imu.extremes import NAMES, OUTSIDE, SWEEPS, USUAL, ExtremesReport, report
from periph_sim.imu.extremes.frames import codes_of
from periph_sim.imu.extremes.plot import picture
from periph_sim.imu.extremes.sweeps import spinning
from periph_sim.imu.extremes.text_report import as_json, text

# extreme: effect and first input with it, in float64, float32, q16, q16 saturating, q12. Inputs to a part in 500.
EXPECTED: dict[str, tuple[tuple[str, float | None], ...]] = {
    "pitch through 90, as built": (("off", 90), ("off", 90), ("wraps", 90), ("saturates", 90), ("off", 90)),
    "pitch through 90, corrected": (("off", 90),) * 5,
    "yaw through 180, as built": (("off", 180), ("off", 180), ("wraps", 180), ("saturates", 180), ("off", 180)),
    "yaw through 180, unwrapped": (("agrees", None),) * 5,
    "yaw beyond int16": (("off", 187.744),) * 5,  # 3.27675 rad
    "yaw step in one sample": (
        ("full scale", 45.59),
        ("agrees", None),
        ("wraps", 45.59),
        ("agrees", None),
        ("agrees", None),
    ),
    "roll rate": (("full scale", 2282.5), ("agrees", None), ("wraps", 2282.5), ("agrees", None), ("agrees", None)),
    "roll rate beyond frames": (
        ("full scale", 2282.5),
        ("agrees", None),
        ("wraps", 2282.5),
        ("saturates", 32_768),  # the largest rate in Q16 is 32768 deg/s, of which cross-axis sensitivity takes a part
        ("wraps", 36_472),  # 2**19 LSB
    ),
    "acceleration": (("full scale", 1.9456), *((("agrees", None),) * 4)),
    "Ts jitter": (("off", 0.0098),) * 5,
    "field along z, four-quadrant": (("agrees", None), ("NaN", 0.0), *((("agrees", None),) * 3)),
    "field along z, plain": (("NaN", 0.0), ("NaN", 0.0), *((("agrees", None),) * 3)),
    "field along z, rotation": (("agrees", None),) * 5,
    "no field, plain": (("NaN", 0.0), ("NaN", 0.0), *((("agrees", None),) * 3)),
    "yaw of the field, plain": (("off", 90), ("off", 90), ("wraps", 90), ("saturates", 90), ("wraps", 89.95)),
    "field strength": (
        ("full scale", 5.349),
        ("agrees", None),
        ("wraps", 85.65),
        ("agrees", None),
        ("wraps", 724.08),
    ),
    "field strength, IQmag": (
        ("full scale", 5.349),
        ("agrees", None),
        ("wraps", 85.65),
        ("agrees", None),
        ("agrees", None),
    ),
    "lever arm, steady": (*((("agrees", None),) * 4), ("off", 24.18)),
    "lever arm, reversing": (("agrees", None), ("agrees", None), ("wraps", 18.0), ("saturates", 18.0), ("off", 5.18)),
    "lost or doubled frame": (
        ("full scale", 1142),
        ("full scale", 1142),
        ("wraps", 1142),
        ("saturates", 1142),
        ("full scale", 1143),
    ),
    "division by Ts = 0": (("NaN", 0), ("NaN", 0), ("saturates", 0), ("saturates", 0), ("saturates", 0)),
    "time in seconds, 30 days": (
        ("agrees", None),
        ("off", 72.818),  # 2**18 s, where the next float32 is 1/32 s later
        ("wraps", 9.1022),  # 2**15 s
        ("saturates", 9.1022),
        ("wraps", 145.636),  # 2**19 s
    ),
    "smallest LSB": (*((("agrees", None),) * 4), ("off", None)),
}


@pytest.fixture(scope="module")
def whole() -> ExtremesReport:
    return report(samples=200)


def test_the_list_is_complete(whole: ExtremesReport) -> None:
    assert set(EXPECTED) | {"parameters", *OUTSIDE} == set(NAMES)
    assert {one.extreme for one in whole.findings if one.arithmetic != "every"} == set(EXPECTED)
    assert whole.names == USUAL


@pytest.mark.parametrize("extreme", EXPECTED)
def test_effect_and_first_input_of_each_extreme(whole: ExtremesReport, extreme: str) -> None:
    found = whole.findings_for(extreme)
    assert [one.arithmetic for one in found] == list(USUAL)
    for one, (happens, begins) in zip(found, EXPECTED[extreme], strict=True):
        assert one.happens == happens, one
        assert one.begins == (
            begins if begins is None else pytest.approx(begins, rel=0.02 if begins < 20 else 0.002)
        ), one


def test_parameters_that_are_not_finite_are_refused_by_name(whole: ExtremesReport) -> None:
    refused = [one for one in whole.findings if one.extreme.startswith("parameter:")]
    assert len(refused) == 5 and all(one.happens == "refused" for one in refused)
    assert {one.note.split(":")[0] for one in refused} >= {"imu.period", "gyroscope.bias.y", "accelerometer.scale"}


def test_overflow_of_the_squared_field_strength(whole: ExtremesReport) -> None:
    """In Q16, S overflows at 85.65 gauss and the squares at 181; in Q12 the squares overflow at 724, IQmag never."""
    squares, magnitudes = whole.findings_for("field strength"), whole.findings_for("field strength, IQmag")
    assert squares[2].overflows == squares[2].begins
    assert squares[4].overflows == pytest.approx(2**9.5, rel=0.001)
    assert magnitudes[4].overflows is None


def test_a_wrapped_code_has_the_wrong_sign_and_a_saturated_one_has_not(whole: ExtremesReport) -> None:
    wraps, saturates = whole.findings_for("roll rate")[2:4]
    assert wraps.worst is not None and wraps.worst > 60_000
    assert (
        saturates.worst is not None and saturates.worst <= 1 and saturates.overflows == pytest.approx(2282.5, rel=1e-3)
    )


@pytest.mark.parametrize("rate", [40_000, 114_000, 1_000_000])
def test_in_saturating_q16_cross_axis_codes_are_limited_by_the_largest_rate(rate: float) -> None:
    """IQrsmpy limits the rate to 32768 deg/s, of which S takes 2 %; float64 reaches its own full scale."""
    sample = spinning(rate)
    saturated, reference = (
        codes_of(name, sample.imu, sample.counts[:, None]).codes[:3, 0].tolist()
        for name in ("q16 saturating", "float64")
    )
    assert saturated == [32767, 9472, 9422]
    assert reference[1] == min(32767, round(14.375 * (3.6 + 0.02 * (rate - 3.10 + 0.04))))


def test_time_drifts_by_the_rounding_of_ts_in_a_format(whole: ExtremesReport) -> None:
    notes = {one.arithmetic: one.note for one in whole.findings_for("time in seconds, 30 days")}
    assert notes["q16"] == "+18.5 s a day" and notes["float64"] == "+0 s a day"  # 1311 / 65536
    assert notes["float32"].endswith("halts at 145.6 h")  # 2**19 s, where Ts is below half a unit


def test_the_report_as_text_json_and_picture(whole: ExtremesReport) -> None:
    shown = text(whole)
    assert all(sweep.name in shown for sweep in SWEEPS) and "wraps" in shown and "85.65" in shown
    found = json.loads(json.dumps(as_json(whole), allow_nan=False))
    assert {one["name"] for one in found["arithmetics"]} == set(USUAL)
    assert found["float32_without_fastrts_cycles"][0] > 3 * found["arithmetics"][1]["cycles"][1]
    assert "float32 with the compiler's library instead" in shown
    q16 = next(one for one in found["arithmetics"] if one["name"] == "q16")
    assert sum(low for low, _ in q16["parts"].values()) == q16["cycles"][0]
    assert q16["not_explained_cycles"][1] + q16["cycles"][0] == found["measured_cycles"] == 37_500
    root = ElementTree.fromstring(picture(whole))
    words = {node.text for node in root.iter() if node.tag.endswith("text")}
    assert set(USUAL) <= words and "measured: 250 us" in words
    assert picture(whole) == picture(whole)


def test_a_report_of_one_extreme_has_each_arithmetic_once() -> None:
    one = report(("float64", "float32", "float64"), only=("roll rate",), samples=100)
    assert one.names == ("float64", "float32") and {found.extreme for found in one.findings} == {"roll rate"}


def test_one_count_of_roll_is_4_lsb_of_rate(whole: ExtremesReport) -> None:
    """1e-4 rad in 20 ms are 0.2865 deg/s, and 14.375 times that in LSB."""
    notes = {one.arithmetic: one.note for one in whole.findings_for("smallest LSB")}
    assert notes["float64"].endswith("one count of roll is 4.12 LSB of rate")
    assert notes["q12"].endswith("one count of roll is 0.00 LSB of rate")
