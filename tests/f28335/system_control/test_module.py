"""System control: clock ratio, prescalers, clock gates. Rules SYS-001 to SYS-019; test_watchdog.py has the watchdog."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.options import options_from
from periph_sim.core.registers import Register
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.system_control.module import GATE_DELAY, GATES, PLL_LOCK_OSCCLKS, SystemControl
from periph_sim.f28335.system_control.oscclk import PARTS, OscClock
from periph_sim.f28335.system_control.register_map import (
    BASE,
    HISPCP,
    LOSPCP,
    LPMCR0,
    MAP,
    PCLKCR0,
    PCLKCR1,
    PCLKCR3,
    PLLCR,
    PLLSTS,
    WDCR,
)
from periph_sim.f28335.system_options import SystemOptions
from tests.waves import DiagramRig

MHZ = 1_000_000
LOCK = PLL_LOCK_OSCCLKS // 4  # SYSCLKOUT cycles at OSCCLK/4
MCLKOFF = 0x40


def divsel(n: int) -> int:
    return n << 7


def system(*writes: tuple[Register, int], oscclk_hz: int = 30 * MHZ, **options: str) -> SystemControl:
    """Return a chip after reset, with the watchdog disabled as start-up code does, and with these registers written."""
    chip = SystemControl(oscclk_hz, options_from(SystemOptions, dict(options)))
    for register, value in ((WDCR, 0x68), *writes):
        chip.write(0, register.offset, value)
    return chip


def locking(div: int = 5, bits: int = MCLKOFF, **options: str) -> SystemControl:
    """Return a chip whose PLL begins to lock in cycle 0. bits: value of PLLSTS."""
    chip = system(**options)
    chip.write(0, PLLSTS.offset, bits)
    chip.write(0, PLLCR.offset, div)
    return chip


def ratio(chip: SystemControl) -> tuple[int, int]:
    return (chip.sysclk_hz / chip.oscclk_hz).as_integer_ratio()


def run_until(chip: SystemControl, now: int) -> None:
    """Wake the chip in each cycle that it has requested, up to and including `now`."""
    while chip.next_wake <= now:
        chip.wake(chip.next_wake)


def program_pll(chip: SystemControl, now: int, div: int, sel: int) -> int:
    """Set the PLL by the procedure of the manual and return the cycle of its end."""
    chip.write(now, PLLSTS.offset, divsel(0) | MCLKOFF)
    chip.write(now, PLLCR.offset, div)
    while not chip.read(now, PLLSTS.offset) & 1:
        now = chip.next_wake
        chip.wake(now)
    chip.write(now, PLLSTS.offset, divsel(0))
    chip.write(now, PLLSTS.offset, divsel(sel))
    return now


# PLL and SYSCLKOUT ------------------------------------------------------------


@pytest.mark.rule("SYS-001")
def test_reset_clock_is_a_quarter_of_oscclk():
    chip = SystemControl(30 * MHZ, SystemOptions())
    assert ratio(chip) == (1, 4)
    assert chip.sysclk_hz == 7_500_000


@pytest.mark.rule("SYS-002")
def test_boot_rom_leaves_half_of_oscclk():
    chip = system()
    chip.boot(5000)
    assert ratio(chip) == (1, 2)
    assert chip.read(5000, PLLSTS.offset) == divsel(2) | 1


@pytest.mark.rule("SYS-003")
@pytest.mark.parametrize(("sel", "expected"), [(0, (1, 4)), (1, (1, 4)), (2, (1, 2)), (3, (1, 1))])
def test_bypass_divides_by_divsel(sel, expected):
    chip = system((PLLSTS, divsel(sel)))
    assert ratio(chip) == expected
    assert not chip.notes


@pytest.mark.rule("SYS-004")
@pytest.mark.parametrize("div", range(1, 11))
@pytest.mark.parametrize(("sel", "divide"), [(0, 4), (1, 4), (2, 2)])
def test_pll_multiplies_by_pllcr_and_divides_by_divsel(div, sel, divide):
    chip = system()
    program_pll(chip, 0, div, sel)
    assert Fraction(*ratio(chip)) == Fraction(div, divide)
    assert not chip.notes


@pytest.mark.rule("SYS-010")
def test_30_mhz_times_10_by_2_is_150_mhz():
    chip = system()
    program_pll(chip, 0, 10, 2)
    assert chip.sysclk_hz == 150 * MHZ


@pytest.mark.rule("SYS-005")
@pytest.mark.parametrize(
    ("oscclk_hz", "div", "sel", "said"),
    [
        (30 * MHZ, 10, 3, "DIVSEL = 3 with PLLCR = 10"),
        (30 * MHZ, 11, 0, "PLLCR = 11 is reserved"),
        (30 * MHZ, 15, 0, "PLLCR = 15 is reserved"),
        (31 * MHZ, 10, 2, "310000000 Hz; at most 300000000"),
    ],
)
def test_settings_the_manual_excludes_are_reported(oscclk_hz, div, sel, said):
    chip = system(oscclk_hz=oscclk_hz)
    program_pll(chip, 0, div, sel)
    assert [note.code for note in chip.notes] == ["duty"]
    assert said in chip.notes[0].text


@pytest.mark.rule("SYS-005")
def test_the_vco_may_run_at_exactly_300_mhz():
    chip = system()
    program_pll(chip, 0, 10, 2)
    assert not chip.notes


@pytest.mark.rule("SYS-006")
def test_pllcr_write_starts_a_lock_of_131072_oscclk():
    chip = system((PLLSTS, MCLKOFF))
    chip.write(100, PLLCR.offset, 10)
    assert chip.read(100, PLLSTS.offset) == MCLKOFF  # PLLLOCKS = 0
    assert chip.next_wake == 100 + 131072 // 4
    assert chip.peek(100 + 131072 // 4 - 1, PLLSTS.offset) == MCLKOFF
    chip.wake(100 + 131072 // 4)
    assert chip.read(100 + 131072 // 4, PLLSTS.offset) == MCLKOFF | 1
    assert ratio(chip) == (5, 2)  # 10/4


@pytest.mark.rule("SYS-007")
@pytest.mark.parametrize(("clock", "expected"), [("osc_div_4", (1, 4)), ("osc_div_2", (1, 2))])
def test_open_pll_lock_clock(clock, expected):
    chip = locking(10, pll_lock_clock=clock)
    assert ratio(chip) == expected
    locked = 131072 * expected[0] // expected[1]
    assert chip.next_wake == locked
    chip.wake(locked)
    assert ratio(chip) == (5, 2)
    assert chip.touched == {"pll_lock_clock"}


@pytest.mark.rule("SYS-008")
@pytest.mark.parametrize("sel", [1, 2])
def test_pllcr_with_divsel_not_0_is_reported(sel):
    chip = locking(bits=divsel(sel) | MCLKOFF)
    assert [note.text for note in chip.notes] == [f"PLLCR was written with PLLSTS.DIVSEL = {sel}; it must be 0 first"]


@pytest.mark.rule("SYS-008")
def test_divsel_changed_while_locking_is_reported():
    chip = locking()
    chip.write(2, PLLSTS.offset, MCLKOFF)  # DIVSEL is unchanged, so there is no note
    assert not chip.notes
    chip.write(3, PLLSTS.offset, divsel(2))
    assert [note.code for note in chip.notes] == ["duty"]
    assert "while the PLL locks" in chip.notes[0].text


@pytest.mark.parametrize(
    ("pllsts", "said"), [(0, "MCLKOFF = 0"), (MCLKOFF | 4, "PLLOFF = 1")], ids=["MCLKOFF", "PLLOFF"]
)
def test_other_broken_rules_of_a_pllcr_write_are_reported(pllsts, said):
    chip = locking(bits=pllsts)
    assert len(chip.notes) == 1
    assert said in chip.notes[0].text


def test_pllcr_write_with_the_watchdog_on_is_reported():
    chip = system((WDCR, 0x28), (PLLSTS, MCLKOFF), (PLLCR, 5))
    assert [note.source for note in chip.notes] == ["SPRS439M section 3.6.1.2"]


def test_settings_that_are_not_modelled_are_reported():
    chip = system()
    chip.write(0, PLLSTS.offset, 0x20)  # OSCOFF
    chip.write(0, LPMCR0.offset, 1)  # STANDBY
    assert [note.code for note in chip.notes] == ["unknown", "unknown"]


@pytest.mark.rule("SYS-009")
@pytest.mark.parametrize("by_watchdog", [False, True])
def test_xrs_and_the_watchdog_reset_the_pll(by_watchdog: bool):
    chip = system()
    now = program_pll(chip, 0, 10, 2)
    chip.write(now, HISPCP.offset, 0)
    if by_watchdog:
        chip.write(now, WDCR.offset, 0)  # a wrong WDCHK resets at once
    assert chip.reset_requested == by_watchdog
    chip.reset(now)
    assert (ratio(chip), chip.lspclk_divider, chip.hspclk_divider) == ((1, 4), 4, 2)
    assert chip.read(now, PLLCR.offset) == 0
    assert chip.read(now, PLLSTS.offset) == 1


# Prescalers ---------------------------------------------------------------------

CODES = [(0, 1), (1, 2), (2, 4), (3, 6), (4, 8), (5, 10), (6, 12), (7, 14)]


@pytest.mark.rule("SYS-011")
@pytest.mark.parametrize(("code", "divider"), CODES)
def test_lospcp_divides(code, divider):
    chip = system((LOSPCP, 0xFFF8 | code))
    assert chip.lspclk_divider == divider
    assert chip.read(0, LOSPCP.offset) == code


@pytest.mark.rule("SYS-012")
def test_lspclk_is_a_quarter_after_reset():
    chip = system((LOSPCP, 7))
    chip.reset(10)
    assert chip.read(10, LOSPCP.offset) == 2
    assert chip.lspclk_divider == 4


@pytest.mark.rule("SYS-013")
@pytest.mark.parametrize(("code", "divider"), CODES)
def test_hispcp_divides(code, divider):
    chip = system()
    assert (chip.read(0, HISPCP.offset), chip.hspclk_divider) == (1, 2)
    chip.write(0, HISPCP.offset, code)
    assert chip.hspclk_divider == divider


@pytest.mark.rule("SYS-014")
@pytest.mark.parametrize(("way", "phase"), [("free_running", 100), ("restart_on_write", 207)])
def test_open_lspclk_phase(way, phase):
    chip = system(lspclk_phase=way)
    chip.reset(100)
    chip.write(207, LOSPCP.offset, 3)
    assert chip.lspclk_phase == phase
    assert chip.touched == {"lspclk_phase"}


@pytest.mark.rule("SYS-015")
def test_the_clock_of_each_module():
    chip = system((LOSPCP, 3), (HISPCP, 4))
    clocks = {
        name: PART.by_name[name].clock for name in ("SCI-A", "SCI-B", "SCI-C", "I2C-A", "TIMER0", "TIMER1", "TIMER2")
    }
    assert list(clocks.values()) == ["LSPCLK"] * 3 + ["SYSCLKOUT"] * 4
    assert (chip.lspclk_divider, chip.hspclk_divider) == (6, 8)


# Gates ----------------------------------------------------------------------------


@pytest.mark.rule("SYS-016", "SYS-017")
def test_clocks_after_reset():
    chip = system()
    assert [chip.read(0, r.offset) for r in (PCLKCR0, PCLKCR1, PCLKCR3)] == [0, 0, 0x2700]
    assert {gate for gate in GATES if chip.enabled(gate)} == {"GPIOINENCLK", *(f"CPUTIMER{n}ENCLK" for n in range(3))}


@pytest.mark.rule("SYS-016", "SYS-017")
@pytest.mark.parametrize(
    ("gate", "offset", "bit"),
    [
        ("SCIAENCLK", 0x0C, 10),
        ("SCIBENCLK", 0x0C, 11),
        ("SCICENCLK", 0x0C, 5),
        ("I2CAENCLK", 0x0C, 4),
        ("GPIOINENCLK", 0x10, 13),
        ("XINTFENCLK", 0x10, 12),
        ("DMAENCLK", 0x10, 11),
        ("CPUTIMER2ENCLK", 0x10, 10),
        ("CPUTIMER1ENCLK", 0x10, 9),
        ("CPUTIMER0ENCLK", 0x10, 8),
    ],
)
def test_each_bit_gates_only_its_module(gate, offset, bit):
    chip = system((PCLKCR3, 0))
    chip.write(0, offset, 1 << bit)
    run_until(chip, 2)
    assert [one for one in GATES if chip.enabled(one)] == [gate]


class GateRig(DiagramRig):
    """Writes enable bits by read-modify-write accesses, and shows which modules have their clock."""

    BITS = {"SCIAENCLK": (PCLKCR0, 1 << 10), "I2CAENCLK": (PCLKCR0, 1 << 4), "CPUTIMER0ENCLK": (PCLKCR3, 1 << 8)}

    def __init__(self) -> None:
        self.chip = system()

    def drive(self, now: int, signal: str, level: int) -> None:
        register, bit = self.BITS[signal]
        run_until(self.chip, now)
        before = self.chip.read(now, register.offset)
        self.chip.write(now, register.offset, before & ~bit | (bit if level else 0))

    def run_until(self, time: int) -> None:
        run_until(self.chip, time)

    def show(self, signal: str) -> int:
        return int(self.chip.enabled(PART.by_name[signal].gate))


@pytest.mark.rule("SYS-018")
def test_a_gate_opens_and_closes_2_cycles_after_the_write():
    GateRig().check("""
        > SCIAENCLK       0 1 . 0 . . . 1 0 . . .
        < SCI-A           0 . . 1 . 0 . . . 1 0 .
        > I2CAENCLK       0 . 1 . . . . . . . . .
        < I2C-A           0 . . . 1 . . . . . . .
        > CPUTIMER0ENCLK  1 . . . . 0 . . . . . .
        < TIMER0          1 . . . . . . 0 . . . .
    """)


@pytest.mark.rule("SYS-018")
def test_the_written_value_reads_back_before_it_takes_effect():
    chip = system((PCLKCR0, 1 << 10))
    assert chip.read(1, PCLKCR0.offset) == 1 << 10
    assert not chip.enabled("SCIAENCLK")
    assert chip.next_wake == GATE_DELAY


def test_writes_in_successive_cycles_take_effect_in_successive_cycles():
    chip = SystemControl(30 * MHZ, SystemOptions())
    chip.write(0, PCLKCR3.offset, 0)
    chip.write(1, PCLKCR0.offset, 1 << 10)
    seen = [(chip.wake(now), chip.enabled("CPUTIMER0ENCLK"), chip.enabled("SCIAENCLK"))[1:] for now in (1, 2, 3)]
    assert seen == [(True, False), (False, False), (False, True)]


def test_reset_cancels_a_pending_change_of_a_gate():
    chip = system((PCLKCR0, 1 << 10))
    chip.reset(1)
    run_until(chip, 10)
    assert not chip.enabled("SCIAENCLK")


@pytest.mark.rule("SYS-019")
def test_every_register_here_needs_eallow_to_be_written():
    addresses = {r.name: BASE + r.offset for r in MAP if r.protected}
    assert addresses == {
        "PLLSTS": 0x7011,
        "HISPCP": 0x701A,
        "LOSPCP": 0x701B,
        "PCLKCR0": 0x701C,
        "PCLKCR1": 0x701D,
        "LPMCR0": 0x701E,
        "PCLKCR3": 0x7020,
        "PLLCR": 0x7021,
        "SCSR": 0x7022,
        "WDCNTR": 0x7023,
        "WDKEY": 0x7025,
        "WDCR": 0x7029,
    }
    assert len(addresses) == len(list(MAP))


# OSCCLK during changes of the ratio -------------------------------------------------


@given(
    st.lists(st.tuples(st.integers(1, 10_000), st.integers(1, 10), st.sampled_from([1, 2, 4])), min_size=1, max_size=8)
)
def test_oscclk_positions_are_exact_after_any_changes(changes):
    clock = OscClock()
    now, position, ratio_now = 0, Fraction(0), Fraction(1, 4)
    for cycles, numerator, denominator in changes:
        now += cycles
        position += cycles / ratio_now
        clock.retune(now, numerator, denominator)
        ratio_now = Fraction(numerator, denominator)
        assert Fraction(clock.at(now), PARTS) == position
        assert clock.cycle_at(clock.at(now)) == now
        assert clock.cycle_at(clock.at(now + 7) + 1) == now + 8


def test_a_pll_lock_is_counted_in_oscclk_across_a_change_of_divsel():
    chip = locking(10)
    chip.write(1000, PLLSTS.offset, divsel(2))  # not allowed, and noted: the bypass clock doubles
    assert chip.next_wake == 1000 + (131072 - 4 * 1000) // 2


def test_a_read_includes_changes_that_are_due():
    """The chip was not woken at the end of the lock."""
    chip = locking()
    assert [chip.read(now, PLLSTS.offset) & 1 for now in (LOCK - 1, LOCK)] == [0, 1]
