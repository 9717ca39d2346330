"""Open questions about the SCI, which TI's documents do not answer: one test for each option, run with every value.

A changed default or a changed meaning of a value makes a test fail.
"""

from __future__ import annotations

import pytest

from periph_sim.f28335.sci.options import SciOptions
from tests.f28335.open_questions import check_tests_of, keep
from tests.f28335.sci_rig import SciRig, frame, levels

ADDRESS = {"ADDRIDLE_MODE": 1}


def rig_with(option: str, value: str | int | bool, **fields: int) -> SciRig:
    return keep(option, SciRig({option: value}, **fields))


def samples(text: str) -> str:
    return "".join(mark * 8 for mark in levels(text))


def first(rig: SciRig, signal: str, value: int, limit: int) -> int:
    """Return the time at which a signal first has a value, within `limit` cycles from now."""
    return next(time for time, now in rig.changes(signal, limit) if now == value)


def start_of_stop_bit(rig: SciRig) -> int:
    """Send a frame up to the start of its stop bit, and return the start of the frame."""
    begin = rig.send("0 11010010")
    rig.drive(rig.now, "RXD", 1)
    return begin


def test_every_option_has_a_test_with_every_value():
    check_tests_of(SciOptions, __name__)


# Receiver, line side.


@pytest.mark.rule("SCI-040", "SCI-062")
@pytest.mark.parametrize(("value", "eighths"), [("seven_eighths", 7), ("drawing", 6), ("stop_end", 8)])
def test_open_rxrdy_point(value, eighths):
    rig = rig_with("rxrdy_point", value)
    begin = start_of_stop_bit(rig)
    took = first(rig, "RXRDY", 1, 3 * rig.bit) - begin
    # from the edge to the first sample: half an SCICLK and the delay of the synchroniser
    assert abs(took - (9 * 8 + eighths) * rig.sciclk) <= rig.sciclk // 2 + 2
    default = SciRig()
    began = start_of_stop_bit(default)
    assert took - (first(default, "RXRDY", 1, 3 * rig.bit) - began) == (eighths - 7) * rig.sciclk


@pytest.mark.rule("SCI-147")
@pytest.mark.parametrize("value", [0, 1, 3, 16])
def test_open_rx_int_extra(value):
    rig = rig_with("rx_int_extra", value, RXBKINTENA=1)
    start_of_stop_bit(rig)
    ready = first(rig, "RXRDY", 1, 2 * rig.bit)
    rig.wait(1)
    assert rig.requested["RXINT"] == [ready + value]


@pytest.mark.rule("SCI-036")
@pytest.mark.parametrize(("value", "early", "late"), [("4_5_6", 1, 0), ("3_4_5", 0, 1)])
def test_open_stop_vote_samples(value, early, late):
    # stop bits that are high only in samples 3 and 4, and only in samples 5 and 6
    for stop_bit, fe in (("00110000", early), ("00001100", late)):
        rig = rig_with("stop_vote_samples", value)
        rig.send_samples(samples("0 11010010") + stop_bit + "1" * 16)
        assert (stop_bit, rig.get("FE")) == (stop_bit, fe)
    # samples 4 and 5 are used with both values
    rig = rig_with("stop_vote_samples", value)
    rig.send_samples(samples("0 11010010") + "00011000" + "1" * 16)
    assert rig.get("FE") == 0


@pytest.mark.rule("SCI-038")
@pytest.mark.parametrize(("value", "shortest"), [(6, 4), (7, 5), (8, 6)])
def test_open_start_hunt_point(value, shortest):
    # a low that begins at sub-sample 6 of the stop bit; the search must find four of its samples
    for low in range(2, 9):
        rig = rig_with("start_hunt_point", value, fifo=True)
        rig.send_samples(samples("0 11010010") + "11111" + "0" * low + "1" * 100)
        assert (low, rig.get("RXFFST")) == (low, 1 + int(low >= shortest))


