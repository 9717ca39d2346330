"""The peripheral interrupt expansion. Rules SYS-096 to SYS-125 as far as they concern the PIE alone.

Rules that concern the CPU as well (SYS-112, 124, 126) are tested in test_interrupts.py.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.options import options_from
from periph_sim.f28335.cpu_timer.module import CpuTimer
from periph_sim.f28335.cpu_timer.register_map import PRD, TCR
from periph_sim.f28335.pie.module import Pie
from periph_sim.f28335.pie.register_map import (
    CPU_VECTORS,
    LINES,
    PIEACK,
    PIECTRL,
    PIEIER,
    PIEIFR,
    VECTORS,
    line_vector,
)
from periph_sim.f28335.system_options import SystemOptions
from tests.waves import DiagramRig

ALL = 0xFFFF
groups = st.integers(1, 12)
lines = st.integers(1, 8)


def fresh(**options: int | str) -> Pie:
    return Pie(options_from(SystemOptions, dict(options)))


def pie(enabled: dict[int, int] | None = None, **options: int | str) -> Pie:
    """Return a PIE as start-up code leaves it: enabled, all groups acknowledged. enabled: group -> PIEIER."""
    chip = fresh(**options)
    chip.write(0, PIECTRL.offset, 1)
    chip.write(0, PIEACK.offset, ALL)
    for group, bits in (enabled or {}).items():
        enable(chip, group, bits)
    return chip


def enable(chip: Pie, group: int, bits: int, now: int = 0) -> None:
    chip.write(now, PIEIER[group - 1].offset, bits)


def flags(chip: Pie, group: int) -> int:
    return chip.peek(0, PIEIFR[group - 1].offset)


def pulses(chip: Pie) -> list[int]:
    """Return the numbers of the INT lines that have pulsed since the last call."""
    seen = [n for n in range(1, 13) if chip.pulses >> n - 1 & 1]
    chip.pulses = 0
    return seen


class PieRig(DiagramRig):
    """Group 9. REQ, HOLD and LETGO have the number of a line; ACK writes PIEACK; FETCH is a vector fetch of the CPU."""

    def __init__(self, chip: Pie) -> None:
        self.chip = chip
        self.line = 0
        self.requested = 0

    def drive(self, now: int, signal: str, level: int) -> None:
        if signal == "REQ":
            self.chip.request(now, 9, level)
        elif signal == "HOLD":
            self.chip.hold(now, 9, level, True)
        elif signal == "LETGO":
            self.chip.hold(now, 9, level, False)
        elif signal == "ACK":
            self.chip.write(now, PIEACK.offset, level << 8)
        elif signal == "PIEIER":
            enable(self.chip, 9, level, now)
        elif signal == "FETCH":
            self.line = self.chip.vector(now, 9)[0]

    def run_until(self, time: int) -> None:
        self.requested = len(pulses(self.chip))

    def show(self, signal: str) -> int:
        if signal == "INT9":
            return self.requested
        if signal == "PIEACK":
            return self.chip.peek(0, PIEACK.offset) >> 8 & 1
        return flags(self.chip, 9) if signal == "PIEIFR" else self.line


@pytest.mark.rule("SYS-096", "SYS-099", "SYS-101", "SYS-109")
def test_one_request_from_flag_to_acknowledge():
    PieRig(pie()).check("""
        > PIEIER  1 . . . . . . .
        > REQ     . . 1 . . . . .
        > FETCH   . . . . 1 . . .
        > ACK     . . . . . . 1 .
        < PIEIFR  0 . 1 . 0 . . .
        < PIEACK  0 . 1 . . . 0 .
        < INT9    0 . 1 0 . . . .
        < LINE    0 . . . 1 . . .
    """)


@pytest.mark.rule("SYS-096")
@given(group=groups, line=lines, enabled=st.integers(0, 255))
def test_a_request_sets_its_flag_for_any_pieier(group, line, enabled):
    chip = pie({group: enabled})
    chip.request(1, group, line)
    assert [flags(chip, g) for g in range(1, 13)] == [(1 << line - 1) * (g == group) for g in range(1, 13)]
    assert pulses(chip) == ([group] if enabled >> line - 1 & 1 else [])


@pytest.mark.rule("SYS-099")
def test_enabling_a_flagged_line_sends_it():
    PieRig(pie()).check("""
        > REQ     3 . . .
        > PIEIER  0 . 4 .
        < PIEIFR  4 . . .
        < PIEACK  0 . 1 .
        < INT9    0 . 1 0
    """)


@pytest.mark.rule("SYS-100", "SYS-101", "SYS-110")
def test_a_group_that_is_not_acknowledged_keeps_requests_until_the_acknowledge():
    PieRig(pie()).check("""
        > PIEIER  3 . . . . . . .
        > REQ     1 . 2 . . 1 . .
        > FETCH   . 1 . . . . . 1
        > ACK     . . . . . . 1 .
        < PIEIFR  1 0 2 . . 3 . 2
        < PIEACK  1 . . . . . . .
        < INT9    1 0 . . . . 1 0
    """)


@pytest.mark.rule("SYS-102")
def test_writing_0_to_pieack_does_nothing():
    PieRig(pie()).check("""
        > PIEIER  3 . . . . .
        > REQ     1 . 2 . . .
        > ACK     . . . 0 . 1
        < PIEACK  1 . . . . .
        < INT9    1 0 . . . 1
    """)


@pytest.mark.rule("SYS-103")
def test_a_group_that_is_not_acknowledged_blocks_no_other_group():
    chip = pie({8: 1, 9: 1})
    chip.request(1, 8, 1)
    assert pulses(chip) == [8]
    chip.vector(2, 8)
    chip.request(2, 9, 1)
    assert pulses(chip) == [9]
    chip.write(3, PIEACK.offset, 1 << 7)
    assert chip.peek(3, PIEACK.offset) == 1 << 8


@pytest.mark.rule("SYS-104")
@pytest.mark.parametrize(("value", "sent"), [(0xFFF, []), (0x000, [9])])
def test_open_pieack_reset(value, sent):
    chip = fresh(pieack_reset=value)
    assert chip.peek(0, PIEACK.offset) == value
    assert "pieack_reset" not in chip.touched
    enable(chip, 9, 1)
    chip.request(1, 9, 1)
    assert pulses(chip) == sent
    assert chip.touched == {"pieack_reset"}


def test_a_program_without_a_first_acknowledge_is_served_after_reset():
    """TI's examples for I2C, SCI and the timers enable a line and wait; only the service routine writes PIEACK."""
    chip = fresh()
    chip.write(0, PIECTRL.offset, 1)
    enable(chip, 9, 1)
    chip.request(1, 9, 1)
    assert pulses(chip) == [9]
    assert not chip.notes


