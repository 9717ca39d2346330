"""I2C master clock: dividers, SCL low and high time, synchronisation, noise filter. SPRUG03B 1.4, 2.7, 5.6, 5.7."""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_bus import HIGH, LOW, RELEASED, SCL, SDA, SLOT, Bench, Foreign, Target, mdr, with_

rule = pytest.mark.rule

TMOD = 15


def lows_and_highs(b: Bench) -> tuple[set[int], set[int]]:
    """Return the lengths of the low and high periods of SCL from the first fall to the last rise."""
    edges = [e for e in b.edges if e.line == SCL]
    low = {y.time - x.time for x, y in itertools.pairwise(edges) if y.level}
    high = {y.time - x.time for x, y in itertools.pairwise(edges) if not y.level}
    return low, high


def one_byte(b: Bench) -> None:
    b.mode("MST TRX STT STP", count=1, data=0x5A)
    assert b.decoded_at_stop() == "S 50W A 5a A P"


# ---- dividers -----------------------------------------------------------------------------------------


@rule("I2C-154", "I2C-159", "I2C-160", "I2C-161", "I2C-162", "I2C-163", "I2C-164")
@pytest.mark.parametrize(
    "psc, clkl, clkh, low, high",
    [
        (14, 10, 5, 225, 150),  # TI's example: 400 kHz
        (14, 70, 70, 1125, 1125),
        (14, 1, 1, 90, 90),
        (20, 3, 9, 21 * 8, 21 * 14),
        (2, 10, 5, 3 * 15, 3 * 10),
        (1, 30, 20, 2 * 36, 2 * 26),
        (0, 90, 70, 97, 77),
        (255, 1, 2, 256 * 6, 256 * 7),
    ],
)
def test_low_and_high_time_of_scl(psc: int, clkl: int, clkh: int, low: int, high: int):
    b = Bench(Target(), psc=psc, clkl=clkl, clkh=clkh)
    b.mode("MST TRX STT STP", count=1, data=0x5A)
    b.until(lambda: b.flag("SCD"), 100 * (low + high))
    lows, highs = lows_and_highs(b)
    assert (lows, highs) == ({low}, {high})
    falls = b.times(SCL, 0)
    assert {y - x for x, y in itertools.pairwise(falls)} == {low + high}


@rule("I2C-159", "I2C-160")
@settings(max_examples=20, deadline=None)
@given(st.integers(1, 200), st.integers(1, 200), st.integers(12, 20))
def test_low_and_high_time_of_any_divisors(clkl: int, clkh: int, psc: int):
    b = Bench(Target(), psc=psc, clkl=clkl, clkh=clkh)
    b.mode("MST TRX STT STP", count=1, data=0x00)
    b.until(lambda: b.flag("SCD"), 10**7)
    assert lows_and_highs(b) == ({(psc + 1) * (clkl + 5)}, {(psc + 1) * (clkh + 5)})


@rule("I2C-161", "I2C-168", "I2C-169")
def test_ti_setting_is_400_khz_and_keeps_the_limits_without_a_note():
    b = Bench(Target())
    one_byte(b)
    falls = b.times(SCL, 0)
    assert 150_000_000 / (falls[2] - falls[1]) == 400_000
    assert not b.duties()


@rule("I2C-157", "I2C-158")
def test_ipsc_changed_with_irs_1_does_not_change_the_clock():
    b = Bench(Target())
    b.w("I2CPSC", 20)
    one_byte(b)
    assert lows_and_highs(b) == ({LOW}, {HIGH})


@rule("I2C-157")
def test_ipsc_changed_with_irs_0_takes_effect_with_irs_1():
    b = Bench(Target())
    b.w("I2CMDR", 0)
    b.w("I2CPSC", 12)
    b.w("I2CMDR", mdr(""))
    one_byte(b)
    assert lows_and_highs(b) == ({13 * 15}, {13 * 10})


# ---- notes about broken rules --------------------------------------------------------------------------------


MHZ = 1_000_000


@rule("I2C-155")
@pytest.mark.parametrize(
    ("sysclk", "psc", "noted"),
    [
        (150, 11, "12.5"),
        (150, 12, ""),
        (150, 14, ""),
        (150, 20, ""),
        (150, 21, "6.81818"),
        (150, 0, "150"),
        (100, 9, ""),
        (100, 14, "6.66667"),
        (100, 7, "12.5"),
        (120, 9, ""),  # exactly 12 MHz
        (60, 5, ""),
        (30, 2, ""),
        (30, 14, "2"),
    ],
)
def test_a_module_clock_outside_of_7_to_12_mhz_is_noted(sysclk: int, psc: int, noted: str):
    b = Bench(psc=psc, enable=False)
    b.m.set_sysclk(b.now, Fraction(sysclk * MHZ))
    assert not b.duties(), "noted before IRS rises"
    b.set("IRS")
    texts = [note.text for note in b.duties()]
    expected = f"gives a module clock of {noted} MHz at SYSCLKOUT = {sysclk} MHz; expected 7 to 12 MHz"
    assert texts == ([f"I2CPSC = {psc} {expected}"] if noted else [])