@pytest.mark.rule("SCI-121")
@pytest.mark.parametrize(("value", "false_start"), [("address_bit", 1), ("parity_bit", 0)])
def test_open_addrbit_hunt_with_parity(value, false_start):
    # 0x4B, address bit 0, even parity 0: a search that begins in the address bit finds samples 6, 7, 8 and 1 low
    rig = rig_with("addrbit_hunt_with_parity", value, fifo=True, **ADDRESS, PARITYENA=1, PARITY=1)
    rig.send_samples(samples("0 11010010 0 0 1") + "1" * 8 * 16)
    assert rig.read("SCIRXBUF") == 0x4B
    assert rig.get("RXFFST") == false_start
    # if the stop bit is late, a search that begins in the parity bit finds the same
    rig = rig_with("addrbit_hunt_with_parity", value, fifo=True, **ADDRESS, PARITYENA=1, PARITY=1)
    rig.send_samples(samples("0 11010010 0 0") + "01111111" + "1" * 8 * 16)
    assert rig.read("SCIRXBUF") == 0x4B
    assert rig.get("RXFFST") == 1


def least_break(rig_of: dict[str, str | int | bool]) -> int:
    """Return the shortest low in SCICLK that sets BRKDT."""
    for low in range(140, 176):
        rig = SciRig(rig_of)
        for option in rig_of:
            keep(option, rig)
        rig.send_samples("0" * low + "1" * 16)
        if rig.get("BRKDT"):
            return low
    raise AssertionError("no low of up to 175 SCICLK set BRKDT")


# The last sample of the stop bit vote is sub-sample 6 of bit 9: sample 78 of the low. Bit 9 ends with sample 80.


@pytest.mark.rule("SCI-086", "SCI-087")
@pytest.mark.parametrize(("value", "sciclk"), [("10", 78 + 80), ("9.625", 78 + 77)])
def test_open_break_bits(value, sciclk):
    assert least_break({"break_bits": value}) == sciclk


@pytest.mark.rule("SCI-086", "SCI-087")
@pytest.mark.parametrize(("value", "later"), [("last_stop_sample", 0), ("stop_end", 2)])
def test_open_break_count_from(value, later):
    base = least_break({})
    assert least_break({"break_count_from": value}) == base + later
    # with the samples 3, 4, 5, as drawn in the erratum, the ten bits begin and end one SCICLK earlier
    if value == "last_stop_sample":
        assert least_break({"stop_vote_samples": "3_4_5"}) == base - 1


@pytest.mark.rule("SCI-093")
@pytest.mark.parametrize(("value", "words"), [("blocked", []), ("next_high", [0x4B])])
def test_open_rx_after_break(value, words):
    rig = rig_with("rx_after_break", value, fifo=True)
    rig.send("0" * 25 + "1" * 3)
    rig.received()
    rig.send(frame(0x4B) + "1")
    assert rig.received() == words
    assert rig.get("BRKDT") == 1


@pytest.mark.rule("SCI-037")
@pytest.mark.parametrize("value", [2, 0, 3])
def test_open_rx_sync_stages(value):
    def soonest(stages: int) -> int:
        """Return the shortest time from a start edge to RXRDY over all phases."""
        took = []
        for phase in range(8):
            rig = rig_with("rx_sync_stages", stages, brr=1)
            start = rig.send("0 11010010", at=rig.now + phase)
            rig.drive(rig.now, "RXD", 1)
            took.append(next(time for time, ready in rig.changes("RXRDY", 2 * rig.bit) if ready) - start)
        assert max(took) - min(took) == 7
        return min(took)

    assert soonest(value) == soonest(0) + value


# Receiver, flags and buffer.


@pytest.mark.rule("SCI-089")
@pytest.mark.parametrize(("value", "words"), [(True, [0x8000]), (False, [])])
def test_open_break_char_delivered(value, words):
    rig = rig_with("break_char_delivered", value, fifo=True)
    rig.send("0" * 25 + "1" * 3)
    assert rig.flags("FE", "BRKDT") == {"FE": 1, "BRKDT": 1}
    assert rig.received() == words


@pytest.mark.rule("SCI-095")
@pytest.mark.parametrize(("value", "brkdt"), [("set", 1), ("suppressed", 0)])
def test_open_brkdt_in_sleep(value, brkdt):
    rig = rig_with("brkdt_in_sleep", value, **ADDRESS, SLEEP=1, RXBKINTENA=1)
    rig.send("0" * 25 + "1" * 3)
    assert (rig.get("BRKDT"), rig.count("RXINT")) == (brkdt, brkdt)


