"""CPU timers. Rules SYS-015 and SYS-082 to SYS-094, and SYS-097 as far as it concerns timers."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.core.options import options_from
from periph_sim.core.registers import Yields
from periph_sim.f28335.cpu_timer.descriptor import TIMERS
from periph_sim.f28335.cpu_timer.module import CpuTimer
from periph_sim.f28335.cpu_timer.register_map import (
    BASES,
    MAP,
    PRD,
    PRDH,
    TCR,
    TIM,
    TIMH,
    TPR,
    TPRH,
)
from periph_sim.f28335.pie.register_map import CPU_VECTORS, LINES
from periph_sim.f28335.system_options import SystemOptions
from tests.waves import DiagramRig

TIF, TIE, TRB, TSS = 0x8000, 0x4000, 0x20, 0x10


def timer(**options: str) -> CpuTimer:
    return CpuTimer(options_from(SystemOptions, dict(options)))


def started(prd: int, tddr: int, tcr: int = 0, now: int = 0, **options: str) -> CpuTimer:
    """Return a timer set up like in TI's start-up code, reloaded and running from `now`."""
    chip = timer(**options)
    chip.write(now, TCR.offset, TSS | TIF)
    chip.write(now, PRD.offset, prd & 0xFFFF)
    chip.write(now, PRDH.offset, prd >> 16)
    chip.write(now, TPR.offset, tddr & 0xFF)
    chip.write(now, TPRH.offset, tddr >> 8)
    chip.write(now, TCR.offset, TRB | TIF | tcr)
    return chip


def count(chip: CpuTimer, now: int) -> int:
    return chip.peek(now, TIMH.offset) << 16 | chip.peek(now, TIM.offset)


def prescale(chip: CpuTimer, now: int) -> int:
    return chip.peek(now, TPRH.offset) & 0xFF00 | chip.peek(now, TPR.offset) >> 8


class TimerRig(DiagramRig):
    """A running timer. TIM, PSC and TIF are read without side effects; TINT is 1 in the cycle of a request."""

    def __init__(self, chip: CpuTimer) -> None:
        self.chip = chip
        self.now = 0
        self.requested = 0

    def drive(self, now: int, signal: str, level: int) -> None:
        self.now = now
        if signal == "CLOCK":
            self.chip.gate(now, bool(level))
            return
        bits = {"TSS": TSS if level else 0, "TRB": TRB if level else 0, "W1TIF": TIF if level else 0}[signal]
        held = self.chip.read(now, TCR.offset) & (TIE | TSS)
        if signal == "TSS":
            held &= TIE
        self.chip.write(now, TCR.offset, held | bits)

    def run_until(self, time: int) -> None:
        self.now = time
        self.chip.requests = 0
        if self.chip.next_wake <= time:
            self.chip.wake(time)
        self.requested = self.chip.requests

    def show(self, signal: str) -> int:
        if signal == "TINT":
            return self.requested
        if signal == "TIF":
            return self.chip.peek(self.now, TCR.offset) >> 15
        return count(self.chip, self.now) if signal == "TIM" else prescale(self.chip, self.now)


@pytest.mark.rule("SYS-082")
def test_addresses_of_the_timers_and_their_registers():
    assert BASES == (0xC00, 0xC08, 0xC10)
    offsets = {r.name: r.offset for r in MAP}
    assert offsets == {"TIM": 0, "TIMH": 1, "PRD": 2, "PRDH": 3, "TCR": 4, "TPR": 6, "TPRH": 7}


@pytest.mark.rule("SYS-083")
def test_the_timer_runs_from_its_reset_state():
    chip = timer()
    names = ("TIM", "TIMH", "PRD", "PRDH", "TCR", "TPR", "TPRH")
    expected = [0, 0, 0xFFFF, 0, 0, 0, 0]
    assert [chip.peek(0, MAP[n].offset) for n in names] == expected
    assert [MAP[n].reset for n in names] == expected
    assert [count(chip, now) for now in (1, 2, 3)] == [0xFFFF, 0xFFFE, 0xFFFD]
    assert chip.next_wake == 0x10000 and chip.peek(0x10000, TCR.offset) == TIF
    chip = timer()
    chip.write(3, TCR.offset, TSS | TIE)
    chip.reset(1000)
    assert [chip.peek(1000, MAP[n].offset) for n in names] == expected
    assert count(chip, 1001) == 0xFFFF


@pytest.mark.rule("SYS-084", "SYS-085", "SYS-087", "SYS-089")
def test_the_timer_counts_down_requests_at_zero_and_reloads():
    TimerRig(started(3, 0, TIE)).check("""
        < TIM   3 2 1 0 3 2 1 0 3 2
        < TIF   0 . . 1 . . . . . .
        < TINT  0 . . 1 0 . . 1 0 .
    """)


