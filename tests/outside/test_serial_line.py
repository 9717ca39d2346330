"""The other end of an SCI: bytes sent on RX, bytes received from TX, and errors of a real line."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.firmware import start_sci
from periph_sim.outside.serial_line import SerialLine
from periph_sim.outside.session import Session
from periph_sim.scene.firmware_loader import Firmware
from tests.outside.sessions import Records, case, refuses

LINES = ("RX", "TX")
FE, PE = 0x10, 0x04  # bits of SCIRXST
FE_OR_PE = FE | PE


class Echo:
    """Firmware that answers each character with the next one, and keeps what SCIRXBUF gave, with error bits."""

    def __init__(self, sciccr: int = 7) -> None:
        self.words: list[int] = []
        self.breaks = 0
        self.sciccr = sciccr

    def main(self, dsp: Any, settings: Any) -> None:
        sci = start_sci(dsp, "SCI-A", 40, self.sciccr, fifo=False)  # 37.5 MHz / (8 * 41): 114329 baud
        while True:
            dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
            status = sci.SCIRXST.all & FE_OR_PE
            word = sci.SCIRXBUF.RXDT
            self.words.append(word | status << 8)
            if status:
                dsp.compute(45_000)  # 300 us, since a break is detected ten bits later
                self.breaks += sci.SCIRXST.BRKDT
                sci.SCICTL1.all = 0x03
                sci.SCICTL1.all = 0x23
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = word + 1 & 0xFF


def echo(form: str = "8n1", sciccr: int = 7, baud: int = 115_200) -> tuple[Session, SerialLine, Echo]:
    firmware = Echo(sciccr)
    session = Session(case("uart_logger", ("SCI-A",)), LINES, programs={"dsp": Firmware("echo", firmware.main, None)})
    line = session.serial("scia", baud, form)
    later(session, "1 ms")
    return session, line, firmware


def later(session: Session, length: str) -> None:
    session.advance(session.now + session.ticks(length))


def sent(session: Session, line: SerialLine, data: bytes, wrong: Any = "", length: str = "1 ms") -> None:
    """Write bytes and advance by `length`."""
    line.write(data, wrong)
    later(session, length)


def test_written_bytes_are_received_and_answered_by_firmware() -> None:
    session, line, firmware = echo()
    line.write(b"hello")
    assert line.waiting == 5 and line.read() == b""
    later(session, "1 ms")
    assert line.waiting == 0
    assert firmware.words == list(b"hello")
    assert (line.read(2), line.read(), line.wrong) == (b"if", b"mmp", 0)


@pytest.mark.parametrize(
    ("form", "sciccr"), [("8n1", 0x07), ("7e1", 0x66), ("8o2", 0xA7), ("8e1", 0x67), ("5n2", 0x84)]
)
def test_formats(form: str, sciccr: int) -> None:
    session, line, firmware = echo(form, sciccr)
    data = bytes([0x00, 0x15, 0x0A, 0x1F])
    sent(session, line, data, length="2 ms")
    assert firmware.words == list(data)
    assert line.wrong == 0


def test_a_sleeping_receiver_gets_only_bytes_after_its_address() -> None:
    """Firmware sleeps until an address comes, a byte whose ninth bit is 1; waiting bytes keep their ninth bit."""
    heard: list[int] = []

    def sleeper(dsp: Any, settings: Any) -> None:
        sci = start_sci(dsp, "SCI-A", 40, 0x0F, fifo=False)  # address-bit mode
        sci.SCICTL1.SLEEP = 1
        while True:
            dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
            woken, word = sci.SCIRXST.RXWAKE, sci.SCIRXBUF.RXDT
            if woken:
                sci.SCICTL1.SLEEP = word != 0x21
            else:
                heard.append(word)
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = word

    session = Session(case("uart_logger", ("SCI-A",)), LINES, programs={"dsp": Firmware("nine", sleeper, None)})
    line = session.serial("scia", 115_200, "8s1")
    later(session, "1 ms")
    line.write(b"no")
    for address, data in ((b"\x21", b"yes"), (b"\x22", b"neither")):
        line.set(115_200, "8m1")
        line.write(address)
        line.set(115_200, "8s1")
        line.write(data)
    later(session, "3 ms")
    assert (bytes(heard), line.wrong, line.read()) == (b"yes", 0, b"\x21yes\x22")
    line.set(115_200, "8m1")
    line.write(b"\x21")  # characters of the SCI have a ninth bit of 0, so their parity is now wrong
    later(session, "1 ms")
    assert (line.read(), line.wrong) == (b"\x21", 1)


def test_characters_with_errors_are_counted() -> None:
    """The SCI sends a parity bit where the line expects a stop bit: 1 for 0x04, 0 for 0x06."""
    session, line, _ = echo("8n1", 0x67)
    for byte in (0x03, 0x05):
        sent(session, line, bytes([byte]), length="2 ms")
    assert (line.received, line.wrong) == (2, 1)


@pytest.mark.parametrize(("wrong", "bit"), [("parity", PE), ("stop", FE)])
def test_wrong_bits_reach_the_status(wrong: Any, bit: int) -> None:
    session, line, firmware = echo("8e1", 0x67)
    sent(session, line, b"\x55", wrong)
    sent(session, line, b"\x56")
    assert [word >> 8 for word in firmware.words] == [bit, 0]
    assert [word & 0xFF for word in firmware.words] == [0x55, 0x56]


@pytest.mark.parametrize(
    ("data", "wrong", "sentence"), [("abc", "", "is not of type bytes"), (b"a", "foo", "wrong='foo': expected")]
)
def test_invalid_data_is_refused(data: Any, wrong: Any, sentence: str) -> None:
    _, line, _ = echo()
    refuses(sentence, line.write, data, wrong)
    assert line.waiting == 0


def test_another_rate_causes_framing_errors() -> None:
    session, line, firmware = echo(baud=57_600)
    sent(session, line, b"\x00\x00", length="2 ms")
    assert any(word >> 8 & FE for word in firmware.words)
    line.set(115_200)
    later(session, "1 ms")
    sent(session, line, b"A")
    assert firmware.words[-1] == ord("A")


def test_a_break_is_detected_once() -> None:
    session, line, firmware = echo()
    line.send_break("300 us")
    refuses("a break cannot begin: bytes are on their way", line.send_break, "300 us")
    later(session, "2 ms")
    assert (firmware.breaks, firmware.words) == (1, [FE << 8])


def test_a_break_lasts_until_it_is_ended_or_bytes_follow() -> None:
    session, line, firmware = echo()
    line.write(b"a")
    line.hold_break(True)
    line.hold_break(True)
    assert line.broken and line.waiting == 1
    later(session, "2 ms")
    assert (firmware.words[:2], session.level("RX")) == ([ord("a"), FE << 8], 0)
    assert firmware.breaks > 1  # the break is detected again after each reset of the module
    sent(session, line, b"b")
    assert (line.broken, line.waiting, line.sent, session.level("RX")) == (False, 0, 2, 1)


def test_waiting_bytes_schedule_no_events() -> None:
    session, line, _ = echo()
    line.write(bytes(1_000_000))
    before = session.scene.kernel.events
    later(session, "1 ms")
    assert session.scene.kernel.events - before < 2_000
    assert 999_980 < line.waiting < 1_000_000


# Edges, tick by tick ----------------------------------------------------------------

BIT = Fraction(3_000_000_000, 115_200)  # ticks


def quiet(form: str = "8n1") -> tuple[Session, SerialLine, Records]:
    """Return a session at 1 ms whose firmware ignores received bytes, its line and its records."""
    records = Records()
    session = Session(case("uart_logger", ("SCI-A",)), LINES, subscribe=records.subscribe)
    line = session.serial("scia", form=form)
    later(session, "1 ms")
    return session, line, records


def edges_of_rx(records: Records) -> list[tuple[int, int]]:
    """Return tick and level of each edge of RX from 1 ms on."""
    return [(one.tick - 3_000_000, one.value) for one in records.kept if (one.kind, one.where) == (Kind.EDGE, "RX")]


def edges_of(levels: str, begin: int = 0) -> list[tuple[int, int]]:
    """Return the edges, with their ticks, of levels of one bit each that follow a high line."""
    bits = "1" + levels.replace(" ", "")
    return [(int(begin + place * BIT), int(level)) for place, level in enumerate(bits[1:]) if level != bits[place]]


@pytest.mark.parametrize(
    ("form", "wrong", "frame"),
    [
        ("8n1", "", "0 10101000 1"),
        ("7e1", "", "0 1010100 1 1"),  # 15 has three ones
        ("8o2", "", "0 10101000 0 11"),
        ("8e1", "parity", "0 10101000 0 1"),
        ("7o2", "parity", "0 1010100 1 11"),
        ("8m1", "", "0 10101000 1 1"),  # the ninth bit is 1 in any byte
        ("8s1", "", "0 10101000 0 1"),
        ("8s1", "parity", "0 10101000 1 1"),
        ("5n2", "stop", "0 10101 00 1"),  # the line is idle one bit later
        ("8e1", "stop", "0 10101000 1 0 1"),
    ],
)
def test_frames_follow_each_other_without_a_gap_and_without_drift(form: str, wrong: Any, frame: str) -> None:
    session, line, records = quiet(form)
    sent(session, line, b"\x15" * 5, wrong)
    assert edges_of_rx(records) == edges_of(frame * 5)
    assert (line.sent, line.waiting, session.level("RX")) == (5, 0, 1)


def test_another_rate_is_used_from_the_end_of_the_current_frame() -> None:
    session, line, records = quiet()
    line.write(b"\xff")
    later(session, "10 us")
    line.set(1_000_000)
    sent(session, line, b"\xff")
    begin = -(-10 * BIT // 1)
    assert edges_of_rx(records) == [(0, 0), (int(BIT), 1), (begin, 0), (begin + 3000, 1)]


@pytest.mark.parametrize(
    ("wrong", "form", "frame"),
    [
        ("parity", "8n1", "0 00000000 1"),  # the new format has no parity bit
        ("parity", "8o1", "0 00000000 0 1"),  # the correct bit is 1
        ("stop", "8n2", "0 00000000 00 1"),
    ],
)
def test_waiting_bytes_with_a_wrong_bit_are_sent_in_the_new_format(wrong: Any, form: str, frame: str) -> None:
    session, line, records = quiet("8e1")
    line.write(b"\0", wrong)
    line.set(115_200, form)
    later(session, "1 ms")
    assert edges_of_rx(records) == edges_of(frame)


def test_a_break_has_the_requested_length_and_a_frame_follows_after_one_bit() -> None:
    session, line, records = quiet()
    line.send_break("300 us")
    sent(session, line, b"\xff")
    assert edges_of_rx(records) == [(0, 0), (900_000, 1), (int(900_000 + BIT), 0), (int(900_000 + 2 * BIT), 1)]


def test_a_held_break_lasts_at_least_one_bit() -> None:
    session, line, records = quiet()
    for on in (True, False, True):
        line.hold_break(on)
    sent(session, line, b"\xff")
    assert edges_of_rx(records) == edges_of("0101 0 1")


@pytest.mark.parametrize(("count", "discarded"), [(1152, 0), (1153, 1153)])
def test_for_a_new_client_more_than_a_tenth_of_a_second_of_bytes_is_discarded(count: int, discarded: int) -> None:
    session, line, records = quiet()
    line.write(bytes(count))
    if discarded:
        line.hold_break(True)
    assert (line.next_client(), line.waiting) == (discarded, count - discarded)
    later(session, "1 ms")
    assert (line.broken, bool(edges_of_rx(records))) == (False, not discarded)
    assert not discarded or session.level("RX")


def test_the_log_contains_each_instant_and_the_begin_of_each_frame(log: Path) -> None:
    session = Session(case("uart_logger", ("SCI-A",)), LINES, log=log)
    line = session.serial("scia")
    sent(session, line, b"\xff")
    session.finish()
    head, *rows = map(json.loads, log.read_text().splitlines())
    assert head == {
        "format": "periph-sim outside",
        "version": 1,
        "case": "mine",
        "ticks_per_second": 3_000_000_000,
        "wires": ["RX", "TX"],
    }
    assert rows == [{"serial": "RX"}, [0, {"RX": 0}, ["RX"]], [int(BIT), {"RX": 1}], {"end": 3_000_000}]


@pytest.mark.parametrize(
    ("port", "baud", "form", "sentence"),
    [
        ("scib", 9600, "8n1", "no unit has SCI-B|there is no SCI 'SCI-B'"),
        ("tty", 9600, "8n1", "there is no SCI 'tty'"),
        ("scia", 0, "8n1", "0 baud: expected 1 or more"),
        ("scia", 9600, "9n1", "format '9n1': expected data bits 5 to 8"),
        ("SCI-A", 9600, "8x1", "format '8x1': expected"),
    ],
)
def test_an_invalid_port_rate_or_format_is_refused(port: str, baud: int, form: str, sentence: str) -> None:
    session = Session(case("uart_logger", ("SCI-A",)), LINES)
    refuses(sentence, session.serial, port, baud, form)


def test_one_baud_is_the_slowest_rate() -> None:
    session, line, _ = quiet()
    line.set(1, "8n1")
    assert line.checked(1, "8n1")[0] == session.ticks_per_second


def test_a_frame_begins_before_the_tick_given_to_feed() -> None:
    session, line, _ = quiet()
    line.write(b"a")
    line.feed(session.now)
    assert line.waiting == 1
    line.feed(session.now + 1)
    assert line.waiting == 0


def test_a_break_is_no_character() -> None:
    session, line, _ = quiet()
    line.send_break("10 ms")
    later(session, "20 ms")
    assert session.finish().sci_bytes == 0


def test_a_port_can_be_opened_once_and_its_rx_must_be_given_to_the_session() -> None:
    session = Session(case("uart_logger", ("SCI-A",)), LINES)
    line = session.serial("dsp.SCI-A")
    refuses(r"dsp.SCI-A has its other end already", session.serial, "scia")
    refuses("wrong parity: the format has none; set one, as in 8e1", line.write, b"a", "parity")
    refuses(
        r"RX of dsp.SCI-A does not lead outside; give it to the session",
        Session(case("uart_logger", ("SCI-A",)), ("TX",)).serial,
        "scia",
    )
