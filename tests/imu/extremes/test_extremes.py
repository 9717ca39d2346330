"""What happens at every extreme, and from which input on: each row of the report."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import pytest

from periph_sim.imu.extremes import NAMES, OUTSIDE, SWEEPS, USUAL, ExtremesReport, report
from periph_sim.imu.extremes.frames import codes_of
from periph_sim.imu.extremes.plot import picture
from periph_sim.imu.extremes.sweeps import spinning
from periph_sim.imu.extremes.text_report import as_json, text

# extreme: what happens and from where on, in float64, float32, q16, q16 saturating, q12. Places to a part in 500.
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
        ("saturates", 32_768),  # deg/s are the largest number of Q16, and cross-axis sensitivity takes part of them
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
        ("off", 72.818),  # 2**18 s: the next float32 is 1/32 s on
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
def test_what_happens_and_from_where_on(whole: ExtremesReport, extreme: str) -> None:
    found = whole.findings_for(extreme)
    assert [one.arithmetic for one in found] == list(USUAL)
    for one, (happens, begins) in zip(found, EXPECTED[extreme], strict=True):
        assert one.happens == happens, one
        assert one.begins == (
            begins if begins is None else pytest.approx(begins, rel=0.02 if begins < 20 else 0.002)
        ), one


def test_parameters_that_are_no_numbers_are_refused_by_name(whole: ExtremesReport) -> None:
    refused = [one for one in whole.findings if one.extreme.startswith("parameter:")]
    assert len(refused) == 5 and all(one.happens == "refused" for one in refused)
    assert {one.note.split(":")[0] for one in refused} >= {"imu.period", "gyroscope.bias.y", "accelerometer.scale"}


def test_rho_squared_overflows_before_it_shows_nowhere_but_in_coarse_formats(whole: ExtremesReport) -> None:
    """Q16: S leaves the format at 85.65 gauss, the squares at 181; Q12: the squares at 724, and IQmag never."""
    squares, magnitudes = whole.findings_for("field strength"), whole.findings_for("field strength, IQmag")
    assert squares[2].overflows == squares[2].begins
    assert squares[4].overflows == pytest.approx(2**9.5, rel=0.001)
    assert magnitudes[4].overflows is None


def test_a_wrapped_code_is_a_wrong_sign_a_saturated_one_is_not(whole: ExtremesReport) -> None:
    wraps, saturates = whole.findings_for("roll rate")[2:4]
    assert wraps.worst is not None and wraps.worst > 60_000
    assert (
        saturates.worst is not None and saturates.worst <= 1 and saturates.overflows == pytest.approx(2282.5, rel=1e-3)
    )


@pytest.mark.parametrize("rate", [40_000, 114_000, 1_000_000])
def test_saturating_q16_stops_cross_axis_at_what_its_largest_rate_makes(rate: float) -> None:
    """No mistake of ours: IQrsmpy leaves 32768 deg/s, and S takes 2 % of them. Float has its own full scale there."""
    sample = spinning(rate)
    saturated, reference = (
        codes_of(name, sample.imu, sample.counts[:, None]).codes[:3, 0].tolist()
        for name in ("q16 saturating", "float64")
    )
    assert saturated == [32767, 9472, 9422]
    assert reference[1] == min(32767, round(14.375 * (3.6 + 0.02 * (rate - 3.10 + 0.04))))


def test_time_drifts_by_what_the_format_makes_of_ts(whole: ExtremesReport) -> None:
    notes = {one.arithmetic: one.note for one in whole.findings_for("time in seconds, 30 days")}
    assert notes["q16"] == "+18.5 s a day" and notes["float64"] == "+0 s a day"  # 1311 / 65536
    assert notes["float32"].endswith("halts at 145.6 h")  # 2**19 s: the next is 1/16 s on, Ts rounds to 0


def test_the_report_as_text_json_and_picture(whole: ExtremesReport) -> None:
    shown = text(whole)
    assert all(sweep.name in shown for sweep in SWEEPS) and "wraps" in shown and "85.65" in shown
    told = json.loads(json.dumps(as_json(whole), allow_nan=False))
    assert {one["name"] for one in told["arithmetics"]} == set(USUAL)
    assert told["float32_without_fastrts_cycles"][0] > 3 * told["arithmetics"][1]["cycles"][1]
    assert "float32 with the compiler's library instead" in shown
    q16 = next(one for one in told["arithmetics"] if one["name"] == "q16")
    assert sum(low for low, _ in q16["parts"].values()) == q16["cycles"][0]
    assert q16["not_explained_cycles"][1] + q16["cycles"][0] == told["measured_cycles"] == 37_500
    root = ElementTree.fromstring(picture(whole))
    words = {node.text for node in root.iter() if node.tag.endswith("text")}
    assert set(USUAL) <= words and "measured: 250 us" in words
    assert picture(whole) == picture(whole)


def test_only_some_and_each_arithmetic_once() -> None:
    one = report(("float64", "float32", "float64"), only=("roll rate",), samples=100)
    assert one.names == ("float64", "float32") and {found.extreme for found in one.findings} == {"roll rate"}


def test_one_count_of_roll_is_four_lsb_of_rate(whole: ExtremesReport) -> None:
    """1e-4 rad in 20 ms are 0.2865 deg/s, times 14.375."""
    notes = {one.arithmetic: one.note for one in whole.findings_for("smallest LSB")}
    assert notes["float64"].endswith("one count of roll is 4.12 LSB of rate")
    assert notes["q12"].endswith("one count of roll is 0.00 LSB of rate")
