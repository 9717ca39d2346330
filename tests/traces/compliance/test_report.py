"""Compliance reports: rows, notes, the overall verdict, the assertion, JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.compliance import Mode, Verdict, check
from periph_sim.traces.compliance.limits import LIMITS, Bounds
from periph_sim.traces.compliance.report import as_json, limit_text
from tests.refusals import refusal
from tests.traces.compliance.bus import EASY, Odd, drawn, sampled
from tests.traces.decode.drawing import drawn as lines
from tests.unwrapped import unwrapped

TRACES = Path(__file__).parents[3] / "traces"
STANDARD = EASY[Mode.STANDARD]
LATE = STANDARD.but(odd={(3, 1): Odd(data=(4_000,))})  # a bit that the target sends


def judged(bus, mode=Mode.STANDARD):
    return check(drawn(bus), "SCL", "SDA", mode)


def test_every_limit_has_a_row_in_the_order_of_the_specification():
    assert [row.limit for row in judged(STANDARD).rows] == list(LIMITS)
    symbols = "fSCL tHD;STA tLOW tHIGH tSU;STA tHD;DAT tSU;DAT tr tf tSU;STO tBUF tVD;DAT tVD;ACK tSP"
    assert " ".join(limit.symbol for limit in LIMITS) == symbols


def test_limits_agree_with_the_specification():
    """The limits are typed a second time, in nanoseconds: least or most of standard, fast and fast-plus."""
    least = {
        "fSCL": (10_000, 2_500, 1_000),
        "tHD;STA": (4_000, 600, 260),
        "tLOW": (4_700, 1_300, 500),
        "tHIGH": (4_000, 600, 260),
        "tSU;STA": (4_700, 600, 260),
        "tHD;DAT": (0, 0, 0),
        "tSU;DAT": (250, 100, 50),
        "tr": (None, 20, None),
        "tSU;STO": (4_000, 600, 260),
        "tBUF": (4_700, 1_300, 500),
    }
    most = {
        "tHD;DAT": (3_450, 900, None),
        "tr": (1_000, 300, 120),
        "tf": (300, 300, 120),
        "tVD;DAT": (3_450, 900, 450),
        "tVD;ACK": (3_450, 900, 450),
        "tSP": (None, 50, 50),
    }
    nothing = (None, None, None)
    for limit in LIMITS:
        assert tuple(limit.bounds[mode].least for mode in Mode) == least.get(limit.symbol, nothing), limit.symbol
        assert tuple(limit.bounds[mode].most for mode in Mode) == most.get(limit.symbol, nothing), limit.symbol


@pytest.mark.parametrize(
    ("bounds", "text"),
    [
        (Bounds(4_700), "min 4.7 us"),
        (Bounds(None, 50), "max 50 ns"),
        (Bounds(0, 3_450), "0 to 3.45 us"),
        (Bounds(20, 300), "20 to 300 ns"),
        (Bounds(), "-"),
    ],
)
def test_limits_as_text(bounds, text):
    assert limit_text(bounds) == text


def test_the_table_has_time_place_and_party():
    text = str(judged(LATE))
    measured, rule = (line for line in text.splitlines() if line.startswith(" tVD;DAT"))
    assert "max 3.45 us" in measured and " 4 us" in measured and "FAIL, 1 of " in measured
    assert text.splitlines()[0] == "bus: I2C limits of mode standard, times exact"
    assert text.splitlines()[-1] == "FAIL: tHD;DAT, tVD;DAT"
    (place,) = judged(LATE).row("tVD;DAT").worst
    assert rule.split("  ")[1] == "SCL fall -> SDA valid" and f" {place.at / 10**9:.9f} s  target" in rule


def test_the_worst_place_is_the_one_furthest_beyond_the_limit():
    report = judged(
        STANDARD.but(odd={(1, 1): Odd(data=(3_500,)), (3, 1): Odd(data=(5_000,)), (3, 3): Odd(data=(4_000,))})
    )
    assert [place.length for place in report.row("tVD;DAT").worst] == [5_000, 4_000, 3_500]


def test_a_maximum_does_not_apply_where_scl_is_stretched():
    """By a footnote, data may change late in a low phase that the device stretches if the set-up time is kept."""
    stretched = STANDARD.but(odd={(3, 1): Odd(data=(19_000,), low=20_000)})
    report = judged(stretched)
    assert report.verdict is Verdict.PASS and report.row("tVD;DAT").excused == 1
    assert "note: beyond a maximum where it does not bind: tHD;DAT 1, tVD;DAT 1" in str(report)
    report = judged(STANDARD.but(odd={(3, 1): Odd(data=(19_800,), low=20_000)}))
    assert report.symbols_with(Verdict.FAIL) == ["tSU;DAT"]


def test_a_low_phase_up_to_a_tenth_longer_is_not_a_stretch():
    for low, fails in ((7_150, ["tHD;DAT", "tVD;DAT"]), (7_151, [])):
        report = judged(STANDARD.but(odd={(3, 1): Odd(data=(4_000,), low=low)}))
        assert report.symbols_with(Verdict.FAIL) == fails


def test_maxima_in_possibly_stretched_phases_are_undecidable():
    """Sampled at 10 MHz, it is unknown if a low phase of 7.2 us is more than a tenth longer than one of 6.5 us."""
    odd = {(3, 1): Odd(data=(4_000,), low=7_200), (3, 3): Odd(data=(4_000,)), (3, 5): Odd(data=(4_000,), low=20_000)}
    report = check(sampled(drawn(STANDARD.but(odd=odd)), 10**7))
    row = report.row("tVD;DAT")
    assert (row.failed, row.undecided, row.excused) == (1, 1, 1) and row.verdict is Verdict.FAIL
    text = unwrapped(str(report))
    assert "FAIL, 1 of " in text and ", 1 undecidable" in text
    assert "note: a maximum that binds only where SCL is not stretched, which these samples do not tell: " in text
    odd.pop((3, 3))
    report = check(sampled(drawn(STANDARD.but(odd=odd)), 10**7))
    assert report.verdict is Verdict.UNDECIDABLE and "tVD;DAT" in report.symbols_with(Verdict.UNDECIDABLE)


def test_an_assertion_names_the_worst_rows_and_places():
    judged(STANDARD).assert_compliant(strict=True)
    text = refusal(AssertionError, judged(LATE).assert_compliant)
    assert "bus does not keep the I2C limits of mode standard" in text
    assert "tVD;DAT (SCL fall -> SDA valid) fail: max 3.45 us, 1 of " in text
    assert "4 us at 0.000" in text and "driven by the target" in text
    assert "tLOW" not in text


def test_undecidable_rows_raise_only_with_strict():
    report = check(sampled(drawn(STANDARD.but(low=5_000, high=5_000)), 10**6), "SCL", "SDA", "standard")
    assert report.verdict is Verdict.UNDECIDABLE
    report.assert_compliant()
    with pytest.raises(AssertionError, match=r"fSCL .* undecidable at this sample rate: min 10 us"):
        report.assert_compliant(strict=True)
    assert str(report).splitlines()[-1].startswith("UNDECIDABLE at this sample rate: fSCL, ")


def test_a_trace_without_edges_is_not_judged():
    report = check(lines("SCL ----\nSDA ----"), mode=Mode.STANDARD)
    assert report.verdict is Verdict.NOT_JUDGED
    assert str(report).splitlines()[-1] == "NOT JUDGED: nothing was measured"


def test_simultaneous_changes_are_reported():
    report = check(formats.read(TRACES / "imu_round.sr"))
    assert report.shared == 0 and "both lines" not in str(report)
    report = check(sampled(drawn(STANDARD.but(data=0)), 10**6))
    assert report.shared > 0 and f"both lines change at once at {report.shared} positions" in str(report)


def test_no_limit_passes_if_pulses_can_be_missed():
    """A 100 kHz bus is sampled at 170 kHz, so pulses can be shorter than a sample. The report says so."""
    report = check(sampled(drawn(STANDARD.but(low=5_000, high=5_000)), 170_000, phase=3))
    assert not report.symbols_with(Verdict.PASS) and not report.symbols_with(Verdict.FAIL)
    assert "may be shorter than a sample" in str(report)


def test_json_has_every_row_with_times_in_seconds():
    found = json.loads(json.dumps(as_json(judged(LATE))))
    assert (found["capture"], found["mode"], found["verdict"]) == ("bus", "standard", "fail")
    row = next(row for row in found["rows"] if row["symbol"] == "tVD;DAT")
    assert (row["limit_max_ns"], row["max_s"], row["failed"], row["verdict"]) == (3_450, 4e-6, 1, "fail")
    assert row["worst"][0]["party"] == "target"
    assert len(found["rows"]) == len(LIMITS)


@pytest.mark.parametrize(("scl", "sda"), [("CLK", "SDA"), ("SCL", 7)])
def test_a_missing_channel_is_rejected(scl, sda):
    with pytest.raises(LookupError, match="there is no channel"):
        check(drawn(STANDARD), scl, sda)