def test_a_request_blocked_by_the_reset_value_of_pieack_is_noted_once_per_group():
    chip = fresh(pieack_reset=0xFFF)
    enable(chip, 8, 2)
    chip.request(1, 8, 1)  # line 1 is not enabled, so PIEACK blocks nothing
    assert not chip.notes
    chip.request(2, 8, 2)
    chip.request(3, 8, 2)
    assert [(note.code, note.text.partition(";")[0]) for note in chip.notes] == [
        ("unknown", "request of group 8 is blocked by the reset value of PIEACK (pieack_reset = 0xfff)")
    ]
    chip.write(4, PIEACK.offset, 1 << 7)
    chip.request(5, 8, 2)  # blocked because firmware has not acknowledged, not by the reset value
    assert len(chip.notes) == 1


def test_software_that_acknowledges_first_does_not_touch_pieack_reset():
    chip = pie({9: 1})
    chip.request(1, 9, 1)
    assert pulses(chip) == [9]
    assert not chip.touched


def test_only_a_read_of_pieack_before_its_first_write_touches_pieack_reset():
    chip, acknowledged = fresh(), pie()
    chip.read(0, PIECTRL.offset)
    acknowledged.read(1, PIEACK.offset)
    assert (chip.touched, acknowledged.touched) == (set(), set())
    chip.read(0, PIEACK.offset)
    assert chip.touched == {"pieack_reset"}


@pytest.mark.rule("SYS-105")
def test_pieier_and_pieifr_are_0_after_reset():
    chip = pie()
    for group in range(1, 13):
        enable(chip, group, 0xFF)
        chip.request(1, group, 3)
    chip.reset(2)
    assert [chip.peek(2, r.offset) for r in (*PIEIER, *PIEIFR)] == [0] * 24
    assert chip.peek(2, PIECTRL.offset) == 0
    assert chip.pulses == 0


@pytest.mark.rule("SYS-106", "SYS-107", "SYS-109")
@given(group=groups, flagged=st.integers(0, 255), enabled=st.integers(0, 255))
def test_the_lowest_line_flagged_and_enabled_is_taken(group, flagged, enabled):
    chip = pie({group: enabled})
    for line in range(1, 9):
        if flagged >> line - 1 & 1:
            chip.request(1, group, line)
    ready = [n for n in range(1, 9) if flagged & enabled & 1 << n - 1]
    expected = ready[0] if ready else 1
    assert chip.vector(2, group) == (expected, line_vector(group, expected))
    assert flags(chip, group) == flagged & ~(1 << expected - 1)


