"""The watchdog of the system control. Rules SYS-020 to SYS-031.

With OSCCLK/4, as after a reset, WDCNTR is incremented every 512 OSCCLK = 128 cycles and overflows after 32768.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.core.options import options_from
from periph_sim.core.registers import Register, Yields
from periph_sim.f28335.system_control.module import WDFLAG_DELAY, SystemControl
from periph_sim.f28335.system_control.register_map import MAP, PLLCR, PLLSTS, SCSR, WDCNTR, WDCR, WDKEY
from periph_sim.f28335.system_options import SystemOptions

STEP = 512 // 4
OVERFLOW = 131072 // 4
ON, OFF = 0x28, 0x68  # WDCR with the correct WDCHK
WDENINT, WDOVERRIDE, WDINTS = 2, 1, 4
WAKEINT = 1


def system(*writes: tuple[Register, int], **options: str) -> SystemControl:
    chip = SystemControl(30_000_000, options_from(SystemOptions, dict(options)))
    for register, value in writes:
        chip.write(0, register.offset, value)
    return chip


def interrupting() -> SystemControl:
    """Return a chip whose watchdog requests WAKEINT at an overflow instead of a reset."""
    return system((SCSR, WDENINT))


def run_until(chip: SystemControl, now: int) -> None:
    while chip.next_wake <= now:
        chip.wake(chip.next_wake)


def keys(chip: SystemControl, now: int, *values: int) -> None:
    for value in values:
        chip.write(now, WDKEY.offset, value)


@pytest.mark.rule("SYS-020")
def test_the_watchdog_runs_after_reset_at_oscclk_by_512():
    chip = system()
    counts = [chip.peek(now, WDCNTR.offset) for now in (0, STEP - 1, STEP, 2 * STEP - 1, 2 * STEP, 255 * STEP)]
    assert counts == [0, 0, 1, 1, 2, 255]


@pytest.mark.rule("SYS-021", "SYS-022")
@pytest.mark.parametrize("wdps", range(8))
def test_wdps_prescales_the_time_out(wdps):
    prescale = [1, 1, 2, 4, 8, 16, 32, 64][wdps]
    chip = system((WDCR, ON | wdps))
    assert chip.peek(0, WDCR.offset) == wdps
    assert chip.next_wake == OVERFLOW * prescale
    assert chip.peek(STEP * prescale - 1, WDCNTR.offset) == 0
    assert chip.peek(STEP * prescale, WDCNTR.offset) == 1


@pytest.mark.rule("SYS-022")
def test_overflow_requests_a_reset():
    chip = system()
    assert chip.next_wake == OVERFLOW
    chip.wake(OVERFLOW - 1)  # an early wake-up has no effect
    assert not chip.reset_requested
    chip.wake(OVERFLOW)
    assert chip.reset_requested
    assert chip.requests == 0


@pytest.mark.rule("SYS-022", "SYS-023")
@given(when=st.integers(0, OVERFLOW - 1))
def test_the_time_out_counts_from_the_last_clear_at_any_count(when):
    chip = system()
    keys(chip, when, 0x55, 0xAA)
    assert chip.peek(when, WDCNTR.offset) == 0
    assert chip.next_wake == when + OVERFLOW


def test_the_time_out_is_exact_across_changes_of_the_clock_ratio():
    """The watchdog is cleared while the PLL locks at OSCCLK/4; most of its 131072 OSCCLK pass after the lock."""
    chip = system((PLLSTS, 0x40), (PLLCR, 10))
    keys(chip, 20_000, 0x55, 0xAA)  # after 80000 OSCCLK, 51072 before the end of the lock
    run_until(chip, 32_768)
    assert (chip.sysclk_hz / chip.oscclk_hz).as_integer_ratio() == (5, 2)
    chip.write(32_768, PLLSTS.offset, 2 << 7)  # 5 cycles per OSCCLK
    assert chip.next_wake == 32_768 + (131072 - 51072) * 5
    assert chip.peek(32_768 + (131072 - 51072) * 5 - 1, WDCNTR.offset) == 255


# The numbered sequence of Table 26: the written key, and whether it clears the counter.
TABLE_26 = [
    (0xAA, False),
    (0xAA, False),
    (0x55, False),
    (0x55, False),
    (0x55, False),
    (0xAA, True),
    (0xAA, False),
    (0x55, False),
    (0xAA, True),
    (0x55, False),
    (0x32, False),
    (0xAA, False),
    (0x55, False),
    (0xAA, True),
]


@pytest.mark.rule("SYS-023", "SYS-024", "SYS-025")
def test_the_key_sequence_of_the_manual():
    chip = system()
    now = 0
    for key, clears in TABLE_26:
        now += 2 * STEP
        assert chip.peek(now, WDCNTR.offset) >= 2
        keys(chip, now, key)
        assert (chip.peek(now, WDCNTR.offset) == 0) is clears
    assert not chip.reset_requested


@pytest.mark.rule("SYS-025")
@pytest.mark.parametrize(("way", "resets"), [("ignored", False), ("reset", True)])
@pytest.mark.parametrize("before", [(), (0x55,)])
def test_open_wd_bad_key(way, resets, before):
    chip = system(wd_bad_key=way)
    keys(chip, 3 * STEP, *before, 0x32)
    assert chip.reset_requested is resets
    assert chip.peek(3 * STEP, WDCNTR.offset) == 3
    assert chip.touched == {"wd_bad_key"}
    keys(chip, 3 * STEP, 0xAA)
    assert chip.peek(3 * STEP, WDCNTR.offset) == 3  # the other key interrupted the pair


def test_a_wrong_key_has_no_effect_on_a_disabled_watchdog():
    chip = system((WDCR, OFF), wd_bad_key="reset")
    keys(chip, 0, 0x32)
    assert not chip.reset_requested


@pytest.mark.parametrize(("way", "overflow"), [("restarts_on_clear", 100 + OVERFLOW), ("free_running", OVERFLOW)])
def test_open_wd_divider(way, overflow):
    chip = system(wd_divider=way)
    keys(chip, 100, 0x55, 0xAA)
    assert chip.next_wake == overflow
    assert chip.touched == {"wd_divider"}


@pytest.mark.rule("SYS-026")
@pytest.mark.parametrize("wdchk", range(8))
def test_wrong_wdchk_resets_at_once(wdchk):
    chip = system()
    chip.write(10, WDCR.offset, wdchk << 3)
    assert chip.reset_requested is (wdchk != 5)


@pytest.mark.rule("SYS-026")
def test_wrong_wdchk_interrupts_instead_with_wdenint():
    chip = interrupting()
    chip.write(10, WDCR.offset, 0)
    assert chip.requests == WAKEINT
    assert not chip.reset_requested


@pytest.mark.rule("SYS-026")
def test_wrong_wdchk_does_nothing_while_disabled():
    chip = system((WDCR, OFF))
    chip.write(1, WDCR.offset, 0x40)
    assert not chip.reset_requested


@pytest.mark.rule("SYS-027")
def test_wddis_stops_the_count_and_lets_it_continue():
    chip = system()
    chip.write(3 * STEP, WDCR.offset, OFF)
    assert chip.next_wake == NEVER
    assert chip.peek(1000 * STEP, WDCNTR.offset) == 3
    chip.write(1000 * STEP, WDCR.offset, ON)
    assert chip.next_wake == 1000 * STEP + 253 * STEP
    assert chip.peek(1010 * STEP - 1, WDCNTR.offset) == 12
    assert chip.peek(1010 * STEP, WDCNTR.offset) == 13


@pytest.mark.rule("SYS-023")
@pytest.mark.parametrize("how", ["keys", "reset"])
def test_a_count_is_cleared_after_a_write_to_wdcr_too(how):
    chip = system()
    chip.write(3 * STEP, WDCR.offset, ON)
    if how == "keys":
        keys(chip, 3 * STEP, 0x55, 0xAA)
    else:
        chip.reset(3 * STEP)
    assert chip.peek(3 * STEP, WDCNTR.offset) == 0
    assert chip.next_wake == 3 * STEP + OVERFLOW


@pytest.mark.rule("SYS-027", "SYS-028")
@pytest.mark.parametrize(("was", "tried"), [(ON, OFF), (OFF, ON)])
def test_wddis_is_fixed_once_wdoverride_is_cleared(was, tried):
    chip = system((WDCR, was))
    chip.write(0, SCSR.offset, 0)  # writing 0 leaves WDOVERRIDE
    assert chip.read(0, SCSR.offset) & WDOVERRIDE
    chip.write(0, SCSR.offset, WDOVERRIDE)
    assert not chip.read(0, SCSR.offset) & WDOVERRIDE
    chip.write(0, SCSR.offset, 0)
    chip.write(0, WDCR.offset, tried | 3)
    assert chip.read(0, WDCR.offset) == was & 0x40 | 3  # the prescale can still be changed
    chip.write(0, SCSR.offset, WDOVERRIDE)  # another write does not set it again
    assert not chip.read(0, SCSR.offset) & WDOVERRIDE
    chip.reset(10)
    assert chip.read(10, SCSR.offset) & WDOVERRIDE


@pytest.mark.rule("SYS-029")
def test_overflow_with_wdenint_pulses_wdint():
    chip = interrupting()
    assert chip.next_wake == OVERFLOW
    chip.wake(OVERFLOW)
    assert (chip.requests, chip.reset_requested) == (WAKEINT, False)
    chip.requests = 0
    seen = {}
    for now in range(OVERFLOW, OVERFLOW + 140):
        run_until(chip, now)
        seen[now - OVERFLOW] = bool(chip.peek(now, SCSR.offset) & WDINTS)
    # WDINT is low for 512 OSCCLK = 128 cycles; WDINTS shows it two cycles later
    assert [n for n in seen if not seen[n]] == list(range(2, 130))
    assert chip.requests == 0  # the rising edge requests nothing
    assert chip.next_wake == 2 * OVERFLOW


@pytest.mark.parametrize(("later", "resets"), [(127, True), (128, False)])
def test_clearing_wdenint_resets_at_once_while_wdint_is_low(later, resets):
    chip = interrupting()
    chip.wake(OVERFLOW)
    chip.write(OVERFLOW + later, SCSR.offset, 0)
    assert chip.reset_requested is resets


@pytest.mark.rule("SYS-030")
def test_wdflag_is_set_by_a_watchdog_reset_and_cleared_by_writing_1():
    chip = system()
    chip.wake(OVERFLOW)
    chip.reset(OVERFLOW)
    assert not chip.reset_requested
    due = OVERFLOW + 128 + 8192  # the pulse of 512 OSCCLK, and then the delay in the text after Table 30
    assert due == OVERFLOW + WDFLAG_DELAY
    assert chip.peek(due - 1, WDCR.offset) == 0
    run_until(chip, due)
    assert chip.read(due, WDCR.offset) == 0x80
    chip.write(due, WDCR.offset, ON)  # writing 0 leaves WDFLAG
    assert chip.read(due, WDCR.offset) == 0x80
    chip.write(due, WDCR.offset, ON | 0x80)
    assert chip.read(due, WDCR.offset) == 0


@pytest.mark.rule("SYS-030")
def test_an_external_reset_leaves_wdflag_0():
    chip = system()
    chip.reset(100)
    assert chip.peek(100 + WDFLAG_DELAY, WDCR.offset) == 0


@pytest.mark.rule("SYS-031")
def test_wdkey_reads_as_wdcr_and_wdchk_as_0():
    chip = system((WDCR, OFF | 7))
    keys(chip, 0, 0x55)
    assert chip.read(0, WDKEY.offset) == chip.read(0, WDCR.offset) == 0x47


def test_reset_restarts_the_watchdog():
    chip = interrupting()
    chip.wake(OVERFLOW)
    keys(chip, OVERFLOW, 0x55)
    chip.reset(OVERFLOW + 10)
    assert chip.requests == 0
    assert chip.read(OVERFLOW + 10, SCSR.offset) == WDINTS | WDOVERRIDE
    assert chip.next_wake == 2 * OVERFLOW + 10
    keys(chip, OVERFLOW + 2 * STEP + 10, 0xAA)  # the 0x55 before the reset does not count
    assert chip.peek(OVERFLOW + 2 * STEP + 10, WDCNTR.offset) == 2


def test_nothing_but_the_count_changes_without_a_write_or_a_due_wake_up():
    """Only the count changes in a cycle without a write or a due wake-up."""
    chip = interrupting()
    shown = [r.offset for r in MAP if r.yields is not Yields.TIME]
    before = None
    for now in range(OVERFLOW - 300, OVERFLOW + 300):
        woken = chip.next_wake == now
        if woken:
            chip.wake(now)
        state = ([chip.peek(now, offset) for offset in shown], chip.requests, chip.reset_requested, chip.gates)
        assert woken or before is None or state == before, f"cycle {now}"
        before = state
