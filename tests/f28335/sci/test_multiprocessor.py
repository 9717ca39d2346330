"""Several processors on one line: idle-line mode, address-bit mode with the erratum, and SLEEP."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame, levels

ADDRESS = {"ADDRIDLE_MODE": 1}
QUIET = "1" * 12  # more than the ten idle bits that begin a block


# Idle-line mode, receiving.


@pytest.mark.rule("SCI-097")
def test_idle_line_mode_has_no_address_bit():
    rig = SciRig(fifo=True, ADDRIDLE_MODE=0).with_rxd(frame(0x4B) + frame(0xA5) + "1")
    assert rig.received() == [0x4B, 0xA5]
    assert rig.transmit(0x4B, 11) == levels("0 11010010 1 1")


@pytest.mark.rule("SCI-098", "SCI-099", "SCI-130")
@pytest.mark.parametrize(("idle", "address_frame"), [(0, 0), (1, 0), (5, 0), (9, 0), (10, 1), (11, 1), (40, 1)])
def test_ten_idle_bits_make_the_next_frame_an_address_frame(idle, address_frame):
    rig = SciRig()
    rig.send_and_read(frame(0x11))
    rig.set(SLEEP=1)
    rig.send("1" * idle + frame(0x22))
    assert rig.flags("RXRDY") == {"RXRDY": address_frame}


@pytest.mark.rule("SCI-100")
def test_rxwake_is_set_when_the_line_has_been_idle_for_ten_bits():
    rig = SciRig()
    rig.send_and_read(frame(0x11))
    rig.send("1" * 9)
    assert rig.get("RXWAKE") == 0
    rig.send("11")
    assert rig.get("RXWAKE") == 1


@pytest.mark.rule("SCI-100", "SCI-103")
def test_every_idle_line_sets_rxwake_again():
    rig = SciRig()
    for data in range(3):
        rig.send(frame(data) + QUIET)
        assert (data, rig.get("RXWAKE")) == (data, 1)
        rig.read("SCIRXBUF")
        rig.send(QUIET)
        assert (data, rig.get("RXWAKE")) == (data, 0)
    rig.send(frame(0x11))
    assert rig.get("RXWAKE") == 1
    rig.read("SCIRXBUF")
    rig.send(QUIET)
    assert rig.get("RXWAKE") == 1


@pytest.mark.rule("SCI-099", "SCI-100")
def test_rxwake_is_not_set_while_frames_keep_coming():
    rig = SciRig()
    for data in range(8):
        rig.send_and_read(frame(data) + "1" * 9)
        assert rig.get("RXWAKE") == 0


@pytest.mark.rule("SCI-101", "SCI-102")
@pytest.mark.parametrize("fifo", [False, True])
def test_the_first_byte_after_the_address_clears_rxwake_in_standard_mode_only(fifo):
    rig = SciRig(fifo=fifo)
    rig.send_and_read(frame(0x11))
    rig.send(QUIET + frame(0x22))
    assert rig.get("RXWAKE") == 1
    rig.send(frame(0x33))
    assert rig.get("RXWAKE") == int(fifo)


@pytest.mark.rule("SCI-103")
@pytest.mark.parametrize("fifo", [False, True])
def test_reading_scirxbuf_clears_rxwake(fifo):
    rig = SciRig(fifo=fifo)
    rig.send_and_read(frame(0x11))
    rig.send(QUIET + frame(0x22))
    assert rig.get("RXWAKE") == 1
    rig.read("SCIRXEMU")
    assert rig.get("RXWAKE") == 1
    rig.read("SCIRXBUF")
    assert rig.get("RXWAKE") == 0


@pytest.mark.parametrize(
    "reset",
    [
        pytest.param(lambda rig: rig.set(SWRESET=0), marks=pytest.mark.rule("SCI-104"), id="SW RESET"),
        pytest.param(SciRig.reset, marks=pytest.mark.rule("SCI-105"), id="XRS"),
    ],
)
def test_a_reset_clears_rxwake(reset):
    rig = SciRig().with_rxd(frame(0x11) + QUIET)
    assert rig.get("RXWAKE") == 1
    reset(rig)
    assert rig.get("RXWAKE") == 0


# Idle-line mode, sending.


@pytest.mark.rule("SCI-106", "SCI-107", "SCI-110")
@pytest.mark.parametrize("fields", [{}, {"STOPBITS": 1}, {"SCICHAR": 4}])
def test_txwake_and_a_dummy_make_an_idle_time_of_eleven_bits(fields):
    rig = SciRig(**fields)
    length = 2 + rig.get("SCICHAR") + 1 + rig.get("STOPBITS")
    rig.put(0x15, 2)
    rig.set(TXWAKE=1)
    rig.put(0x0E, length)
    assert rig.flags("TXRDY", "TXWAKE") == {"TXRDY": 1, "TXWAKE": 0}
    rig.put(0x12, 40)
    (first, drawn), (second, drawn_too) = rig.frames(length)
    assert second - (first + length * rig.bit) == 11 * rig.bit
    bits = rig.get("SCICHAR") + 1
    assert (drawn, drawn_too) == tuple(frame(data, bits, stops=rig.get("STOPBITS") + 1) for data in (0x15, 0x12))


@pytest.mark.rule("SCI-106", "SCI-107", "SCI-114")
def test_the_idle_time_of_an_idle_line():
    # the dummy written in column 0 takes columns 0 to 10; the start bit of 0x05 is in column 11
    SciRig().check("""
        > TXWAKE    1  .  ..........  .  ........  .  .
        > SCITXBUF  e  5  ..........  .  ........  .  .
        < TXD       1  .  .........0  1  010....1  .  .
        < TXWAKE    0  .  ..........  .  ........  .  .
    """)


@pytest.mark.rule("SCI-109", "SCI-110", "SCI-118")
def test_txwake_moves_to_wut_when_txshf_is_loaded_and_not_before():
    rig = SciRig().put(0x15, 2)
    rig.set(TXWAKE=1)
    rig.put(0x0E, 7)
    assert rig.flags("TXRDY", "TXWAKE") == {"TXRDY": 0, "TXWAKE": 1}
    rig.wait(2)
    assert rig.flags("TXRDY", "TXWAKE") == {"TXRDY": 1, "TXWAKE": 0}


@pytest.mark.rule("SCI-114")
def test_a_second_dummy_may_be_written_at_once():
    rig = SciRig().put(0x15, 2)
    for _ in range(2):
        rig.set(TXWAKE=1)
        rig.put(0x0E, 10)
    rig.put(0x12, 40)
    first, second = (start for start, _ in rig.frames(10))
    assert second - first == (10 + 2 * 11) * rig.bit
    assert rig.characters() == [0x15, 0x12]


@pytest.mark.rule("SCI-108", "SCI-130")
@pytest.mark.parametrize(("pause", "block"), [(11, 1), (7, 0)])
def test_a_pause_of_ten_bits_by_software_begins_a_block(pause, block):
    rig = SciRig(LOOPBKENA=1).put(0x15, 10)
    rig.wait(sciclk=1)
    rig.read("SCIRXBUF")
    rig.set(SLEEP=1)
    rig.wait(pause)
    rig.put(0x12, 12)
    assert rig.get("RXRDY") == block


@pytest.mark.rule("SCI-098", "SCI-106")
def test_the_idle_time_of_txwake_is_a_block_to_a_receiver():
    rig = SciRig(LOOPBKENA=1).put(0x15, 2)
    rig.set(TXWAKE=1)
    rig.put(0x0E, 9)
    rig.read("SCIRXBUF")
    rig.set(SLEEP=1)
    rig.put(0x12, 23)
    assert rig.flags("RXRDY", "RXWAKE", "RXDT") == {"RXRDY": 1, "RXWAKE": 1, "RXDT": 0x12}


@pytest.mark.rule("SCI-111")
def test_system_reset_clears_txwake():
    rig = SciRig(TXENA=0, TXWAKE=1)
    assert rig.get("TXWAKE") == 1
    rig.reset()
    assert rig.get("TXWAKE") == 0


@pytest.mark.rule("SCI-112")
def test_sw_reset_does_not_clear_txwake():
    rig = SciRig(TXENA=0, TXWAKE=1)
    rig.set(SWRESET=0)
    assert rig.get("TXWAKE") == 1
    rig.set(SWRESET=1)
    assert rig.get("TXWAKE") == 1


@pytest.mark.rule("SCI-113")
def test_txwake_is_only_set_by_software():
    rig = SciRig(TXENA=0)
    rig.set(TXWAKE=1)
    rig.set(TXWAKE=0)
    assert rig.get("TXWAKE") == 1


# Address-bit mode.


@pytest.mark.rule("SCI-115", "SCI-116", "SCI-117", "SCI-118")
def test_only_the_frame_loaded_with_txwake_carries_a_1():
    SciRig(**ADDRESS).check("""
        > TXWAKE    .  1  ........  .  .  .  ........  .  .  .
        > SCITXBUF  .  5  .3......  .  .  .  ........  .  .  .
        < TXD       1  0  1010....  1  .  0  1.0.....  .  1  .
        < TXWAKE    0  .  ........  .  .  .  ........  .  .  .
    """)


@pytest.mark.rule("SCI-109", "SCI-116")
def test_txwake_set_while_a_frame_is_sent_counts_for_the_next():
    rig = SciRig(**ADDRESS).put(0x11, 2)
    rig.set(TXWAKE=1)
    rig.put(0x22, 11)
    rig.put(0x33, 30)
    assert [text[9] for _, text in rig.frames(11)] == ["0", "1", "0"]


@pytest.mark.rule("SCI-115", "SCI-119")
@pytest.mark.parametrize("bit", [0, 1])
def test_rxwake_is_the_address_bit_of_the_character_in_the_buffer(bit):
    rig = SciRig(**ADDRESS).with_rxd(frame(0x11, address=1 - bit) + frame(0x22, address=bit) + "1")
    assert rig.flags("RXWAKE", "RXDT") == {"RXWAKE": bit, "RXDT": 0x22}


@pytest.mark.rule("SCI-120")
@pytest.mark.parametrize("idle", [1, 9, 11, 50])
def test_in_address_bit_mode_idle_time_has_no_meaning(idle):
    rig = SciRig(**ADDRESS)
    rig.send_and_read(frame(0x11, address=0))
    rig.set(SLEEP=1)
    rig.send("1" * idle)
    assert rig.get("RXWAKE") == 0
    rig.send(frame(0x22, address=0))
    assert rig.flags("RXRDY", "RXWAKE") == {"RXRDY": 0, "RXWAKE": 0}
    rig.send(frame(0x33, address=1))
    assert rig.flags("RXRDY", "RXWAKE") == {"RXRDY": 1, "RXWAKE": 1}


# The erratum: the search for the next start bit begins in the address bit.


def samples(text: str) -> str:
    return "".join(mark * 8 for mark in levels(text))


START_AND_0X4B = samples("0 11010010")


@pytest.mark.rule("SCI-121", "SCI-122", "SCI-123")
@pytest.mark.parametrize(
    ("address_bit", "stop_bit", "false_start"),
    [
        ("00000000", "11111111", 0),  # the stop bit is in time: samples 6, 7 and 8 are low, and 1 is high
        ("00000000", "01111111", 1),  # samples 6, 7, 8 and 1 are low
        ("00001000", "01111111", 1),  # sample 5 has no influence
        ("00000100", "01111111", 0),  # the search begins at sample 6: only three low samples
        ("00000001", "01111111", 0),
        ("11111111", "11111111", 0),
        ("11111111", "01111111", 0),  # address bit 1: a late stop bit has no effect
    ],
)
def test_a_false_start_bit_needs_samples_6_7_8_and_1_low(address_bit, stop_bit, false_start):
    rig = SciRig(fifo=True, **ADDRESS)
    rig.send_samples(START_AND_0X4B + address_bit + stop_bit + "1" * 8 * 14)
    assert rig.received() == [0x4B, *[0xFF] * false_start]


@pytest.mark.rule("SCI-121", "SCI-122")
def test_a_sender_that_is_one_and_a_half_percent_slow_causes_a_false_start_bit():
    rig = SciRig(fifo=True, **ADDRESS)
    rig.send(frame(0x4B, address=0) + "1" * 14, bit=rig.bit * 1.015)
    assert rig.received() == [0x4B, 0xFF]
    rig.send(frame(0x4B, address=1) + "1" * 14, bit=rig.bit * 1.015)
    assert rig.received() == [0x4B]


@pytest.mark.rule("SCI-124")
@pytest.mark.parametrize("phase", range(0, 100, 10))
def test_a_receiver_that_is_slower_than_the_sender_detects_no_false_start_bit(phase):
    rig = SciRig(fifo=True, **ADDRESS)
    sent = [0x4B, 0x00, 0xFF, 0x80]
    for data in sent:
        rig.send(frame(data, address=0), bit=rig.bit * 0.985, at=rig.now + phase)
    assert rig.received(wait=20) == sent


@pytest.mark.rule("SCI-125")
@pytest.mark.parametrize("phase", range(0, 100, 10))
def test_idle_line_mode_does_not_have_the_erratum(phase):
    rig = SciRig(fifo=True)
    sent = [0x4B, 0x00, 0x7F, 0x01]
    for data in sent:
        rig.send(frame(data), bit=rig.bit * 1.03, at=rig.now + phase)
    assert rig.received(wait=20) == sent
    assert rig.get("RXERROR") == 0


@pytest.mark.rule("SCI-125")
def test_idle_line_mode_tolerates_a_late_stop_bit():
    rig = SciRig(fifo=True)
    rig.send_samples(samples("0 1101001") + "00000000" + "01111111" + "1" * 8 * 14)
    assert rig.received() == [0x4B]


# SLEEP.


def asleep(**fields: int) -> SciRig:
    """Return a rig whose module has received a frame, which was read, and then went to sleep."""
    rig = SciRig(RXBKINTENA=1, RXERRINTENA=1, **fields)
    rig.send_and_read(frame(0x11, address=1 if fields.get("ADDRIDLE_MODE") else None))
    rig.set(SLEEP=1)
    return rig


@pytest.mark.rule("SCI-126", "SCI-127", "SCI-128", "SCI-129")
@pytest.mark.parametrize("fields", [{}, ADDRESS])
def test_in_sleep_other_frames_have_no_effect(fields):
    rig = asleep(**fields)
    before = rig.count("RXINT")
    address = 0 if fields else None
    rig.send(frame(0x22, address=address) + "1" + frame(0x33, address=address))
    if not fields:  # in address-bit mode, a missing stop bit would cause a false start bit (the erratum)
        rig.send(frame(0x44, bad="stop") + "1" + frame(0x55) + "1")
    assert rig.flags("RXRDY", "FE", "OE", "PE", "RXERROR") == dict.fromkeys(("RXRDY", "FE", "OE", "PE", "RXERROR"), 0)
    assert rig.count("RXINT") == before
    assert rig.peek("SCIRXBUF") == 0x11


@pytest.mark.rule("SCI-127")
def test_in_sleep_a_wrong_parity_bit_is_not_reported():
    rig = SciRig(PARITYENA=1, PARITY=1)
    rig.send_and_read(frame(0x11, parity="even"))
    rig.set(SLEEP=1)
    rig.send(frame(0x22, parity="even", bad="parity") + "1")
    assert rig.flags("PE", "RXRDY") == {"PE": 0, "RXRDY": 0}
    rig.set(SLEEP=0)
    rig.send(frame(0x22, parity="even", bad="parity") + "1")
    assert rig.flags("PE", "RXRDY") == {"PE": 1, "RXRDY": 1}


@pytest.mark.rule("SCI-129", "SCI-128")
def test_in_sleep_the_fifo_stores_no_word():
    rig = SciRig(fifo=True, RXFFIL=1, RXFFIENA=1, **ADDRESS, SLEEP=1).with_rxd(frame(0x22, address=0) * 3 + "1")
    assert rig.flags("RXFFST", "RXFFINT") == {"RXFFST": 0, "RXFFINT": 0}
    rig.send(frame(0x33, address=1) + "1")
    assert rig.flags("RXFFST", "RXFFINT") == {"RXFFST": 1, "RXFFINT": 1}
    assert rig.count("RXINT") == 1


@pytest.mark.rule("SCI-130")
def test_in_sleep_the_first_frame_after_ten_idle_bits_is_received():
    rig = asleep()
    before = rig.count("RXINT")
    rig.send(frame(0x22) + QUIET + frame(0x33))
    assert rig.flags("RXRDY", "RXWAKE", "RXDT") == {"RXRDY": 1, "RXWAKE": 1, "RXDT": 0x33}
    assert rig.count("RXINT") == before + 1


@pytest.mark.rule("SCI-130", "SCI-132")
def test_in_sleep_the_rest_of_the_block_is_skipped():
    rig = asleep()
    rig.send(QUIET + frame(0x33))
    assert rig.read("SCIRXBUF") == 0x33
    rig.send(frame(0x44) + frame(0x55) + "1")
    assert rig.flags("RXRDY", "SLEEP") == {"RXRDY": 0, "SLEEP": 1}


@pytest.mark.rule("SCI-131", "SCI-132")
def test_in_sleep_a_frame_with_address_bit_1_is_received():
    rig = asleep(**ADDRESS)
    before = rig.count("RXINT")
    rig.send(frame(0x22, address=0) + frame(0x33, address=1) + "1")
    assert rig.flags("RXRDY", "RXDT", "SLEEP") == {"RXRDY": 1, "RXDT": 0x33, "SLEEP": 1}
    assert rig.count("RXINT") == before + 1


@pytest.mark.rule("SCI-132", "SCI-134")
@pytest.mark.parametrize("sleep", [0, 1])
def test_only_software_and_system_reset_change_sleep(sleep):
    rig = SciRig(SLEEP=sleep, **ADDRESS).with_rxd(frame(0x22, address=1) + frame(0x33, address=0) + "0" * 30 + QUIET)
    assert rig.get("SLEEP") == sleep
    rig.set(SWRESET=0)
    assert rig.get("SLEEP") == sleep
    rig.set(SWRESET=1)
    assert rig.get("SLEEP") == sleep


@pytest.mark.rule("SCI-133")
@pytest.mark.parametrize("fields", [{}, ADDRESS])
def test_every_character_is_received_after_sleep_is_cleared(fields):
    rig = asleep(**fields)
    rig.send(QUIET + frame(0x33, address=1 if fields else None))
    assert rig.read("SCIRXBUF") == 0x33
    rig.set(SLEEP=0)
    for word in (0x44, 0x55, 0x66):
        rig.send(frame(word, address=0 if fields else None))
        assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": word}
        rig.read("SCIRXBUF")