@pytest.mark.rule("SYS-084", "SYS-085", "SYS-086", "SYS-087", "SYS-089")
def test_the_prescaler_steps_the_count():
    TimerRig(started(2, 2, TIE)).check("""
        < PSC   210 210 210 210 210 210
        < TIM   2.. 1.. 0.. 2.. 1.. 0..
        < TIF   0.. ... 1.. ... ... ...
        < TINT  0.. ... 10. ... ... 10.
    """)


@pytest.mark.rule("SYS-087")
@pytest.mark.parametrize(("way", "tif"), [("on_zero", "0.. ... 1.. ..."), ("on_reload", "0.. ... ... 1..")])
def test_open_timer_tif_point(way, tif):
    chip = started(2, 2, timer_tif_point=way)
    TimerRig(chip).check(f"""
        < TIM  2.. 1.. 0.. 2..
        < TIF  {tif}
    """)
    assert chip.touched == {"timer_tif_point"}


@pytest.mark.rule("SYS-088")
def test_writing_1_clears_tif_and_0_does_not():
    TimerRig(started(2, 0)).check("""
        < TIM    2 1 0 2 1 0 2 1 0
        > W1TIF  . . . . 0 . 1 . .
        < TIF    0 . 1 . . . 0 . 1
    """)


@pytest.mark.rule("SYS-089")
def test_without_tie_zero_only_sets_tif():
    TimerRig(started(2, 0)).check("""
        < TIM   2 1 0 2 1 0
        < TIF   0 . 1 . . .
        < TINT  0 . . . . .
    """)


@pytest.mark.rule("SYS-097")
@pytest.mark.parametrize(("way", "asks"), [("requests", 1), ("waits_for_zero", 0)])
def test_open_timer_late_tie(way, asks):
    chip = started(9, 0, timer_late_tie=way)
    chip.wake(9)
    assert (chip.peek(9, TCR.offset), chip.requests) == (TIF, 0)
    chip.write(12, TCR.offset, TIE)
    assert chip.requests == asks
    assert chip.touched == {"timer_late_tie", "timer_tif_point"}


def test_setting_tie_in_the_write_that_clears_tif_requests_nothing():
    chip = started(9, 0)
    chip.wake(9)
    chip.write(12, TCR.offset, TIE | TIF)
    assert chip.requests == 0


@pytest.mark.rule("SYS-090")
def test_trb_reloads_count_and_prescaler_and_reads_0():
    chip = started(3, 2)
    TimerRig(chip).check("""
        > TRB  ... . 1 . ... ...
        < PSC  210 2 . 1 021 021
        < TIM  3.. 2 3 . .2. .1.
    """)
    assert not chip.peek(20, TCR.offset) & TRB


@pytest.mark.rule("SYS-091")
def test_tss_stops_the_count_and_lets_it_continue():
    TimerRig(started(3, 2)).check("""
        > TSS  ... . . 1 ... 0 . ...
        < PSC  210 2 1 0 ... . 2 102
        < TIM  3.. 2 . . ... . 1 ..0
    """)


def test_the_timer_stops_without_its_clock():
    TimerRig(started(6, 0)).check("""
        > CLOCK  . . . 0 . . 1 . .
        < TIM    6 5 4 3 . . . 2 1
    """)


@pytest.mark.rule("SYS-092")
def test_prd_takes_effect_at_the_next_reload():
    chip = started(5, 0)
    chip.write(2, PRD.offset, 2)
    assert [count(chip, now) for now in range(2, 12)] == [3, 2, 1, 0, 2, 1, 0, 2, 1, 0]


@pytest.mark.rule("SYS-093")
def test_psc_cannot_be_written():
    chip = started(5, 0x1234)
    assert (chip.peek(0, TPR.offset), chip.peek(0, TPRH.offset)) == (0x3434, 0x1212)
    chip.write(1, TPR.offset, 0xFF34)
    chip.write(1, TPRH.offset, 0xFF12)
    assert prescale(chip, 1) == 0x1233


@pytest.mark.rule("SYS-094")
def test_interrupt_lines_of_the_timers():
    tint0, tint1, tint2 = (timer.interrupts[0].vector for timer in TIMERS)
    assert (LINES[tint0], CPU_VECTORS[tint1], CPU_VECTORS[tint2]) == ((1, 7), 13, 14)


