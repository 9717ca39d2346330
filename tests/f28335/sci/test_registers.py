"""Registers of the SCI in CPU accesses: reset values, reserved and read-only bits, strobes, the clock gate."""

from __future__ import annotations

import pytest

from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.register_map import SCI_MAP
from tests.f28335.sci_rig import FIFO, SciRig, frame

# SPRUFZ5A figures 2-1 to 2-14, copied independently of the model: (offset, reset value).
MANUAL = {
    "SCICCR": (0x0, 0x00),
    "SCICTL1": (0x1, 0x00),
    "SCIHBAUD": (0x2, 0x00),
    "SCILBAUD": (0x3, 0x00),
    "SCICTL2": (0x4, 0xC0),
    "SCIRXST": (0x5, 0x00),
    "SCIRXEMU": (0x6, 0x00),
    "SCIRXBUF": (0x7, 0x0000),
    "SCITXBUF": (0x9, 0x00),
    "SCIFFTX": (0xA, 0xA000),
    "SCIFFRX": (0xB, 0x201F),
    "SCIFFCT": (0xC, 0x0000),
    "SCIPRI": (0xF, 0x00),
}
EIGHT_BITS = ["SCICCR", "SCICTL1", "SCIHBAUD", "SCILBAUD", "SCICTL2", "SCIRXST", "SCIRXEMU", "SCITXBUF", "SCIPRI"]


def in_the_middle_of_everything() -> SciRig:
    """Return a rig with words in both FIFOs, an overflow, errors, and a frame in progress in both directions."""
    rig = SciRig(fifo=True, RXFFIL=2, TXFFIL=3, FFTXDLY=7, PARITY=1, PARITYENA=1, SOFT=1, TXINTENA=1, RXERRINTENA=1)
    rig.write("SCITXBUF", *range(5))
    rig.send(frame(0x5A, parity="even", bad="parity") + frame(0x11, parity="even", bad="stop") + "11")
    for word in range(17):
        rig.send(frame(word, parity="even"))
    rig.send("0101")
    return rig


@pytest.mark.rule("SCI-002", "SCI-003", "SCI-004")
@pytest.mark.parametrize("register", MANUAL)
def test_reset_values_are_those_of_the_manual(register):
    offset, value = MANUAL[register]
    assert SCI_MAP[register].offset == offset
    fresh = SciRig(raw=True)
    assert fresh.read(register) == value
    used = in_the_middle_of_everything()
    used.reset()
    assert used.read(register) == value


@pytest.mark.rule("SCI-005")
@pytest.mark.parametrize("register", EIGHT_BITS)
def test_the_high_byte_of_an_eight_bit_register_reads_0(register):
    rig = SciRig(raw=True)
    rig.write(register, 0xFF00)
    assert rig.read(register) == {"SCICTL2": 0xC0}.get(register, 0)
    rig.write(register, 0xFFFF)
    assert rig.read(register) >> 8 == 0


@pytest.mark.rule("SCI-006")
@pytest.mark.parametrize(
    ("register", "reserved"),
    [
        ("SCICTL1", 0b1001_0000),
        ("SCICTL2", 0b0011_1100),
        ("SCIRXST", 0b0000_0001),
        ("SCIRXBUF", 0x3F00),
        ("SCIFFCT", 0x1F00),
        ("SCIPRI", 0b1110_0111),
    ],
)
def test_reserved_bits_read_zero_and_ignore_writes(register, reserved):
    rig = SciRig(raw=True)
    rig.write(register, 0xFFFF)
    assert rig.read(register) & reserved == 0
    assert in_the_middle_of_everything().read(register) & reserved == 0


@pytest.mark.rule("SCI-005", "SCI-006")
@pytest.mark.parametrize(
    ("register", "kept"),
    [("SCICCR", 0xFF), ("SCIHBAUD", 0xFF), ("SCILBAUD", 0xFF), ("SCITXBUF", 0xFF), ("SCIPRI", 0x18)],
)
def test_writable_bits_read_back(register, kept):
    rig = SciRig(raw=True)
    rig.write(register, 0xFFFF)
    assert rig.read(register) == kept


