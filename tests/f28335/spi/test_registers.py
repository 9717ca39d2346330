"""Registers of the SPI in CPU accesses: reset values, reserved and read-only bits, strobes, the clock gate."""

from __future__ import annotations

import pytest

from periph_sim.f28335.spi.module import Spi
from periph_sim.f28335.spi.register_map import BASE, SPI_MAP
from tests.f28335.module_rig import ModuleRig
from tests.f28335.spi_rig import LSPCLK, MASTER, SLAVE, SpiRig

# SPRUEU3 chapter 2, copied independently of the model: (offset, reset value, bits that software can write).
MANUAL = {
    "SPICCR": (0x0, 0x0000, 0x00DF),
    "SPICTL": (0x1, 0x0000, 0x001F),
    "SPISTS": (0x2, 0x0000, 0x0000),
    "SPIBRR": (0x4, 0x0000, 0x007F),
    "SPIRXEMU": (0x6, 0x0000, 0x0000),
    "SPIRXBUF": (0x7, 0x0000, 0x0000),
    "SPITXBUF": (0x8, 0x0000, 0xFFFF),
    "SPIDAT": (0x9, 0x0000, 0xFFFF),
    "SPIFFTX": (0xA, 0xA000, 0xE03F),
    "SPIFFRX": (0xB, 0x201F, 0x203F),
    "SPIFFCT": (0xC, 0x0000, 0x00FF),
    "SPIPRI": (0xF, 0x0000, 0x0030),
}


def in_the_middle_of_everything() -> SpiRig:
    """Return a rig with words in both FIFOs, an overflow, and a character being sent."""
    rig = SpiRig(fifo=True, RXFFIL=2, TXFFIL=3, SPIFFCT=0xFF, SPILBK=1, SPIPRI=0x30, SPICTL=0x1F)
    rig.set(TXDLY=0)
    rig.write("SPITXBUF", *(word << 8 for word in range(17)))
    rig.wait(17 * 8 + 2)
    rig.write("SPITXBUF", *(word << 8 for word in range(8)))
    rig.wait(1)
    return rig


@pytest.mark.rule("SPI-001")
def test_sixteen_offsets_from_0x7040():
    assert BASE == 0x7040
    assert {r.name: r.offset for r in SPI_MAP} == {name: offset for name, (offset, _, _) in MANUAL.items()}


@pytest.mark.rule("SPI-002", "SPI-003", "SPI-004")
@pytest.mark.parametrize("register", MANUAL)
def test_reset_value(register):
    new = SpiRig({}, {})
    used = in_the_middle_of_everything()
    used.chip.reset(used.now)
    used.chip.gate(used.now, True)
    assert (new.read(register), used.read(register)) == (MANUAL[register][1],) * 2


@pytest.mark.rule("SPI-005", "SPI-006")
@pytest.mark.parametrize("register", MANUAL)
def test_only_the_writable_bits_change(register):
    _, reset, owned = MANUAL[register]
    rig = SpiRig({}, {})
    rig.write(register, 0xFFFF & ~(0x4000 if register == "SPIFFTX" else 0))
    assert rig.peek(register) & owned == owned & ~(0x4000 if register == "SPIFFTX" else 0)
    rig.write(register, 0)
    assert rig.peek(register) & owned == 0
    assert rig.peek(register) & ~owned == reset & ~owned & ~0x2000
    names = 0
    for f in SPI_MAP[register].fields:
        names |= f.mask
    assert in_the_middle_of_everything().peek(register) & ~names == 0


@pytest.mark.rule("SPI-007")
def test_read_only_fields_ignore_writes():
    rig = in_the_middle_of_everything()
    names = ["TXFFST", "TXFFINT", "RXFFST", "RXFFINT", "RXFFOVF", "RXB", "ERXB", "INT_FLAG", "BUFFULL_FLAG"]
    before = rig.flags(*names)
    assert before == {**before, "TXFFST": 7, "RXFFST": 16, "RXFFOVF": 1, "RXFFINT": 1}
    for register, value in (("SPIFFTX", 0xFF03), ("SPIFFRX", 0x2022), ("SPIRXBUF", 0), ("SPIRXEMU", 0)):
        rig.write(register, value & ~0x0040)
        assert rig.flags(*names) == before
    rig = SpiRig()
    rig.write("SPISTS", 0x7F)
    assert rig.peek("SPISTS") == 0


@pytest.mark.rule("SPI-008")
def test_clear_bits_read_0():
    rig = SpiRig(fifo=True)
    rig.set(TXFFINTCLR=1, RXFFINTCLR=1, RXFFOVFCLR=1)
    assert rig.flags("TXFFINTCLR", "RXFFINTCLR", "RXFFOVFCLR") == {"TXFFINTCLR": 0, "RXFFINTCLR": 0, "RXFFOVFCLR": 0}