@rule("I2C-155")
def test_a_change_of_sysclkout_under_an_enabled_module_is_checked_once():
    b = Bench()
    for mhz in (100, 100, 150, 75):
        b.m.set_sysclk(b.now, Fraction(mhz * MHZ))
    assert [note.text.split()[8] for note in b.duties()] == ["6.66667", "5"]
    b.m.reset(b.now)
    b.m.set_sysclk(b.now, Fraction(100 * MHZ))
    assert not b.duties(), "noted while the module is in reset"


@rule("I2C-156")
def test_ipsc_written_with_irs_1_is_noted():
    b = Bench()
    assert not b.duties()
    b.w("I2CPSC", 12)
    notes = b.duties()
    assert any("I2CPSC" in n.text or "IPSC" in n.text for n in notes)


@rule("I2C-166", "I2C-167")
@pytest.mark.parametrize("clkl, clkh, name", [(0, 5, "CLKL"), (10, 0, "CLKH")])
def test_iccl_or_icch_of_0_is_noted(clkl: int, clkh: int, name: str):
    b = Bench(Target(), clkl=clkl, clkh=clkh)
    b.mode("MST TRX STT STP", count=1, data=0)
    b.run(4 * SLOT)
    assert any(name in n.text for n in b.duties())


def rate_notes(sysclk: int, psc: int, clkl: int, clkh: int) -> list[str]:
    """Return the notes of one transfer with this clock."""
    b = Bench(Target(), psc=psc, clkl=clkl, clkh=clkh, enable=False)
    b.m.set_sysclk(b.now, Fraction(sysclk * MHZ))
    b.set("IRS")
    b.mode("MST TRX STT STP", count=1, data=0)
    b.edge(SCL, 0)
    return [note.text for note in b.duties()]


@rule("I2C-168")
@pytest.mark.parametrize(
    ("sysclk", "psc", "clkl", "clkh", "khz"),
    [
        (150, 14, 10, 5, ""),
        (150, 14, 9, 6, ""),
        (150, 14, 9, 5, "416.667"),
        (150, 14, 495, 495, ""),
        (150, 14, 500, 500, "9.90099"),
        (100, 9, 10, 5, ""),  # the same 400 kHz
        (100, 9, 9, 5, "416.667"),
        (100, 9, 500, 500, "9.90099"),
        (60, 5, 10, 5, ""),
    ],
)
def test_rates_outside_of_10_to_400_khz_are_noted(sysclk: int, psc: int, clkl: int, clkh: int, khz: str):
    notes = rate_notes(sysclk, psc, clkl, clkh)
    assert notes == ([f"SCL would run at {khz} kHz; expected 10 to 400 kHz"] if khz else [])


@rule("I2C-169")
@pytest.mark.parametrize(("sysclk", "psc"), [(150, 14), (100, 9), (60, 5)])
@pytest.mark.parametrize(
    ("clkl", "clkh", "times"),
    [(10, 5, ""), (8, 7, ""), (7, 8, "1.2 us low, 1.3 us high"), (14, 1, ""), (15, 0, "2 us low, 0.5 us high")],
)
def test_low_and_high_periods_below_the_minimum_at_400_khz_are_noted(
    sysclk: int, psc: int, clkl: int, clkh: int, times: str
):
    """SCL must be low for at least 1.3 us and high for 0.6 us: 13 and 6 module clocks of 100 ns."""
    notes = [text for text in rate_notes(sysclk, psc, clkl, clkh) if "was written 0" not in text]
    assert notes == ([f"SCL has {times}; expected at least 1.3 us and 0.6 us"] if times else [])


# ---- other devices on SCL ----------------------------------------------------------------------------------


@rule("I2C-165")
@pytest.mark.parametrize("rise", [15, 45, 60])
def test_the_time_a_line_needs_to_rise_lengthens_the_period(rise: int):
    b = Bench(Target(), rise=rise)
    one_byte(b)
    assert lows_and_highs(b) == ({LOW + rise}, {HIGH})


@rule("I2C-171")
@pytest.mark.parametrize("held", [240, 300, 1500, 30_000])
def test_the_high_period_begins_when_the_line_scl_is_high(held: int):
    b = Bench(Target(stretch={(0, 3): held, (1, 9): held}))
    one_byte(b)
    assert lows_and_highs(b) == ({LOW, held}, {HIGH})