@pytest.mark.rule("SYS-107", "SYS-111")
def test_a_lower_line_that_is_requested_before_the_fetch_is_served_first():
    PieRig(pie()).check("""
        > PIEIER  f . . . . . .
        > REQ     4 2 . . . . .
        > FETCH   . . 1 . . 1 .
        > ACK     . . . . 1 . .
        < PIEIFR  8 a 8 . . 0 .
        < INT9    1 0 . . 1 0 .
        < LINE    0 . 2 . . 4 .
    """)


@pytest.mark.rule("SYS-111")
def test_two_lines_in_one_cycle_are_served_in_order_with_an_acknowledge_between():
    chip = pie({1: 0xFF})
    chip.request(1, 1, 8)
    chip.request(1, 1, 1)
    assert pulses(chip) == [1]
    assert chip.vector(5, 1)[0] == 1
    assert pulses(chip) == []
    chip.write(6, PIEACK.offset, 1)
    assert pulses(chip) == [1]
    assert chip.vector(10, 1)[0] == 8


@pytest.mark.rule("SYS-108", "SYS-125")
def test_a_line_disabled_after_the_pulse_is_served_as_line_1():
    PieRig(pie()).check("""
        > PIEIER  4 . 0 . . .
        > REQ     3 . . . . .
        > FETCH   . . . . 1 .
        < PIEIFR  4 . . . . .
        < INT9    1 0 . . . .
        < LINE    0 . . . 1 .
    """)


@pytest.mark.rule("SYS-113")
def test_a_request_in_the_cycle_of_a_write_wins():
    chip = pie()
    chip.request(4, 9, 2)
    chip.request(5, 9, 1)
    chip.write(5, PIEIFR[8].offset, 0)
    assert flags(chip, 9) == 1  # line 2 was requested a cycle earlier, so the write clears it


@pytest.mark.rule("SYS-113")
def test_a_request_after_a_write_in_the_same_cycle_sets_its_flag():
    chip = pie()
    chip.write(5, PIEIFR[8].offset, 0)
    chip.request(5, 9, 1)
    assert flags(chip, 9) == 1


@pytest.mark.rule("SYS-114")
def test_a_request_lost_by_a_read_modify_write_is_noted():
    chip = pie()
    chip.request(0, 9, 1)
    seen = chip.read(10, PIEIFR[8].offset)
    chip.request(11, 9, 3)
    chip.write(13, PIEIFR[8].offset, seen)
    assert flags(chip, 9) == 1
    assert [note.code for note in chip.notes] == ["lost"]
    assert "0x04" in chip.notes[0].text


@pytest.mark.rule("SYS-114")
def test_clearing_a_flag_by_software_works_and_is_reported():
    chip = pie()
    chip.request(0, 9, 1)
    chip.read(10, PIEIFR[8].offset)
    chip.write(13, PIEIFR[8].offset, 0)
    assert flags(chip, 9) == 0
    assert [note.code for note in chip.notes] == ["duty"]


def test_setting_a_flag_by_software_interrupts():
    chip = pie({11: 1})
    chip.write(3, PIEIFR[10].offset, 1)
    assert pulses(chip) == [11]
    assert not chip.notes


@pytest.mark.rule("SYS-115")
def test_with_enpie_0_vectors_come_from_boot_rom_and_the_registers_work():
    chip = fresh()
    chip.write(0, PIEACK.offset, ALL)
    enable(chip, 9, 0x5)
    chip.request(1, 9, 3)
    assert (chip.read(1, PIEIER[8].offset), chip.read(1, PIEIFR[8].offset)) == (5, 4)
    assert chip.read(1, PIEACK.offset) == 1 << 8
    assert chip.vector(2, 9) == (0, 0x3FFFC0 + 2 * 9)
    assert chip.cpu_vector(13) == 0x3FFFC0 + 2 * 13
    assert chip.cpu_vector(9) == 0x3FFFC0 + 2 * 9
    assert chip.read(2, PIECTRL.offset) == 0


@pytest.mark.rule("SYS-116")
def test_with_enpie_1_vectors_come_from_the_table_but_the_reset_vector():
    chip = pie()
    assert chip.cpu_vector(CPU_VECTORS["RESET"]) == 0x3FFFC0
    assert [chip.cpu_vector(n) for n in (13, 14, 15, 16, 17, 18, 19, 20, 31)] == [
        *(0xD1A, 0xD1C, 0xD1E, 0xD20, 0xD22, 0xD24, 0xD26, 0xD28, 0xD3E)
    ]
    assert chip.vector(0, 12)[1] == 0xDF0


@pytest.mark.rule("SYS-117")
def test_piectrl_shows_the_last_vector():
    chip = pie({9: 4})
    chip.request(1, 9, 3)
    chip.vector(2, 9)
    assert chip.read(2, PIECTRL.offset) == 0xDC4 | 1
    chip.cpu_vector(19)
    assert chip.read(3, PIECTRL.offset) == 0xD27  # the example of the manual
    chip.write(4, PIECTRL.offset, 0xFFFE)
    assert chip.read(4, PIECTRL.offset) == 0xD26  # PIEVECT cannot be written