@pytest.mark.rule("SCI-050", "SCI-054", "SCI-058")
@pytest.mark.parametrize(("value", "stays"), [(True, 1), (False, 0)])
def test_open_error_flags_sticky(value, stays):
    rig = rig_with("error_flags_sticky", value, PARITYENA=1)
    rig.send(frame(0x11, parity="odd") + frame(0x22, parity="even", bad="stop") + "1")
    errors = ("RXERROR", "FE", "OE", "PE")
    assert rig.flags(*errors) == dict.fromkeys(errors, 1)
    rig.read("SCIRXBUF")
    assert rig.flags(*errors) == dict.fromkeys(errors, 1)
    rig.send(frame(0x33, parity="odd") + "1")
    assert rig.flags(*errors) == dict.fromkeys(errors, stays)


@pytest.mark.rule("SCI-129", "SCI-126")
@pytest.mark.parametrize(("value", "loads"), [(False, 0), (True, 1)])
def test_open_sleep_loads_buffer(value, loads):
    rig = rig_with("sleep_loads_buffer", value, **ADDRESS, SLEEP=1)
    rig.send(frame(0x22, address=0) + "1")
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 0, "RXDT": 0x22 * loads}
    rig = rig_with("sleep_loads_buffer", value, **ADDRESS, SLEEP=1, fifo=True, RXFFIL=1, RXFFIENA=1)
    rig.send(frame(0x22, address=0) + "1")
    assert (rig.flags("RXFFST", "RXFFINT"), rig.count("RXINT")) == ({"RXFFST": loads, "RXFFINT": loads}, 0)


@pytest.mark.rule("SCI-100")
@pytest.mark.parametrize(("value", "while_idle"), [("tenth_bit", 1), ("next_character", 0)])
def test_open_rxwake_idle_point(value, while_idle):
    rig = rig_with("rxwake_idle_point", value)
    rig.send_and_read(frame(0x11))
    rig.send("1" * 12)
    assert rig.get("RXWAKE") == while_idle
    rig.send(frame(0x22))
    assert rig.get("RXWAKE") == 1


@pytest.mark.rule("SCI-185")
@pytest.mark.parametrize(("value", "follows"), [("stays_0", 0), ("follows", 1)])
def test_open_rxrdy_in_fifo_mode(value, follows):
    rig = rig_with("rxrdy_in_fifo_mode", value, fifo=True)
    seen = [rig.status("RXRDY")]
    rig.send(frame(0x11) + frame(0x22) + "1")
    seen.append(rig.status("RXRDY"))
    rig.read("SCIRXBUF")
    seen.append(rig.status("RXRDY"))
    rig.read("SCIRXBUF")
    seen.append(rig.status("RXRDY"))
    assert seen == [0, follows, follows, 0]


@pytest.mark.rule("SCI-186")
@pytest.mark.parametrize(("value", "oe"), [("overflow_only", 0), ("per_unread_word", 1)])
def test_open_oe_in_fifo_mode(value, oe):
    rig = rig_with("oe_in_fifo_mode", value, fifo=True)
    rig.send(frame(0x11) + "1")
    assert rig.get("OE") == 0
    rig.send(frame(0x22) + "1")
    assert rig.flags("OE", "RXFFST") == {"OE": oe, "RXFFST": 2}
    for word in range(15):
        rig.send(frame(word) + "1")
    assert rig.flags("OE", "RXFFOVF") == {"OE": 1, "RXFFOVF": 1}


@pytest.mark.rule("SCI-179")
@pytest.mark.parametrize(("value", "words"), [("oldest", range(2, 18)), ("newest", range(16))])
def test_open_fifo_overflow_drops(value, words):
    rig = rig_with("fifo_overflow_drops", value, fifo=True)
    for word in range(18):
        rig.send(frame(word) + "1")
    assert rig.flags("RXFFOVF", "RXFFST") == {"RXFFOVF": 1, "RXFFST": 16}
    assert rig.received() == list(words)


@pytest.mark.rule("SCI-180")
@pytest.mark.parametrize(("value", "requests"), [("none", 0), ("rxffiena", 1)])
def test_open_rxffovf_interrupt(value, requests):
    rig = rig_with("rxffovf_interrupt", value, fifo=True, RXFFIL=31, RXFFIENA=1)
    for word in range(17):
        rig.send(frame(word) + "1")
    assert (rig.get("RXFFOVF"), rig.count("RXINT")) == (1, requests)
    rig = rig_with("rxffovf_interrupt", value, fifo=True, RXFFIL=31, RXFFIENA=0)
    for word in range(17):
        rig.send(frame(word) + "1")
    assert (rig.get("RXFFOVF"), rig.count("RXINT")) == (1, 0)