@pytest.mark.parametrize("offset", [-1, 16, 0x7040])
def test_an_offset_out_of_range_is_refused_by_all_accesses(offset):
    chip = Spi("SPI-A")
    chip.gate(0, True)
    accesses = [lambda: chip.read(1, offset), lambda: chip.peek(1, offset), lambda: chip.see(1, offset)]
    for access in [*accesses, lambda: chip.write(1, offset, 0)]:
        with pytest.raises(ValueError, match=f"SPI-A has offsets 0 to 0xF, not {offset:#x}"):
            access()


@pytest.mark.rule("SPI-009")
def test_without_a_clock_nothing_is_read_written_or_sent():
    rig = SpiRig()
    rig.chip.gate(rig.now, False)
    rig.write("SPITXBUF", 0x5500)
    assert [rig.read("SPICCR"), rig.chip.see(rig.now, SPI_MAP["SPICCR"].offset)] == [0, 0]
    assert rig.peek("SPICCR") == 0x87
    rig.wait(20)
    assert len(rig.edges) == 1
    assert rig.notes("duty") == [
        f"SPI-A: was {what} while its PCLKCR0 bit is 0; turn its clock on first" for what in ("written", "read")
    ]


def test_the_module_has_no_clock_after_a_reset():
    rig = SpiRig()
    rig.chip.reset(rig.now)
    assert rig.read("SPIFFTX") == 0


def test_new_words_in_spirxbuf_and_spitxbuf_are_reported_in_loaded():
    rig = SpiRig(SPILBK=1)
    rig.chip.loaded = 0
    rig.write("SPITXBUF", 0x5500)
    written = rig.chip.loaded
    rig.wait(9)
    assert (written, rig.chip.loaded) == (1 << 8, 1 << 8 | 1 << 7 | 1 << 6)


def test_a_read_of_the_fifo_reports_the_next_word_in_loaded():
    rig = SpiRig(fifo=True, SPILBK=1)
    shown = []
    for _ in range(2):
        rig.write("SPITXBUF", 0x5500)
        rig.chip.loaded = 0
        rig.wait(9)
        shown.append(rig.chip.loaded)
    for _ in range(2):
        rig.chip.loaded = 0
        rig.read("SPIRXBUF")
        shown.append(rig.chip.loaded)
    assert shown == [3 << 6, 0, 3 << 6, 0]


@pytest.mark.rule("SPI-086")
def test_a_change_of_the_configuration_while_spiswreset_is_1_is_noted():
    changes = {"SPICHAR": 3, "CLKPOLARITY": 1, "SPILBK": 1, "CLK_PHASE": 1, "MASTER_SLAVE": 0, "SPIBRR": 9}
    text = "SPI-A: its configuration was changed while SPISWRESET = 1; clear SPISWRESET first"
    for name, value in changes.items():
        rig = SpiRig()
        ModuleRig.drive(rig, rig.now, name, value)
        assert (name, rig.notes("duty")) == (name, [text])
        rig = SpiRig({}, {**MASTER, "SPISWRESET": 0})
        ModuleRig.drive(rig, rig.now, name, value)
        rig.set(SPISWRESET=1, TALK=0, SPIINTENA=1, OVERRUNINTENA=1)
        assert (name, rig.notes("duty")) == (name, [])


def test_the_write_that_sets_spiswreset_may_change_the_configuration():
    rig = SpiRig({}, {**SLAVE, "SPISWRESET": 0})
    rig.write("SPICCR", 0x00DF)
    assert rig.notes("duty") == []


def test_writing_the_same_configuration_is_not_noted():
    rig = SpiRig()
    for name in ("SPICCR", "SPICTL", "SPIBRR"):
        rig.write(name, rig.peek(name))
    rig.write("SPIBRR", 0xFF80 | rig.peek("SPIBRR"))  # bits that do not exist
    assert rig.notes("duty") == []


def test_a_new_module_drives_no_pin_and_has_no_clock():
    chip = Spi()
    assert (chip.driven, chip.read(0, SPI_MAP["SPIFFTX"].offset)) == (0, 0)


@pytest.mark.parametrize("access", ["read", "peek", "write"])
def test_changes_due_before_an_access_are_applied_first(access):
    rig = SpiRig(SPICHAR=0)
    rig.pin(rig.now, SOMI=0)
    rig.write("SPIDAT", 0x0001)
    later = rig.now + 20 * LSPCLK
    rig.levels = 0b1111
    if access == "write":
        rig.chip.write(later, SPI_MAP["SPICTL"].offset, 0x07)
        assert rig.chip.requests == 1  # INT_FLAG was 1 when SPIINTENA was set
    else:
        assert getattr(rig.chip, access)(later, SPI_MAP["SPIRXBUF"].offset) == 2