@pytest.mark.rule("SCI-007")
@pytest.mark.parametrize("register", ["SCIRXST", "SCIRXEMU", "SCIRXBUF"])
def test_the_registers_of_the_receiver_ignore_writes(register):
    rig = SciRig().with_rxd(frame(0x96) + frame(0x3C) + frame(0xA5, bad="stop") + "111")
    before = rig.peek(register)
    assert before != 0
    for value in (0x0000, 0xFFFF):
        rig.write(register, value)
        assert rig.peek(register) == before


@pytest.mark.rule("SCI-007")
def test_transmit_flags_ignore_writes():
    rig = SciRig()
    rig.write("SCICTL2", 0x00)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 1, "TXEMPTY": 1}
    rig.write("SCITXBUF", 0x55)
    rig.put(0x55, 2)
    rig.write("SCITXBUF", 0x55)
    rig.write("SCICTL2", 0xC0)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 0, "TXEMPTY": 0}


@pytest.mark.rule("SCI-007")
def test_fifo_counts_and_flags_ignore_writes():
    rig = SciRig(fifo=True, TXENA=0, RXFFIL=1)
    rig.write("SCITXBUF", 0x11)
    rig.set(TXFFINTCLR=1)
    rig.send(frame(0x22) + "11")
    assert rig.flags("TXFFST", "TXFFINT", "RXFFST", "RXFFINT", "RXFFOVF", "ABD") == {
        "TXFFST": 1,
        "TXFFINT": 0,
        "RXFFST": 1,
        "RXFFINT": 1,
        "RXFFOVF": 0,
        "ABD": 0,
    }
    rig.set(TXFFST=9, TXFFINT=1, RXFFST=9, RXFFINT=0, RXFFOVF=1, ABD=1)
    assert rig.flags("TXFFST", "TXFFINT", "RXFFST", "RXFFINT", "RXFFOVF", "ABD") == {
        "TXFFST": 1,
        "TXFFINT": 0,
        "RXFFST": 1,
        "RXFFINT": 1,
        "RXFFOVF": 0,
        "ABD": 0,
    }


@pytest.mark.rule("SCI-007")
def test_writing_0_does_not_clear_a_flag():
    rig = SciRig(fifo=True, RXFFIL=1)
    for word in range(17):
        rig.send(frame(word))
    rig.wait(1)
    rig.set(TXFFINT=0, RXFFOVF=0, RXFFINT=0)
    assert rig.flags("TXFFINT", "RXFFOVF", "RXFFINT") == {"TXFFINT": 1, "RXFFOVF": 1, "RXFFINT": 1}


@pytest.mark.rule("SCI-008")
@pytest.mark.parametrize("strobe", ["TXFFINTCLR", "RXFFOVRCLR", "RXFFINTCLR", "ABDCLR"])
def test_strobes_read_zero(strobe):
    rig = SciRig(fifo=True)
    rig.set(**{strobe: 1})
    assert rig.get(strobe) == 0
    register = {"T": "SCIFFTX", "R": "SCIFFRX", "A": "SCIFFCT"}[strobe[0]]
    assert SCI_MAP[register][strobe].extract(rig.read(register)) == 0


@pytest.mark.rule("SCI-008")
def test_a_strobe_written_zero_clears_nothing():
    rig = SciRig(brr=1, fifo=True, RXFFIL=1, CDC=1)
    rig.send(frame(ord("A")), bit=1312)
    for word in range(17):
        rig.send(frame(word), bit=1312)
    rig.wait(2)
    flags = {"ABD": 1, "TXFFINT": 1, "RXFFOVF": 1, "RXFFINT": 1}
    assert rig.flags(*flags) == flags
    rig.set(TXFFINTCLR=0, RXFFOVRCLR=0, RXFFINTCLR=0, ABDCLR=0)
    assert rig.flags(*flags) == flags


@pytest.mark.rule("SCI-009")
def test_the_transmitter_stops_without_its_clock():
    SciRig().check("""
        > GATE      .  .  .  .  0 . . . . . . . . .  1  .  .  .  .  .  .  .
        > SCITXBUF  5  .  .  .  . . . . . . . . . .  .  .  .  .  .  .  .  .
        < TXD       0  1  0  1  . . . . . . . . . .  0  .  .  .  .  1  .  .
        < TXEMPTY   0  .  .  .  . . . . . . . . . .  .  .  .  .  .  .  1  .
    """)