@pytest.mark.rule("SCI-140", "SCI-182")
@pytest.mark.parametrize(("value", "requests"), [("rising", 1), ("every_error", 3)])
@pytest.mark.parametrize("fifo", [False, True])
def test_open_rxerr_int_mode(value, requests, fifo):
    rig = rig_with("rxerr_int_mode", value, RXERRINTENA=1, fifo=fifo)
    for _ in range(3):
        rig.send_and_read(frame(0x11, bad="stop") + "1")
    assert rig.count("RXINT") == requests


@pytest.mark.rule("SCI-167")
@pytest.mark.parametrize(("value", "word"), [("last_word", 0x22), ("zero", 0)])
def test_open_rxfifo_read_when_empty(value, word):
    rig = rig_with("rxfifo_read_when_empty", value, fifo=True)
    rig.send(frame(0x11) + frame(0x22) + "1")
    assert rig.received() == [0x11, 0x22]
    assert [(rig.read("SCIRXBUF"), rig.get("RXFFST")) for _ in range(2)] == [(word, 0)] * 2


# FIFO interrupts.


@pytest.mark.rule("SCI-157", "SCI-159", "SCI-174", "SCI-176")
@pytest.mark.parametrize(("value", "again"), [("level", 1), ("edge", 0)])
def test_open_fifo_int_mode(value, again):
    rig = rig_with("fifo_int_mode", value, fifo=True, RXFFIL=1, TXENA=0)
    rig.send(frame(0x11) + "1")
    # both flags are cleared while their causes last: the transmit FIFO is empty (0 <= 0), the other has a word (1 >= 1)
    rig.set(TXFFIENA=1, RXFFIENA=1, TXFFINTCLR=1, RXFFINTCLR=1)
    assert rig.flags("TXFFINT", "RXFFINT") == {"TXFFINT": again, "RXFFINT": again}
    before = rig.count("TXINT"), rig.count("RXINT")
    rig.set(TXFFINTCLR=1, RXFFINTCLR=1)
    assert (rig.count("TXINT") - before[0], rig.count("RXINT") - before[1]) == (again, again)
    # without the causes, the flags remain cleared with both values, and new causes set them
    rig.received()
    rig.write("SCITXBUF", 0x11)
    rig.set(TXFFINTCLR=1, RXFFINTCLR=1)
    assert rig.flags("TXFFINT", "RXFFINT") == {"TXFFINT": 0, "RXFFINT": 0}
    rig.set(TXENA=1)
    rig.send(frame(0x22) + "1")
    assert rig.flags("TXFFINT", "RXFFINT") == {"TXFFINT": 1, "RXFFINT": 1}


@pytest.mark.rule("SCI-157")
def test_open_fifo_int_mode_edge_asks_for_each_word_that_leaves_an_empty_fifo():
    rig = rig_with("fifo_int_mode", "edge", fifo=True, TXFFIL=0, TXFFIENA=1)
    requested = rig.count("TXINT")
    for words in (1, 2, 3):
        rig.set(TXFFINTCLR=1)
        assert rig.get("TXFFINT") == 0
        rig.put(0x55, 11)
        assert (words, rig.get("TXFFINT"), rig.count("TXINT") - requested) == (words, 1, words)


# Transmitter.


@pytest.mark.rule("SCI-152")
@pytest.mark.parametrize(("value", "last"), [("ignored", 0x1F), ("overwrites_last", 0x99)])
def test_open_txfifo_write_when_full(value, last):
    rig = rig_with("txfifo_write_when_full", value, fifo=True, TXENA=0)
    rig.write("SCITXBUF", *range(0x10, 0x20))
    rig.write("SCITXBUF", 0x99)
    assert rig.get("TXFFST") == 16
    rig.set(TXENA=1)
    assert rig.characters(wait=16 * 10 + 3) == [*range(0x10, 0x1F), last]


@pytest.mark.rule("SCI-065")
@pytest.mark.parametrize(("value", "before"), [("start_edge", False), ("next_lspclk", True)])
def test_open_txrdy_point(value, before):
    rig = rig_with("txrdy_point", value)
    written = rig.now
    rig.write("SCITXBUF", 0x55)
    assert rig.get("TXRDY") == 0
    ready = first(rig, "TXRDY", 1, rig.bit)
    rig.wait(1)
    assert (ready < rig.falls()[0]) == before
    if before:
        assert ready == written + 4 - written % 4  # edges of LSPCLK are at multiples of four
    else:
        assert ready == rig.falls()[0]


