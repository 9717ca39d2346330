"""I2C registers: offsets, reset values, bits that software can write, the clock gate. SPRUG03B, Tables 4 to 22."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.f28335.i2c.register_map import I2C_MAP

from ..i2c_bus import SDA
from ..i2c_registers import (
    BB,
    DLB,
    FDF,
    FFEN,
    FFRST,
    FREE,
    IRS,
    MST,
    NACKMOD,
    OFFSET,
    RM,
    RRDY,
    STB,
    STP,
    STR_RESET,
    STT,
    TRX,
    XA,
)
from ..i2c_rig import Rig, addressed

RESET = dict.fromkeys(OFFSET, 0) | {"I2CSTR": 0x0410, "I2CSAR": 0x3FF, "I2CEMDR": 1}

# The bits that a write changes while the module is in reset (IRS = 0).
STORED = {
    "I2COAR": 0x03FF,
    "I2CIER": 0x007F,
    "I2CCLKL": 0xFFFF,
    "I2CCLKH": 0xFFFF,
    "I2CCNT": 0xFFFF,
    "I2CSAR": 0x03FF,
    "I2CDXR": 0x00FF,
    "I2CISRC": 0x0F00,
    "I2CEMDR": 0x0001,
    "I2CPSC": 0x00FF,
    "I2CFFTX": 0x603F,
    "I2CFFRX": 0x203F,
    "I2CDRR": 0x0000,
}


def fresh() -> Rig:
    """Return a rig after a system reset, with the clock enabled."""
    rig = Rig()
    rig.reset()
    return rig


@pytest.mark.rule("I2C-001", "I2C-002")
def test_every_register_is_at_its_offset():
    assert {r.name: r.offset for r in I2C_MAP} == OFFSET


@pytest.mark.rule("I2C-004")
def test_no_register_is_protected():
    assert [r.name for r in I2C_MAP if r.protected] == []


@pytest.mark.rule(
    *(f"I2C-{n:03}" for n in range(11, 21)), "I2C-022", "I2C-023", "I2C-024", "I2C-025", "I2C-026", "I2C-027", "I2C-335"
)
@pytest.mark.parametrize("name", OFFSET)
def test_reset_value(name):
    assert fresh().read(name) == RESET[name]


@pytest.mark.rule(
    "I2C-011",
    "I2C-012",
    "I2C-014",
    "I2C-015",
    "I2C-016",
    "I2C-017",
    "I2C-018",
    "I2C-019",
    "I2C-022",
    "I2C-023",
    "I2C-024",
    "I2C-025",
    "I2C-026",
    "I2C-027",
    "I2C-296",
)
@pytest.mark.parametrize("name", STORED)
@pytest.mark.parametrize("pattern", [0xFFFF, 0x0000, 0xAAAA, 0x5555])
def test_a_write_changes_only_the_writable_bits(name, pattern):
    rig = fresh()
    rig.write(name, 0)
    rig.write(name, pattern)
    assert rig.read(name) == pattern & STORED[name]


@pytest.mark.rule("I2C-026", "I2C-027")
@pytest.mark.parametrize("name", ["I2CFFTX", "I2CFFRX"])
def test_fifo_counts_and_flags_are_read_only(name):
    """Bits 12:7, the count and the flag, do not change when they are written."""
    rig = fresh()
    before = rig.read(name) & 0x1F80
    rig.write(name, 0x1F80)
    assert rig.read(name) & 0x1F80 == before == 0


@settings(max_examples=30, deadline=None)
@given(name=st.sampled_from(sorted(STORED)), first=st.integers(0, 0xFFFF), second=st.integers(0, 0xFFFF))
def test_the_value_read_back_depends_only_on_the_last_write(name, first, second):
    twice, once = fresh(), fresh()
    twice.write(name, first)
    twice.write(name, second)
    once.write(name, second)
    assert twice.read(name) == once.read(name)


@pytest.mark.rule("I2C-013")
@pytest.mark.parametrize("bit", [15, 7, 6])
def test_reserved_bits_of_str_read_0(bit):
    rig = fresh()
    rig.write("I2CSTR", 1 << bit)
    assert rig.read("I2CSTR") == 0x0410


@pytest.mark.rule("I2C-020")
@pytest.mark.parametrize("bits", [NACKMOD, FREE, MST, TRX, XA, RM, IRS, STB, FDF, 1, 2, 4, MST | DLB])
def test_every_bit_of_mdr_keeps_what_is_written(bits):
    rig = fresh()
    rig.write("I2CMDR", bits)
    assert rig.read("I2CMDR") == bits
    rig.write("I2CMDR", 0)
    assert rig.read("I2CMDR") == 0


@pytest.mark.rule("I2C-020")
@pytest.mark.parametrize("bits", [STT, STP])
def test_start_and_stop_bits_keep_what_is_written_once_irs_is_1(bits):
    rig = Rig().begin()
    rig.write("I2CMDR", IRS | bits)
    assert rig.read("I2CMDR") == IRS | bits


@pytest.mark.rule("I2C-021")
@pytest.mark.parametrize("irs", [0, IRS])
def test_bit_12_of_mdr_reads_0(irs):
    rig = fresh()
    rig.write("I2CMDR", irs)
    rig.write("I2CMDR", irs | 1 << 12)
    assert rig.read("I2CMDR") == irs


@pytest.mark.rule("I2C-033", "I2C-034")
@pytest.mark.parametrize("bits", [STT, STP, STT | STP])
def test_start_and_stop_bits_cannot_be_written_in_reset(bits):
    rig = fresh()
    rig.write("I2CMDR", MST | bits)
    assert rig.read("I2CMDR") == MST


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        pytest.param("I2CISRC", 0, 0x0100, marks=pytest.mark.rule("I2C-023")),
        pytest.param("I2CEMDR", 1, 0x0002, marks=pytest.mark.rule("I2C-024")),
    ],
)
def test_ones_in_the_upper_bits_are_noted(name, good, bad):
    rig = fresh()
    rig.write(name, good)
    assert rig.duties() == []
    rig.write(name, bad)
    assert len(rig.duties()) == 1


@pytest.mark.rule("I2C-081")
@pytest.mark.parametrize(("sar", "xa", "broken"), [(0x2A, 0, 0), (0x3AA, 0, 1), (0x3FF, 0, 1), (0x3AA, XA, 0)])
def test_ones_in_the_upper_bits_of_sar_are_noted_at_a_7_bit_start(sar, xa, broken):
    """A reset sets the bits to 1. They are checked at each START; the sent address is bits 6 to 0 in any case."""
    rig = Rig().begin()
    rig.write("I2CCNT", 1)
    rig.write("I2CSAR", sar)
    assert rig.duties() == []
    rig.write("I2CMDR", IRS | MST | TRX | STT | xa)
    rig.wait(10_000)
    assert rig.duties() == [f"I2CSAR = {sar:#05x} has bits 9 to 7 set with XA = 0; expected 0 there"] * broken


@pytest.mark.rule("I2C-003")
def test_the_receive_shift_register_cannot_be_read():
    """0x5A is in I2CRSR because 0xA5 was not read from I2CDRR."""
    rig = addressed(sent=[0xA5])
    rig.send_bits(0x5A)
    seen = {offset: rig.chip.read(rig.now, offset) & 0xFF for offset in range(0x40) if offset != OFFSET["I2CDRR"]}
    assert 0x5A not in seen.values()


@pytest.mark.rule("I2C-003")
def test_the_transmit_shift_register_cannot_be_accessed():
    """0x3C is in I2CXSR, and 0x77 in I2CDXR; writes to offsets without a register change neither."""
    rig = addressed(read=1)
    rig.write_each(0x3C, 0x77)
    for offset in set(range(0x40)) - set(OFFSET.values()):
        assert rig.chip.read(rig.now, offset) == 0
        rig.chip.write(rig.now, offset, 0xFFFF)
        assert rig.chip.read(rig.now, offset) == 0
    assert [name for name in OFFSET if rig.peek(name) & 0xFF == 0x3C] == []
    assert (rig.read_byte(), rig.read_byte(ack=False)) == (0x3C, 0x77)


@pytest.mark.rule("I2C-028")
@pytest.mark.parametrize("value", [0x00, 0x55, 0xFF])
def test_the_drivers_are_open_drain(value):
    """The master pulls SDA in every data bit, so the line is low for any bits that the chip sends."""
    rig = addressed(read=1)
    rig.write("I2CDXR", value)
    sent = 0
    for _ in range(8):
        rig.rise(0)
        sent = sent << 1 | (not rig.pulling_sda)
        assert rig.level[SDA] == 0
        rig.fall()
    assert sent == value


@pytest.mark.rule("I2C-028")
def test_an_idle_module_releases_both_lines():
    rig = Rig()
    assert rig.released
    rig.begin()
    assert rig.released


@pytest.mark.rule("I2C-008")
def test_without_its_clock_the_module_acknowledges_no_address():
    rig = Rig().begin()
    rig.chip.gate(rig.now, False)
    assert not rig.address()
    rig.stop()
    rig.chip.gate(rig.now, True)
    assert rig.status() == STR_RESET


@pytest.mark.rule("I2C-008")
def test_the_clock_is_off_after_device_reset():
    rig = Rig()
    rig.chip.reset(rig.now)
    rig.write("I2COAR", 0x48)
    rig.write("I2CMDR", IRS)
    assert not rig.address()
    assert rig.read("I2CMDR") == 0


@pytest.mark.rule("I2C-008", "I2C-009")
def test_the_module_continues_when_its_clock_is_enabled_again():
    rig = Rig().begin()
    rig.chip.gate(rig.now, False)
    rig.wait(10_000)
    rig.chip.gate(rig.now, True)
    assert rig.address()
    assert rig.flag("BB")


@pytest.mark.rule("I2C-335", "I2C-336")
def test_a_system_reset_sets_the_reset_values_and_holds_the_module_in_reset():
    rig = addressed()
    rig.set_fifos(FFEN | FFRST | 3, FFRST | 5)
    for name in ("I2CIER", "I2CCLKL", "I2CCLKH", "I2CCNT", "I2CSAR", "I2CPSC"):
        rig.write(name, 0x15)
    rig.send(0x77)
    rig.reset()
    assert {name: rig.peek(name) for name in OFFSET} == RESET
    assert rig.released
    rig.put(scl=1, sda=1)
    assert not rig.address(0)
    assert rig.status(BB | RRDY) == 0