@rule("I2C-171")
def test_a_stretch_shorter_than_the_own_low_period_changes_nothing():
    b = Bench(Target(stretch={(0, 3): LOW - 1, (1, 9): 20}))
    one_byte(b)
    assert lows_and_highs(b) == ({LOW}, {HIGH})


@rule("I2C-170")
@pytest.mark.parametrize("after", [30, 75, 120])
def test_a_fall_of_scl_made_by_another_device_starts_the_low_period(after: int):
    b = Bench(Target())
    b.mode("MST TRX STT STP", count=1, data=0x5A)
    rise = b.edge(SCL, 1, 3)
    b.run(after)
    b.pulse(SCL, 60)
    assert b.edge(SCL, 1) == rise + after + LOW
    assert b.decoded_at_stop() == "S 50W A 5a A P"


@rule("I2C-172", "I2C-173")
@pytest.mark.parametrize(
    "low, high, seen_low, seen_high",
    [(400, 100, 400, 100), (150, 300, LOW, HIGH), (600, 300, 600, HIGH), (200, 90, LOW, 90)],
)
def test_two_masters_have_the_longest_low_and_the_shortest_high(low: int, high: int, seen_low: int, seen_high: int):
    b = Bench(Target(), Foreign("S 50W 5A P", at=None, low=low, high=high))
    b.mode("MST TRX STT STP", count=1, data=0x5A)
    first = b.edge(SCL, 0)
    b.edge(SCL, 0, 17)
    edges = [e for e in b.edges if e.line == SCL and e.time >= first]
    highs = {y.time - x.time for x, y in itertools.pairwise(edges) if not y.level}
    lows = {y.time - x.time for x, y in itertools.pairwise(edges) if y.level}
    assert (lows, highs) == ({seen_low}, {seen_high})
    assert not b.foreign.lost and not b.flag("AL")


# ---- noise -----------------------------------------------------------------------------------------------------


@rule("I2C-174")
@pytest.mark.parametrize("cycles, seen", [(1, False), (7, False), (14, False), (31, True), (200, True)])
def test_a_spike_on_sda_shorter_than_the_filter_is_not_a_start(cycles: int, seen: bool):
    b = Bench()
    b.run(100)
    b.pulse(SDA, cycles)
    b.run(100)
    assert bool(b.flag("SCD")) is seen  # the start of the pulse is a START, and its end a STOP


@rule("I2C-174")
@pytest.mark.parametrize("cycles", [1, 8, 14])
def test_spikes_on_scl_and_sda_do_not_disturb_a_transfer(cycles: int):
    b = Bench(Target(gives=[0xFF]))
    b.mode("MST STT STP", count=1)
    rise = b.edge(SCL, 1, 11)
    b.run(50)
    b.m.pins(b.now, RELEASED & ~(1 << SCL))  # only at the pins of the module, because the target has no filter
    b.run(cycles)
    b.m.pins(b.now, RELEASED)
    b.run(30)
    b.m.pins(b.now, RELEASED & ~(1 << SDA))
    b.run(cycles)
    b.m.pins(b.now, RELEASED)
    assert b.edge(SCL, 0) == rise + HIGH
    assert b.drain(1) == [0xFF]
    assert b.decoded_at_stop() == "S 50R A ff N P"


@rule("I2C-171", "I2C-174")
@pytest.mark.parametrize("width, said", [(1, "A"), (20, "N")])
def test_a_spike_on_a_stretched_scl_is_not_its_end(width: int, said: str):
    """A filter of 20 module clocks, wider than the low and high periods of SCL, also suppresses the acknowledge."""
    b = Bench(Target(), options=with_(noise_filter_cycles=width))
    b.mode("MST TRX STT", count=1)
    b.edge(SCL, 0, 3)
    b.pull(SCL)
    b.run(LOW + 20)
    b.m.pins(b.now, RELEASED)  # only at the pins of the module, because the target has no filter
    b.run(8)
    b.m.pins(b.now, RELEASED & ~(1 << SCL))
    b.run(2 * LOW)
    b.release(SCL)
    assert b.edge(SCL, 0) == b.times(SCL, 1)[-1] + HIGH
    b.until(lambda: b.flag("NACK") or not b.flag("XSMT"))
    assert len(b.times(SCL, 1)) == 9
    assert b.flag("NACK") == (said == "N")


@rule("I2C-175")
@pytest.mark.parametrize("first", ["04W", "05R", "07R", "01W"])
def test_master_codes_and_cbus_are_treated_as_foreign_addresses(first: str):
    b = Bench(Foreign(f"S {first} P"), own=0x50)
    b.run(20 * SLOT)
    assert b.foreign.done and b.foreign.acknowledges == "N"
    assert b.flags("AAS AD0 SDIR RRDY") == ""