@pytest.mark.rule("SCI-065", "SCI-155")
def test_open_txrdy_point_next_lspclk_a_word_that_is_cleared_before_is_not_sent():
    rig = rig_with("txrdy_point", "next_lspclk", fifo=True)
    rig.write("SCITXBUF", 0x55)
    rig.set(TXFIFOXRESET=0)
    rig.wait(11)
    assert (rig.edges, rig.get("TXFFST"), rig.get("TXEMPTY")) == ([], 0, 1)


@pytest.mark.rule("SCI-068")
@pytest.mark.parametrize(("value", "bits"), [("stop_end", 10), ("stop_begin", 9)])
def test_open_tx_reload_point(value, bits):
    rig = rig_with("tx_reload_point", value)
    rig.put(0x11, 1)
    rig.write("SCITXBUF", 0x22)
    ready = first(rig, "TXRDY", 1, 12 * rig.bit)
    assert ready == rig.falls()[0] + bits * rig.bit
    rig.wait(15)
    one, two = (start for start, _ in rig.frames(10))
    assert two - one == 10 * rig.bit
    assert rig.characters() == [0x11, 0x22]


@pytest.mark.rule("SCI-064")
@pytest.mark.parametrize(("value", "part"), [("write", 0.0), ("halfway", 0.5)])
def test_open_txempty_fall(value, part):
    rig = rig_with("txempty_fall", value)
    written = rig.now
    rig.write("SCITXBUF", 0x55)
    due = rig.chip.next_wake
    fell = written if rig.get("TXEMPTY") == 0 else first(rig, "TXEMPTY", 0, rig.bit)
    assert fell in (written, due)  # at the write, or at a wake-up that the chip has requested
    rig.wait(1)
    assert fell == written + int(part * (rig.falls()[0] - written))
    rig.wait(11)
    assert rig.get("TXEMPTY") == 1


@pytest.mark.rule("SCI-067")
@pytest.mark.parametrize(("value", "second"), [("replaces", 0x33), ("ignored", 0x22)])
def test_open_txbuf_write_when_full(value, second):
    rig = rig_with("txbuf_write_when_full", value)
    rig.put(0x11, 1)
    rig.write("SCITXBUF", 0x22)
    rig.put(0x33, 40)
    assert rig.characters() == [0x11, second]


@pytest.mark.rule("SCI-065")
@pytest.mark.parametrize(
    ("value", "possible"),
    [
        ("next_sciclk", [25, 50, 75, 100]),
        ("next_bit_tick", list(range(25, 801, 25))),
        ("restart", [1, 2, 3, 4]),  # LSPCLK has a period of four cycles
    ],
)
def test_open_tx_phase(value, possible):
    """Delays from a write to the start bit, for writes every 25 cycles within the eight SCICLK of a bit."""
    delays = set()
    for phase in range(0, 800, 25):
        rig = rig_with("tx_phase", value)
        rig.wait(cycles=phase)
        written = rig.now
        rig.put(0x55, 2)
        delays.add(rig.falls()[0] - written)
    assert sorted(delays) == possible


@pytest.mark.rule("SCI-076", "SCI-075")
@pytest.mark.parametrize(("value", "sent"), [("all_written", 3), ("current_only", 1)])
def test_open_txena_clear_drains(value, sent):
    rig = rig_with("txena_clear_drains", value, fifo=True)
    rig.write("SCITXBUF", 0x11, 0x22, 0x33)
    rig.wait(3)
    rig.set(TXENA=0)
    assert rig.characters(wait=50) == [0x11, 0x22, 0x33][:sent]
    rig.write("SCITXBUF", 0x44)  # waits for TXENA
    assert rig.characters(wait=15) == [0x11, 0x22, 0x33][:sent]
    rig = rig_with("txena_clear_drains", value)
    rig.put(0x11, 3)
    rig.write("SCITXBUF", 0x22)
    rig.set(TXENA=0)
    assert rig.characters(wait=50) == [0x11, 0x22][:sent]


@pytest.mark.rule("SCI-106")
@pytest.mark.parametrize(("value", "fixed"), [("11_bits", True), ("one_frame", False)])
@pytest.mark.parametrize(("fields", "length"), [({}, 10), ({"STOPBITS": 1}, 11), ({"SCICHAR": 4}, 7)])
def test_open_txwake_idle_len(value, fixed, fields, length):
    rig = rig_with("txwake_idle_len", value, **fields)
    rig.put(0x1F, 2)
    rig.set(TXWAKE=1)
    rig.put(0x00, length)
    rig.put(0x1F, 40)
    one, two = (start for start, _ in rig.frames(length))
    assert two - one == (length + (11 if fixed else length)) * rig.bit


