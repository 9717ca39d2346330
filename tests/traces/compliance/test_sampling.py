"""Sampling can make a verdict undecidable, but never changes it to another one."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.compliance import Mode, Verdict, check
from periph_sim.traces.compliance.limits import LIMIT
from tests.traces.compliance.bus import EASY, Bus, Odd, drawn, sampled
from tests.traces.decode.drawing import of_bytes

DECIDED = {Verdict.PASS, Verdict.FAIL}


@st.composite
def buses(draw, mode: Mode) -> Bus:
    """A bus whose times are half to twice their limits."""

    def around(symbol: str) -> int:
        least = LIMIT[symbol].bounds[mode].least
        return draw(st.integers(least // 2, 2 * least))

    low = around("tLOW")
    return EASY[mode].but(
        low=low,
        high=around("tHIGH"),
        hd_sta=around("tHD;STA"),
        su_sta=around("tSU;STA"),
        su_sto=around("tSU;STO"),
        buf=around("tBUF"),
        data=draw(st.integers(20, low - 20)),
    )


@pytest.mark.parametrize("mode", Mode)
@given(st.data())
def test_verdicts_from_samples_agree_with_exact_ones(mode, data):
    bus = data.draw(buses(mode))
    rate = data.draw(st.integers(60, 600)) * 10**6  # so high that no pulse is missed
    true = drawn(bus)
    exact = check(true, mode=mode)
    assert not exact.symbols_with(Verdict.UNDECIDABLE)
    seen = check(sampled(true, rate, data.draw(st.integers(0, 17))), mode=mode)
    for row in seen.rows:
        if row.verdict in DECIDED:
            assert row.verdict is exact.row(row.limit.symbol).verdict, row.limit.symbol
    if seen.verdict in DECIDED:
        assert seen.verdict is exact.verdict


@st.composite
def legal_buses(draw, mode: Mode) -> Bus:
    """A bus whose times are at their limits or up to 40 % within. In stretched low phases, data change late."""

    def kept(symbol: str) -> int:
        least = LIMIT[symbol].bounds[mode].least
        return draw(st.one_of(st.just(least), st.integers(least, least * 14 // 10)))

    low, high = kept("tLOW"), kept("tHIGH")
    low = max(low, LIMIT["fSCL"].bounds[mode].least - high)
    setup = LIMIT["tSU;DAT"].bounds[mode].least
    maxima = [LIMIT[symbol].bounds[mode].most for symbol in ("tHD;DAT", "tVD;DAT", "tVD;ACK")]
    latest = min([low - setup, *(most for most in maxima if most is not None)])

    def data(most: int) -> int:
        return draw(st.one_of(st.just(most), st.integers(0, most)))

    odd = {}
    for place in draw(st.sets(st.tuples(st.integers(0, 3), st.integers(0, 8)), max_size=4)):
        lengths = (low, low * 11 // 10, low * 11 // 10 + 1, low * 115 // 100)
        length = draw(st.one_of(st.sampled_from(lengths), st.integers(low, 3 * low)))
        stretched = 10 * length > 11 * low and length > LIMIT["tLOW"].bounds[mode].least
        odd[place] = Odd(data=(data(length - setup if stretched else latest),), low=length)
    return EASY[mode].but(
        low=low,
        high=high,
        hd_sta=kept("tHD;STA"),
        su_sta=kept("tSU;STA"),
        su_sto=kept("tSU;STO"),
        buf=kept("tBUF"),
        data=data(latest),
        odd=odd,
    )


RATES = st.one_of(st.sampled_from([10**6, 4 * 10**6, 24 * 10**6, 100 * 10**6]), st.integers(5 * 10**4, 6 * 10**8))


@pytest.mark.parametrize("mode", Mode)
@given(st.data())
def test_a_compliant_controller_never_fails_at_any_sample_rate(mode, data):
    """This includes low phases that are possibly stretched, and pulses between two samples."""
    true = drawn(data.draw(legal_buses(mode)))
    assert not check(true, mode=mode).symbols_with(Verdict.FAIL)
    seen = check(sampled(true, data.draw(RATES), data.draw(st.integers(0, 999))), mode=mode)
    assert not seen.symbols_with(Verdict.FAIL)


def test_a_clock_near_the_sample_rate_fails_no_maximum():
    """A clock of 1 MHz is sampled at 1 MHz. Pulses between two samples are lost, so the clock seems slow."""
    bus = EASY[Mode.FAST_PLUS].but(low=640, high=360, data=300)
    assert check(drawn(bus), mode=Mode.FAST_PLUS).verdict is Verdict.PASS
    seen = check(sampled(drawn(bus), 10**6, 617), mode=Mode.FAST_PLUS)
    assert seen.row("tVD;DAT").most > 1 and seen.verdict is Verdict.UNDECIDABLE


@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(1, 40)), min_size=1, max_size=60),
    st.sampled_from([10**5, 10**6, 24 * 10**6, 10**9]),
    st.sampled_from(Mode),
)
def test_any_two_lines_have_a_verdict(runs, rate, mode):
    """Even for noise, no row claims more than its times prove, and the report can be printed."""
    capture = of_bytes(bytes(level for level, count in runs for _ in range(count)), ("SCL", "SDA"), rate)
    report = check(capture, mode=mode)
    sample = Fraction(10**9, rate)
    for row in report.rows:
        if row.verdict is Verdict.PASS and row.bounds.least is not None:
            assert row.least * sample - sample >= row.bounds.least
        assert (row.verdict is Verdict.FAIL) == bool(row.failed)
        assert row.failed + row.undecided <= row.count
        assert row.verdict not in DECIDED or row.count
    assert len(str(report).splitlines()) >= 18