@pytest.mark.rule("SYS-086")
@pytest.mark.parametrize(("prd", "tddr"), [(149, 0), (0, 9), (0, 0), (0x12345, 3), (9, 0xFFFF)])
def test_the_period_is_prd_plus_1_times_tddr_plus_1(prd, tddr):
    chip = started(prd, tddr, TIE)
    zeros = []
    for _ in range(4):
        zeros.append(chip.next_wake)
        chip.wake(chip.next_wake)
        assert chip.requests == 1
        chip.requests = 0
    period = (prd + 1) * (tddr + 1)
    assert [b - a for a, b in pairwise(zeros)] == [period] * 3


@pytest.mark.rule("SYS-015")
def test_a_second_of_150_mhz_is_150_million_counts():
    chip = started(149_999_999, 0, TIE)
    assert count(chip, 75_000_000) == 74_999_999
    assert chip.next_wake == 149_999_999


def stepped(prd: int, tddr: int, cycles: int) -> list[tuple[int, int, int]]:
    """Return (TIM, PSC, number of zeros so far) for each cycle, counted step by step as in Tables 34 and 37."""
    tim, psc, zeros, out = prd, tddr, 0, []
    for _ in range(cycles):
        out.append((tim, psc, zeros))
        if psc:
            psc -= 1
            continue
        psc = tddr
        tim = tim - 1 if tim else prd
        zeros += tim == 0
    return out


@given(prd=st.integers(0, 12), tddr=st.integers(0, 5), reads=st.sets(st.integers(1, 150), max_size=6))
def test_the_computed_count_equals_counting_step_by_step(prd, tddr, reads):
    chip = started(prd, tddr, TIE)
    requested, track = 0, stepped(prd, tddr, 151)
    for now in range(151):
        if chip.next_wake == now:
            chip.wake(now)
            requested += chip.requests
            chip.requests = 0
        if now in reads:
            assert (count(chip, now), prescale(chip, now), requested) == track[now]
    assert requested == track[150][2]


@given(prd=st.integers(0, 9), tddr=st.integers(0, 3), tie=st.sampled_from([0, TIE]), clear=st.integers(1, 60))
def test_nothing_but_the_counts_changes_without_a_write_or_a_due_wake_up(prd, tddr, tie, clear):
    """Only the counts change in a cycle without a write or a due wake-up."""
    chip = started(prd, tddr, tie)
    shown = [r.offset for r in MAP if r.yields is not Yields.TIME]
    before: list[int] | None = None
    for now in range(120):
        changed_by_us = now == clear
        if changed_by_us:
            chip.write(now, TCR.offset, TIF | tie)
        if chip.next_wake == now:
            chip.wake(now)
            changed_by_us = True
        state = [chip.peek(now, offset) for offset in shown] + [chip.requests]
        assert changed_by_us or before is None or state == before, f"cycle {now}"
        before = state


def test_a_timer_with_tif_set_and_no_interrupt_requests_no_wake_up():
    chip = started(9, 0)
    assert chip.next_wake == 9
    chip.wake(9)
    assert chip.next_wake == NEVER  # TIF is 1 and does not change
    assert count(chip, 10**9) == 9 - 10**9 % 10


def test_a_read_in_the_cycle_of_a_zero_makes_its_request_only_once():
    chip = started(9, 0, TIE)
    zero = chip.next_wake
    assert (chip.read(zero, TCR.offset) & TIF, chip.requests, chip.next_wake) == (TIF, 1, zero + 10)


def test_a_stopped_timer_requests_no_wake_up_until_it_runs_again():
    chip = started(9, 0, TIE)
    chip.write(4, TCR.offset, TSS | TIE)
    assert chip.next_wake == NEVER
    chip.wake(50)
    assert (chip.requests, count(chip, 50)) == (0, 5)
    chip.write(100, TCR.offset, TIE)
    assert chip.next_wake == 105


def test_reset_removes_a_request():
    chip = started(9, 0, TIE)
    chip.wake(9)
    chip.reset(9)
    assert (chip.requests, chip.next_wake) == (0, 9 + 0x10000)


def test_a_write_of_the_count_takes_effect_at_once():
    chip = started(0x20000, 0)
    chip.write(4, TIM.offset, 5)
    chip.write(4, TIMH.offset, 1)
    assert [count(chip, now) for now in (4, 5)] == [0x10005, 0x10004]


def test_bits_above_the_sixteenth_of_a_written_value_are_ignored():
    chip = started(0x20000, 0)
    for register, word in ((TIM, 5), (TIMH, 1), (PRD, 7), (PRDH, 2)):
        chip.write(0, register.offset, 0xF_0000 | word)
    assert [chip.peek(0, register.offset) for register in (TIM, TIMH, PRD, PRDH)] == [5, 1, 7, 2]