@pytest.mark.rule("SCI-023")
@pytest.mark.parametrize(("value", "parity"), [("masked", "0"), ("whole_byte", "1")])
def test_open_parity_of_short_chars(value, parity):
    # three bits of data, 011; the written word has one more 1 above them
    rig = rig_with("parity_of_short_chars", value, SCICHAR=2, PARITYENA=1, PARITY=1)
    assert rig.transmit(0x83, 6) == levels(f"0 110 {parity} 1")


@pytest.mark.rule("SCI-190")
@pytest.mark.parametrize(("value", "bits"), [("no_delay", 0), ("delay", 20)])
def test_open_fftxdly_first_word(value, bits):
    rig = rig_with("fftxdly_first_word", value, fifo=True, FFTXDLY=20)
    written = rig.now
    rig.put(0x11, 24)
    assert bits * rig.bit <= rig.falls()[0] - written <= bits * rig.bit + rig.sciclk


def pause(rig: SciRig) -> int:
    """Return the pause between two words of the FIFO in cycles."""
    rig.write("SCITXBUF", 0x11)
    rig.put(0x22, 2 * 11 + 260)
    one, two = (start for start, _ in rig.frames(10))
    return two - one - 10 * rig.bit


@pytest.mark.rule("SCI-189")
@pytest.mark.parametrize(("value", "bits"), [(255, 255), (256, 256)])
def test_open_fftxdly_max(value, bits):
    rig = rig_with("fftxdly_max", value, fifo=True, FFTXDLY=255)
    assert pause(rig) == bits * rig.bit
    rig = rig_with("fftxdly_max", value, fifo=True, FFTXDLY=254)
    assert pause(rig) == 254 * rig.bit


@pytest.mark.rule("SCI-187")
@pytest.mark.parametrize(("value", "sciclk"), [("bit", 8), ("sciclk", 1)])
def test_open_fftxdly_unit(value, sciclk):
    for delay in (1, 8, 100):
        rig = rig_with("fftxdly_unit", value, fifo=True, FFTXDLY=delay)
        assert pause(rig) == delay * sciclk * rig.sciclk


# Resets.


@pytest.mark.rule("SCI-205")
@pytest.mark.parametrize(("value", "stays"), [("untouched", 1), ("cleared", 0)])
def test_open_swreset_fifo_effect(value, stays):
    rig = rig_with("swreset_fifo_effect", value, fifo=True, RXFFIL=1)
    for word in range(17):
        rig.send(frame(word) + "1")
    rig.set(TXENA=0)
    rig.write("SCITXBUF", *range(3))
    assert rig.flags("TXFFST", "RXFFST", "RXFFINT", "RXFFOVF") == {
        "TXFFST": 3,
        "RXFFST": 16,
        "RXFFINT": 1,
        "RXFFOVF": 1,
    }
    rig.set(SWRESET=0)
    assert rig.flags("TXFFST", "RXFFST", "RXFFINT", "RXFFOVF") == {
        "TXFFST": 3 * stays,
        "RXFFST": 16 * stays,
        "RXFFINT": stays,
        "RXFFOVF": stays,
    }


@pytest.mark.rule("SCI-206")
@pytest.mark.parametrize(("value", "sent"), [("lost", []), ("sent_after_release", [0x4B])])
def test_open_txbuf_write_in_swreset(value, sent):
    rig = rig_with("txbuf_write_in_swreset", value)
    rig.set(SWRESET=0)
    rig.write("SCITXBUF", 0x4B)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 1, "TXEMPTY": 1}
    rig.wait(20)
    assert rig.edges == []
    rig.set(SWRESET=1)
    assert rig.characters(wait=20) == sent
    said = ["SCI-A: SCITXBUF was written 0x4b while SW RESET = 0: the character is lost"]
    assert rig.notes("lost") == ([] if sent else said)


