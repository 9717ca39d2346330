"""The break of the SCI: a line that stays low for ten bits after a missing stop bit."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame


def broken() -> SciRig:
    """Return the rig of a module in FIFO mode after a break. The words received so far have been read."""
    rig = SciRig(fifo=True).with_rxd("0" * 25 + "1" * 3)
    rig.received()
    return rig


@pytest.mark.rule("SCI-086", "SCI-096", "SCI-059")
def test_a_break_sets_fe_first_and_brkdt_ten_bits_later():
    SciRig().check("""
        > RXD      1  0  ........  .  ........  .  .  .  1  .
        < FE       0  .  ........  1  ........  .  .  .  .  .
        < RXERROR  0  .  ........  1  ........  .  .  .  .  .
        < BRKDT    0  .  ........  .  ........  .  1  .  .  .
    """)


@pytest.mark.rule("SCI-087")
@pytest.mark.parametrize("bits", [10, 12, 15, 18, 19])
def test_a_shorter_low_sets_no_brkdt(bits):
    rig = SciRig().with_rxd("0" * bits + "1" * 4)
    assert rig.flags("FE", "BRKDT") == {"FE": 1, "BRKDT": 0}


@pytest.mark.parametrize(("low", "noted"), [(10, 0), (11, 0), (12, 1), (13, 1), (19, 1), (21, 0)])
def test_a_break_too_short_for_brkdt_is_noted_once_but_a_zero_of_a_slow_sender_is_not(low, noted):
    rig = SciRig().with_rxd("0" * low + "1" * 4 + frame(0x5A) + "1" * 12)
    assert [text for text in rig.notes("lost") if "rose before BRKDT" in text] == rig.notes("lost")
    assert (len(rig.notes("lost")), rig.get("BRKDT")) == (noted, low > 20)


def test_no_short_break_is_noted_of_a_disabled_receiver_or_after_another_character():
    rig = SciRig(RXENA=0).with_rxd("0" * 13 + "1" * 20)
    assert rig.notes("lost") == []
    rig = SciRig().with_rxd("01" + "0" * 14 + "1" * 20)
    assert (rig.notes("lost"), rig.get("FE")) == ([], 1)


@pytest.mark.rule("SCI-086")
@pytest.mark.parametrize(("fields", "frame_bits"), [({"SCICHAR": 4}, 7), ({"PARITYENA": 1, "PARITY": 1}, 11)])
def test_the_ten_bits_begin_at_the_missing_stop_bit_of_any_format(fields, frame_bits):
    for low, brkdt in ((frame_bits + 9, 0), (frame_bits + 11, 1)):
        rig = SciRig(**fields).with_rxd("0" * low + "1" * 4)
        assert (low, rig.get("BRKDT")) == (low, brkdt)


@pytest.mark.rule("SCI-088")
def test_one_high_sample_restarts_the_ten_bits():
    rig = SciRig()
    rig.send_samples("0" * 8 * 17 + "1" + "0" * 8 * 9 + "1" * 8)
    assert rig.flags("FE", "BRKDT") == {"FE": 1, "BRKDT": 0}
    rig = SciRig()
    rig.send_samples("0" * 8 * 17 + "0" + "0" * 8 * 9 + "1" * 8)
    assert rig.flags("FE", "BRKDT") == {"FE": 1, "BRKDT": 1}


@pytest.mark.rule("SCI-088")
def test_a_register_write_after_a_short_low_does_not_make_it_a_break():
    rig = SciRig().with_rxd("0" * 12 + "11")
    rig.write("SCICCR", rig.peek("SCICCR"))
    rig.wait(12)
    assert rig.flags("FE", "BRKDT") == {"FE": 1, "BRKDT": 0}


@pytest.mark.rule("SCI-089")
@pytest.mark.parametrize("bits", [25, 60, 200])
def test_a_break_of_any_length_loads_only_the_character_with_fe(bits):
    rig = SciRig(fifo=True).with_rxd("0" * bits + "1" * 30)
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 1, "BRKDT": 1}
    assert rig.read("SCIRXBUF") & 0x80FF == 0x8000


@pytest.mark.rule("SCI-089")
def test_brkdt_does_not_set_rxrdy():
    rig = SciRig()
    rig.send_and_read("0" * 12)
    rig.send("0" * 13 + "1" * 20)
    assert rig.flags("BRKDT", "RXRDY", "OE") == {"BRKDT": 1, "RXRDY": 0, "OE": 0}


@pytest.mark.rule("SCI-090", "SCI-092", "SCI-093")
def test_after_a_break_nothing_is_received_and_brkdt_remains_1():
    rig = broken()
    rig.send(frame(0x4B) + frame(0xA5) + "1" * 12 + frame(0x11))
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 0, "BRKDT": 1}


@pytest.mark.rule("SCI-090", "SCI-092")
def test_reads_and_writes_do_not_clear_brkdt():
    rig = SciRig().with_rxd("0" * 25 + "1")
    for register in ("SCIRXBUF", "SCIRXST", "SCIRXEMU"):
        rig.read(register)
        rig.write(register, 0xFF)
    assert rig.get("BRKDT") == 1


@pytest.mark.rule("SCI-090")
def test_later_characters_do_not_clear_brkdt_even_if_they_are_received():
    rig = SciRig({"rx_after_break": "next_high"})
    rig.send_and_read("0" * 25 + "1" * 3)
    rig.send(frame(0x4B) + "1")
    assert rig.flags("RXRDY", "RXDT", "BRKDT") == {"RXRDY": 1, "RXDT": 0x4B, "BRKDT": 1}


@pytest.mark.rule("SCI-091", "SCI-208")
def test_sw_reset_toggled_after_a_break_enables_reception_again():
    rig = broken()
    rig.set(SWRESET=0)
    assert rig.flags("BRKDT", "RXERROR", "FE") == {"BRKDT": 0, "RXERROR": 0, "FE": 0}
    rig.set(SWRESET=1)
    rig.send(frame(0x4B) + "1")
    assert rig.received() == [0x4B]


@pytest.mark.rule("SCI-093")
@pytest.mark.parametrize("field", ["SCIRST", "CDC"])
def test_after_a_break_neither_scirst_nor_cdc_enables_reception_again(field: str):
    rig = broken()
    usual = rig.get(field)
    rig.set(**{field: 1 - usual})
    rig.set(**{field: usual})
    rig.send(frame(0x55) + "1")
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 0, "BRKDT": 1}


@pytest.mark.rule("SCI-093")
def test_after_a_break_autobaud_measures_the_rate_but_receives_nothing():
    rig = broken()
    rig.set(CDC=1)
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert (rig.get("ABD"), rig.get("SCILBAUD")) == (1, 40)
    rig.send(frame(0x55) + "1", bit=1312)
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 0, "BRKDT": 1}
    rig.restart()
    rig.send(frame(0x55) + "1", bit=1312)
    assert rig.received() == [0x55]


@pytest.mark.rule("SCI-092", "SCI-093")
def test_system_reset_ends_a_break_too():
    rig = SciRig().with_rxd("0" * 25 + "1" * 3)
    rig.reset()
    assert rig.get("BRKDT") == 0
    rig.write("SCILBAUD", 24)
    rig.set(SCICHAR=7)
    rig.set(RXENA=1, SWRESET=1)
    rig.wait(3)
    rig.send(frame(0x4B) + "1")
    rig.wait(1)
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0x4B}


@pytest.mark.rule("SCI-094", "SCI-139")
@pytest.mark.parametrize(("enabled", "requests"), [(1, 2), (0, 0)])
def test_brkdt_requests_rxint_by_rx_bk_int_ena(enabled, requests):
    rig = SciRig(RXBKINTENA=enabled).check(f"""
        > RXD    1  0  ........  .  ........  .  .  .  1
        < BRKDT  0  .  ........  .  ........  .  1  .  .
        < RXINT  0  .  ........  {"1" if enabled else "."}  ........  .  {"2" if enabled else "."}  .  .
    """)
    assert rig.count("RXINT") == requests


@pytest.mark.rule("SCI-095")
def test_a_break_is_detected_and_interrupts_in_sleep():
    rig = SciRig(RXBKINTENA=1)
    rig.send_and_read(frame(0x11) * 2 + "1")
    rig.set(SLEEP=1)
    before = rig.count("RXINT")
    rig.send("0" * 25 + "1")
    assert rig.flags("BRKDT", "FE", "RXRDY") == {"BRKDT": 1, "FE": 0, "RXRDY": 0}
    assert rig.count("RXINT") == before + 1


@pytest.mark.rule("SCI-095")
def test_a_break_is_detected_in_sleep_in_address_bit_mode():
    rig = SciRig(RXBKINTENA=1, ADDRIDLE_MODE=1, SLEEP=1).with_rxd("0" * 25 + "1")
    assert rig.flags("BRKDT", "RXRDY") == {"BRKDT": 1, "RXRDY": 0}
    assert rig.count("RXINT") == 1


@pytest.mark.parametrize(
    ("parity", "parity_bit", "all_zero"),
    [("none", "", True), ("even", "0", True), ("even", "1", False), ("odd", "0", True), ("odd", "1", False)],
)
@pytest.mark.parametrize("data", [0x00, 0x10])
def test_a_frame_is_like_a_break_if_all_its_bits_are_0(parity: str, parity_bit: str, all_zero: bool, data: int):
    """With `break_char_delivered` = no, only such a frame delivers no character; its error flags are set anyway."""
    fields = {"PARITYENA": int(parity != "none"), "PARITY": int(parity == "even")}
    rig = SciRig({"break_char_delivered": False}, **fields).with_rxd(
        "0" + f"{data:08b}"[::-1] + parity_bit + "0" + "1" * 4
    )
    wrong = parity != "none" and (data.bit_count() + int(parity_bit) + (parity == "odd")) % 2
    assert rig.flags("FE", "PE") == {"FE": 1, "PE": int(wrong)}
    assert rig.get("RXRDY") == (not all_zero or data != 0)
    assert ("break_char_delivered" in rig.chip.touched) == (all_zero and not data)
