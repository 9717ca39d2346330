"""SCIRXST and SCIRXBUF in standard mode: the causes that set and clear each flag."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame

ODD = {"PARITYENA": 1, "PARITY": 0}


def with_every_flag() -> SciRig:
    """Return a rig in which RXRDY, RXWAKE and all four error flags are 1."""
    rig = SciRig(**ODD).with_rxd(frame(0x12, parity="odd", bad="parity") + "1" * 13)
    rig.send(frame(0x13, parity="odd", bad="stop") + "0" * 22 + "1")
    return rig


ALL = ("RXRDY", "RXWAKE", "RXERROR", "BRKDT", "FE", "OE", "PE")


@pytest.mark.rule("SCI-040", "SCI-041")
def test_rxrdy_rises_within_the_stop_bit_and_falls_at_the_read():
    rig = SciRig().check("""
        > RXD      1  0  11010010  1  1  0  10100101  1  1
        > READ     .  .  ........  .  1  .  ........  .  .
        < RXRDY    0  .  ........  1  0  .  ........  1  .
    """)
    assert rig.read("SCIRXBUF") == 0xA5


@pytest.mark.rule("SCI-060")
@pytest.mark.parametrize(
    "reset",
    [
        pytest.param(
            SciRig.restart,
            marks=pytest.mark.rule("SCI-042", "SCI-049", "SCI-053", "SCI-057", "SCI-091", "SCI-104"),
            id="SW RESET",
        ),
        pytest.param(
            SciRig.reset,
            marks=pytest.mark.rule("SCI-043", "SCI-050", "SCI-054", "SCI-058", "SCI-092", "SCI-105"),
            id="XRS",
        ),
    ],
)
def test_a_reset_clears_every_receive_flag(reset):
    rig = with_every_flag()
    assert rig.flags(*ALL) == dict.fromkeys(ALL, 1)
    reset(rig)
    assert rig.flags(*ALL) == dict.fromkeys(ALL, 0)


@pytest.mark.rule("SCI-050", "SCI-054", "SCI-058", "SCI-060", "SCI-092")
def test_other_reads_and_writes_clear_no_error():
    rig = with_every_flag()
    errors = ("RXERROR", "BRKDT", "FE", "OE", "PE")
    for register in ("SCIRXBUF", "SCIRXEMU", "SCIRXST"):
        rig.read(register)
        rig.write(register, 0xFFFF)
        rig.write(register, 0x0000)
    rig.set(RXENA=0)
    rig.set(RXENA=1)
    rig.put(0x55, 30)
    assert rig.flags(*errors) == dict.fromkeys(errors, 1)


@pytest.mark.rule("SCI-044", "SCI-045")
def test_while_rxena_is_0_nothing_is_delivered_and_nothing_requested():
    rig = SciRig(RXBKINTENA=1, RXERRINTENA=1, **ODD).with_rxd(frame(0x11, parity="odd") + "1")
    assert rig.count("RXINT") == 1
    rig.set(RXENA=0)
    rig.send(frame(0x22, parity="odd") + "1" + frame(0x33, parity="odd", bad="parity") + "1")
    assert rig.count("RXINT") == 1
    assert rig.flags("OE", "PE", "RXDT") == {"OE": 0, "PE": 0, "RXDT": 0x11}


@pytest.mark.rule("SCI-044")
def test_while_rxena_is_0_the_fifo_stores_no_word():
    rig = SciRig(fifo=True, RXENA=0).with_rxd(frame(0x22) + "1")
    assert rig.get("RXFFST") == 0


@pytest.mark.rule("SCI-047", "SCI-048", "SCI-050")
def test_an_unread_character_is_overwritten_and_sets_oe():
    SciRig().check("""
        > RXD      1  0  11010010  1  1  0  10100101  1  1  0  00000000  1  1
        > READ     .  .  ........  .  .  .  ........  .  1  .  ........  .  1
        < RXRDY    0  .  ........  1  .  .  ........  .  0  .  ........  1  0
        < OE       0  .  ........  .  .  .  ........  1  .  .  ........  .  .
        < RXERROR  0  .  ........  .  .  .  ........  1  .  .  ........  .  .
    """)


@pytest.mark.rule("SCI-048")
def test_the_new_character_is_the_one_that_is_read():
    rig = SciRig().with_rxd(frame(0x4B) + frame(0xA5) + "1")
    assert rig.read("SCIRXBUF") == 0xA5


@pytest.mark.rule("SCI-047")
def test_a_character_read_in_time_is_not_overrun():
    rig = SciRig()
    for data in (0x4B, 0xA5, 0x11):
        rig.send(frame(data))
        assert rig.read("SCIRXBUF") == data
    assert rig.get("OE") == 0


@pytest.mark.rule("SCI-051", "SCI-054", "SCI-061", "SCI-059")
def test_a_missing_stop_bit_sets_fe_until_a_reset_and_the_character_is_delivered():
    rig = SciRig().check("""
        > RXD      1  0  11010010  0  1  0  11010010  1  1
        > READ     .  .  ........  .  1  .  ........  .  .
        < RXRDY    0  .  ........  1  0  .  ........  1  .
        < FE       0  .  ........  1  .  .  ........  .  .
        < RXERROR  0  .  ........  1  .  .  ........  .  .
    """)
    assert rig.read("SCIRXBUF") == 0x4B


@pytest.mark.rule("SCI-055", "SCI-058", "SCI-059", "SCI-061")
def test_a_wrong_parity_bit_sets_pe_until_a_reset_and_the_character_is_delivered():
    SciRig(**ODD).check("""
        > RXD      1  0  11010010 0  1  1  0  11010010 1  1  1
        > READ     .  .  ........ .  .  1  .  ........ .  .  .
        < RXRDY    0  .  ........ .  1  0  .  ........ .  1  .
        < PE       0  .  ........ .  1  .  .  ........ .  .  .
        < RXERROR  0  .  ........ .  1  .  .  ........ .  .  .
    """)


@pytest.mark.rule("SCI-052")
def test_a_zero_in_the_second_stop_bit_is_no_framing_error():
    rig = SciRig(fifo=True, STOPBITS=1)
    rig.send_samples("0" * 8 + "1" * 8 * 8 + "1" * 8 + "0001" + "1" * 100)
    assert rig.flags("FE", "RXFFST") == {"FE": 0, "RXFFST": 1}


@pytest.mark.rule("SCI-056")
def test_pe_reads_0_while_parity_is_off():
    rig = SciRig(**ODD).with_rxd(frame(0x11, parity="odd", bad="parity") + "1")
    assert rig.flags("PE", "RXERROR") == {"PE": 1, "RXERROR": 1}
    rig.set(PARITYENA=0)
    assert rig.flags("PE", "RXERROR") == {"PE": 0, "RXERROR": 0}


@pytest.mark.rule("SCI-056")
def test_without_parity_no_character_sets_pe():
    rig = SciRig()
    for data in range(0, 256, 17):
        rig.send_and_read(frame(data) + "1")
    assert rig.peek("SCIRXST") == 0


@pytest.mark.rule("SCI-059")
@pytest.mark.parametrize(
    ("text", "error"),
    [
        (frame(0x11, parity="odd", bad="parity") + "1", "PE"),
        (frame(0x11, parity="odd", bad="stop") + "1", "FE"),
        (frame(0x11, parity="odd") * 2 + "1", "OE"),
    ],
)
def test_each_error_alone_sets_rxerror(text, error):
    rig = SciRig(**ODD).with_rxd(text)
    wanted = dict.fromkeys(("BRKDT", "FE", "OE", "PE"), 0) | {error: 1, "RXERROR": 1}
    assert rig.flags(*wanted) == wanted


@pytest.mark.rule("SCI-062")
def test_all_flags_of_a_character_change_together():
    rig = SciRig(brr=1, **ODD).with_rxd(frame(0x22, parity="odd") + frame(0x11, parity="odd", bad="parity")[:-1])
    seen = [rig.peek("SCIRXST") & 0xFC]
    rig.drive(rig.now, "RXD", 0)  # the missing stop bit
    for _ in range(rig.bit):
        rig.wait(cycles=1)
        if rig.peek("SCIRXST") & 0xFC != seen[-1]:
            seen.append(rig.peek("SCIRXST") & 0xFC)
    # without RXWAKE: RXRDY of the first character; then RXERROR, RXRDY, FE, OE and PE in one step
    assert seen == [0b0100_0000, 0b1101_1100]