@pytest.mark.rule("SCI-162")
@pytest.mark.parametrize(("value", "stays"), [("shifters_and_fifos", 0), ("shifters", 1)])
def test_open_scirst_scope(value, stays):
    rig = rig_with("scirst_scope", value, fifo=True, RXFFIL=1, TXFFIL=16)
    for word in range(17):
        rig.send(frame(word) + "1")
    rig.write("SCITXBUF", *range(4))
    rig.wait(2)
    before = {"TXFFST": 3, "RXFFST": 16, "RXFFINT": 1, "RXFFOVF": 1}
    assert rig.flags(*before) == before
    assert rig.show("TXD") == 0
    rig.set(SCIRST=0)
    assert rig.flags(*before) == {name: number * stays for name, number in before.items()}
    assert rig.show("TXD") == 1
    rig.write("SCITXBUF", 4)
    said = "SCI-A: SCITXBUF was written while SCIRST = 0 holds the transmit channel: the word is lost"
    assert (rig.get("TXFFST"), rig.notes("lost")) == ((4, []) if stays else (0, [said]))


# Rate and format.


@pytest.mark.rule("SCI-193")
@pytest.mark.parametrize(("value", "divider"), [("nearest", 41), ("truncated", 40)])
def test_open_autobaud_brr_rule(value, divider):
    # 1338 cycles are 41.8 times 32, so BRR + 1 is 42 or 41
    rig = rig_with("autobaud_brr_rule", value, brr=1, CDC=1)
    rig.send(frame(ord("A")) + "1", bit=1338)
    assert rig.flags("ABD", "SCIHBAUD", "SCILBAUD") == {"ABD": 1, "SCIHBAUD": 0, "SCILBAUD": divider}


@pytest.mark.rule("SCI-085")
@pytest.mark.parametrize(("value", "now"), [("next_reload", False), ("at_once", True)])
def test_open_brr_write_effect(value, now):
    rig = rig_with("brr_write_effect", value)
    rig.put(0x55, sciclk=1)
    start = rig.falls()[0]
    rig.run_until(start + 350)
    rig.set_brr(49)
    rig.wait(12)
    first_bit = rig.edges[1][0] - start
    if now:
        assert first_bit == 352 + 5 * 200  # the SCICLK restarts at the next LSPCLK
    else:
        assert first_bit == 4 * 100 + 4 * 200
    assert rig.edges[2][0] - rig.edges[1][0] == 1600


@pytest.mark.rule("SCI-027")
@pytest.mark.parametrize(("value", "first"), [("next_character", "0 01010101 1"), ("at_once", "0 01010 1")])
def test_open_format_write_effect(value, first):
    rig = rig_with("format_write_effect", value)
    rig.put(0xAA, 3)
    rig.set(SCICHAR=4)
    rig.wait(12)
    assert rig.sent(rig.falls()[0], len(levels(first)) + 3) == levels(first) + "111"
    rig = rig_with("format_write_effect", value, fifo=True)
    begin = rig.send("0 01")
    rig.set(SCICHAR=4)
    rig.send(levels(first)[3:] + "111", at=begin + 3 * rig.bit)
    assert rig.received() == [0xAA & (0xFF if value == "next_character" else 0x1F)]
    assert rig.get("FE") == 0


# Questions that came up while the model was written.


@pytest.mark.parametrize(("value", "seen"), [("reads_0", 0x00), ("accessible", 0x07)])
def test_open_clock_gate_access(value, seen):
    rig = rig_with("clock_gate_access", value)
    rig.chip.gate(rig.now, False)
    assert rig.read("SCICCR") == seen
    rig.write("SCICCR", 0x0F if seen else 0x00)
    rig.chip.gate(rig.now, True)
    assert rig.read("SCICCR") == (0x0F if seen else 0x07)


@pytest.mark.rule("SCI-098")
@pytest.mark.parametrize(("value", "block"), [(True, 1), (False, 0)])
def test_open_idle_before_first_frame(value, block):
    rig = rig_with("idle_before_first_frame", value, SLEEP=1)
    rig.wait(15)
    rig.send(frame(0x11) + "1")
    assert rig.get("RXRDY") == block


@pytest.mark.parametrize(("value", "while_waiting"), [("stays_1", 1), ("follows_fifo", 0)])
def test_open_txrdy_in_fifo_mode(value, while_waiting):
    rig = rig_with("txrdy_in_fifo_mode", value, fifo=True)
    assert rig.status("TXRDY") == 1
    rig.write("SCITXBUF", *range(3))
    rig.wait(2)
    assert rig.status("TXRDY") == while_waiting
    rig.wait(40)
    assert rig.status("TXRDY") == 1