@pytest.mark.rule("SYS-118")
@given(group=groups, line=lines)
def test_addresses_of_the_vectors(group, line):
    chip = pie({group: 0xFF})
    chip.request(0, group, line)
    assert chip.vector(0, group) == (line, 0xD40 + 16 * (group - 1) + 2 * (line - 1))


@pytest.mark.rule("SYS-119", "SYS-120", "SYS-121", "SYS-122")
def test_lines_of_groups_1_8_9_and_12():
    assert {name: LINES[name] for name in LINES if LINES[name][0] in (1, 8, 9, 12)} == {
        "SEQ1INT": (1, 1),
        "SEQ2INT": (1, 2),
        "XINT1": (1, 4),
        "XINT2": (1, 5),
        "ADCINT": (1, 6),
        "TINT0": (1, 7),
        "WAKEINT": (1, 8),
        "I2CINT1A": (8, 1),
        "I2CINT2A": (8, 2),
        "SCIRXINTC": (8, 5),
        "SCITXINTC": (8, 6),
        "SCIRXINTA": (9, 1),
        "SCITXINTA": (9, 2),
        "SCIRXINTB": (9, 3),
        "SCITXINTB": (9, 4),
        "ECAN0INTA": (9, 5),
        "ECAN1INTA": (9, 6),
        "ECAN0INTB": (9, 7),
        "ECAN1INTB": (9, 8),
        "XINT3": (12, 1),
        "XINT4": (12, 2),
        "XINT5": (12, 3),
        "XINT6": (12, 4),
        "XINT7": (12, 5),
        "LVF": (12, 7),
        "LUF": (12, 8),
    }


# Some rows of Table 112.
TABLE_112 = """
    INT13 D1A       NMI D24        USER12 D3E     WAKEINT D4E    EPWM1_TZINT D50  ECAP6_INT D7A
    EQEP2_INT D82   SPITXINTA D92  MXINTA D9A     DINTCH1 DA0    I2CINT1A DB0     SCIRXINTC DB8
    SCIRXINTA DC0   SCITXINTB DC6  ECAN1INTB DCE  XINT7 DF8      LUF DFE
"""


@pytest.mark.rule("SYS-118")
def test_vectors_by_name():
    words = TABLE_112.split()
    assert {name: f"{VECTORS[name]:X}" for name in words[::2]} == dict(zip(words[::2], words[1::2], strict=True))
    assert len(set(VECTORS.values())) == len(VECTORS)


@pytest.mark.rule("SYS-098")
def test_service_clears_no_peripheral_flag():
    timer, chip = CpuTimer(SystemOptions()), pie()
    enable(chip, 1, 1 << 6)
    timer.write(0, PRD.offset, 9)
    timer.write(0, TCR.offset, 0x4020)
    timer.wake(9)
    chip.request(9, *LINES["TINT0"])
    assert chip.vector(14, 1)[0] == 7
    chip.write(20, PIEACK.offset, 1)
    assert flags(chip, 1) == 0
    assert timer.peek(20, TCR.offset) & 0x8000


# Lines held asserted --------------------------------------------------------------


@pytest.mark.parametrize(
    ("way", "pieifr", "int9"),
    [
        ("at_pieack", "1 0 . 1 0 . . . . .", "1 0 . 1 0 . . . . ."),
        ("at_vector_fetch", "1" + " ." * 9, "1 0 . 1 0 . . . 1 0"),
    ],
)
def test_open_pie_held_line(way, pieifr, int9):
    chip = pie(pie_held_line=way)
    PieRig(chip).check(f"""
        > PIEIER  1 . . . . . . . . .
        > HOLD    1 . . . . . . . . .
        > FETCH   . 1 . . 1 . . . . .
        > ACK     . . . 1 . . . . 1 .
        > LETGO   . . . . . . 1 . . .
        < PIEIFR  {pieifr}
        < INT9    {int9}
    """)
    assert chip.touched == {"pie_held_line"}


@pytest.mark.parametrize(("way", "left"), [("at_pieack", 0), ("at_vector_fetch", 1)])
def test_open_pie_held_line_against_a_cpu_write(way, left):
    chip = pie(pie_held_line=way)
    chip.hold(0, 9, 1, True)
    chip.read(1, PIEIFR[8].offset)
    chip.write(2, PIEIFR[8].offset, 0)
    assert flags(chip, 9) == left


def test_holding_a_held_line_again_requests_nothing():
    chip = pie({9: 1})
    chip.hold(0, 9, 1, True)
    chip.vector(1, 9)
    chip.hold(2, 9, 1, True)
    assert flags(chip, 9) == 0
