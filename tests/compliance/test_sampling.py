"""Sampling may take a verdict away, but never turns one into another."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.compliance import Mode, Verdict, check
from periph_sim.compliance.limits import LIMIT
from tests.compliance.bus import EASY, Bus, drawn, sampled
from tests.decode.drawing import of_bytes

DECIDED = {Verdict.PASS, Verdict.FAIL}


@st.composite
def buses(draw, mode: Mode) -> Bus:
    """Each time half to twice its limit."""

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
def test_what_is_decided_from_samples_is_what_is_true(mode, data):
    bus = data.draw(buses(mode))
    rate = data.draw(st.integers(60, 600)) * 10**6  # no pulse is missed
    true = drawn(bus)
    exact = check(true, mode=mode)
    assert not exact.of(Verdict.UNDECIDABLE)
    seen = check(sampled(true, rate, data.draw(st.integers(0, 17))), mode=mode)
    for row in seen.rows:
        if row.verdict in DECIDED:
            assert row.verdict is exact.row(row.limit.symbol).verdict, row.limit.symbol
    if seen.verdict in DECIDED:
        assert seen.verdict is exact.verdict


@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(1, 40)), min_size=1, max_size=60),
    st.sampled_from([10**5, 10**6, 24 * 10**6, 10**9]),
    st.sampled_from(Mode),
)
def test_any_two_lines_have_a_verdict(runs, rate, mode):
    """Noise, too: no row claims more than its times say, and the report can be shown."""
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