@pytest.mark.rule("SCI-009")
def test_the_receiver_receives_nothing_without_its_clock():
    rig = SciRig(fifo=True)
    rig.chip.gate(rig.now, False)
    rig.send(frame(0x5A) + "1" * 20)
    assert rig.get("RXFFST") == 0
    rig.chip.gate(rig.now, True)
    rig.send("1" * 20)
    assert rig.get("RXFFST") == 0


@pytest.mark.rule("SCI-009")
def test_after_reset_the_module_has_no_clock():
    chip = Sci()
    ccr, ctl1, lbaud, txbuf = (SCI_MAP[n].offset for n in ("SCICCR", "SCICTL1", "SCILBAUD", "SCITXBUF"))
    for offset, value in ((ccr, 7), (lbaud, 24), (ctl1, 0x23), (txbuf, 0x00)):
        chip.write(0, offset, value)
    assert chip.next_wake > 10**9 and chip.out == 1
    chip.peek(10**6, txbuf)
    assert chip.out == 1


@pytest.mark.rule("SCI-010")
def test_scirxemu_has_the_value_of_scirxbuf():
    rig = SciRig()
    for data in (0x5A, 0xC3):
        rig.send(frame(data) + "1")
        assert (rig.read("SCIRXEMU"), rig.read("SCIRXBUF")) == (data, data)


@pytest.mark.rule("SCI-011", "SCI-212")
def test_reading_scirxemu_leaves_rxrdy_and_rxwake():
    rig = SciRig(ADDRIDLE_MODE=1).with_rxd(frame(0x5A, address=1) + "1")
    assert rig.read("SCIRXEMU") == 0x5A
    assert rig.flags("RXRDY", "RXWAKE") == {"RXRDY": 1, "RXWAKE": 1}
    assert rig.read("SCIRXBUF") == 0x5A
    assert rig.flags("RXRDY", "RXWAKE") == {"RXRDY": 0, "RXWAKE": 0}


@pytest.mark.rule("SCI-012")
def test_system_reset_clears_the_receive_buffer():
    rig = SciRig().with_rxd(frame(0x5A) + "1")
    assert rig.peek("SCIRXBUF") == 0x5A
    rig.reset()
    assert (rig.read("SCIRXBUF"), rig.read("SCIRXEMU")) == (0, 0)


@pytest.mark.rule("SCI-013")
def test_the_module_stays_in_reset_until_software_writes_one():
    rig = SciRig(raw=True)
    assert rig.get("SWRESET") == 0
    rig.set_brr(24)
    rig.set(SCICHAR=7)
    rig.set(RXENA=1, TXENA=1)
    rig.write("SCITXBUF", 0x55)
    rig.send(frame(0x5A) + "1111")
    assert rig.edges == []
    assert (rig.peek("SCIRXST"), rig.peek("SCICTL2")) == (0x00, 0xC0)
    rig.set(SWRESET=1)
    rig.send(frame(0x5A) + "1")
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0x5A}


@pytest.mark.rule("SCI-014")
def test_the_fifos_have_no_effect_until_they_are_enabled():
    rig = SciRig(raw=True, fifo=False)
    rig.wait(20)
    assert rig.flags("TXFFINT", "TXFFST", "TXFFIL") == {"TXFFINT": 0, "TXFFST": 0, "TXFFIL": 0}
    rig = SciRig(RXFFIL=0, TXFFIENA=1, RXFFIENA=1)
    rig.write("SCITXBUF", 0x11)
    rig.send(frame(0x22) + frame(0x33) + "1")
    assert rig.flags("TXFFINT", "TXFFST", "RXFFINT", "RXFFST") == {"TXFFINT": 0, "TXFFST": 0, "RXFFINT": 0, "RXFFST": 0}
    assert (rig.count("TXINT"), rig.count("RXINT")) == (0, 0)
    rig.set(**FIFO)
    assert rig.get("TXFFINT") == 1
