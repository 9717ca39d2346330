"""Each limit of each mode: a bus exactly at the limit, one just beyond it, and both with too few samples to decide."""

from __future__ import annotations

import pytest

from periph_sim.traces.compliance import Mode, Verdict, check
from periph_sim.traces.compliance.limits import LIMIT
from tests.traces.compliance.bus import EASY, Bus, Odd, Spike, drawn, sampled

MHZ = 10**6
DATA_BIT, ACK_BIT = (1, 1), (1, 8)  # SDA changes before both bits
LONG = 30_000  # a stretched low phase


def bound(symbol: str, mode: Mode, which: str) -> int:
    found = getattr(LIMIT[symbol].bounds[mode], which)
    assert found is not None
    return found


def bus_with(symbol: str, mode: Mode, off: int) -> Bus:
    """A compliant bus in which one time is `off` nanoseconds longer than its limit."""
    easy = EASY[mode]
    if symbol == "fSCL":
        high = bound(symbol, mode, "least") * 45 // 100
        return easy.but(high=high, low=bound(symbol, mode, "least") - high + off)
    if symbol == "tSU;DAT":  # data can only be so late if SCL is stretched
        return easy.but(odd={DATA_BIT: Odd(data=(LONG - bound(symbol, mode, "least") - off,), low=LONG)})
    if symbol == "tHD;DAT":
        return easy.but(odd={DATA_BIT: Odd(data=(bound(symbol, mode, "most") + off,))})
    if symbol in ("tVD;DAT", "tVD;ACK"):  # the first change is early, so that tHD;DAT is kept
        late = bound(symbol, mode, "most") + off
        return easy.but(odd={DATA_BIT if symbol == "tVD;DAT" else ACK_BIT: Odd(data=(late // 3, 2 * late // 3, late))})
    if symbol == "tSP":
        return easy.but(spike=Spike("SCL", 3, easy.high // 2, bound(symbol, mode, "most") + off))
    name = {"tHD;STA": "hd_sta", "tLOW": "low", "tHIGH": "high", "tSU;STA": "su_sta", "tSU;STO": "su_sto"}
    time = {name.get(symbol, "buf"): bound(symbol, mode, "least") + off}
    period = bound("fSCL", mode, "least")  # kept by the other phase of SCL
    if symbol == "tHIGH":
        time["low"] = period
    if symbol == "tLOW":
        time["high"] = period
    return easy.but(**time)


MINIMA = ("fSCL", "tHD;STA", "tLOW", "tHIGH", "tSU;STA", "tSU;DAT", "tSU;STO", "tBUF")
MAXIMA = ("tHD;DAT", "tVD;DAT", "tVD;ACK", "tSP")
NONE_THERE = {("tSP", Mode.STANDARD), ("tHD;DAT", Mode.FAST_PLUS)}  # no such maximum
CASES = [(symbol, mode) for symbol in MINIMA + MAXIMA for mode in Mode if (symbol, mode) not in NONE_THERE]
ALSO = {"tHD;DAT": ["tHD;DAT", "tVD;DAT"]}  # data that begin to change too late also become valid too late


@pytest.mark.parametrize("mode", Mode)
def test_the_easy_bus_passes_all_limits(mode):
    report = check(drawn(EASY[mode]), "SCL", "SDA", mode)
    assert report.verdict is Verdict.PASS
    assert report.symbols_with(Verdict.FAIL) == report.symbols_with(Verdict.UNDECIDABLE) == []
    assert report.symbols_with(Verdict.NOT_IN_CAPTURE) == ["tr", "tf"]
    assert report.symbols_with(Verdict.NO_LIMIT) == (["tSP"] if mode is Mode.STANDARD else [])
    assert report.symbols_with(Verdict.NOT_SEEN) == ([] if mode is Mode.STANDARD else ["tSP"])


@pytest.mark.parametrize(("symbol", "mode"), CASES)
def test_a_time_exactly_at_its_limit_passes(symbol, mode):
    report = check(drawn(bus_with(symbol, mode, 0)), "SCL", "SDA", mode)
    assert (report.verdict, report.row(symbol).verdict) == (Verdict.PASS, Verdict.PASS)
    which = "most" if symbol in MAXIMA else "least"
    assert getattr(report.row(symbol), which) == bound(symbol, mode, which), "the time is exactly at the limit"


@pytest.mark.parametrize(("symbol", "mode"), CASES)
def test_a_time_one_nanosecond_beyond_its_limit_fails_alone(symbol, mode):
    report = check(drawn(bus_with(symbol, mode, 1 if symbol in MAXIMA else -1)), "SCL", "SDA", mode)
    assert report.symbols_with(Verdict.FAIL) == ALSO.get(symbol, [symbol])
    assert report.verdict is Verdict.FAIL


@pytest.mark.parametrize("off", [-1, 0, 1])
@pytest.mark.parametrize(("symbol", "mode"), CASES)
def test_a_time_near_its_limit_is_undecidable_at_1_mhz(symbol, mode, off):
    capture = sampled(drawn(bus_with(symbol, mode, off)), MHZ, phase=517)
    report = check(capture, "SCL", "SDA", mode)
    assert report.row(symbol).verdict is (Verdict.UNDECIDABLE)
    assert report.verdict is Verdict.UNDECIDABLE


@pytest.mark.parametrize("off", [-1, 1])
@pytest.mark.parametrize(("symbol", "mode"), CASES)
def test_a_time_ten_nanoseconds_from_its_limit_is_decided_at_500_mhz(symbol, mode, off):
    capture = sampled(drawn(bus_with(symbol, mode, 10 * off)), 500 * MHZ)
    good = (off > 0) != (symbol in MAXIMA)
    report = check(capture, "SCL", "SDA", mode)
    assert report.row(symbol).verdict is (Verdict.PASS if good else Verdict.FAIL)
    assert report.symbols_with(Verdict.FAIL) == ([] if good else ALSO.get(symbol, [symbol]))


@pytest.mark.parametrize("mode", Mode)
def test_data_can_change_at_the_fall_of_scl(mode):
    """The minimum of tHD;DAT is 0, so a change at the same time passes. In samples, the order is unknown."""
    bus = EASY[mode].but(data=0)
    report = check(drawn(bus), "SCL", "SDA", mode)
    assert report.verdict is Verdict.PASS and report.row("tHD;DAT").least == 0 and report.shared > 20
    assert check(sampled(drawn(bus), 100 * MHZ), "SCL", "SDA", mode).row("tHD;DAT").verdict is Verdict.UNDECIDABLE
