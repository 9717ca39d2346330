"""The other end of an SCI: bytes on RX, bytes from TX, and all that a real line can do wrong."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.firmware import start_sci
from periph_sim.outside import OutsideError
from periph_sim.outside.serial_line import SerialLine
from periph_sim.outside.session import Session
from periph_sim.scene.firmware_loader import Firmware
from tests.outside.sessions import case

LINES = ("RX", "TX")
FE, PE = 0x10, 0x04  # of SCIRXST
FE_OR_PE = FE | PE


class Echo:
    """Firmware that answers each word with it plus one, and keeps what SCIRXBUF gave, error bits included."""

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
                dsp.compute(45_000)  # 300 us: a break is known ten bits later
                self.breaks += sci.SCIRXST.BRKDT
                sci.SCICTL1.all = 0x03
                sci.SCICTL1.all = 0x23
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = word + 1 & 0xFF


def echo(form: str = "8n1", sciccr: int = 7, baud: int = 115_200) -> tuple[Session, SerialLine, Echo]:
    firmware = Echo(sciccr)
    session = Session(case("uart_logger", ("SCI-A",)), LINES, programs={"dsp": Firmware("echo", firmware.main, None)})
    return session, session.serial("scia", baud, form), firmware


def later(session: Session, length: str) -> None:
    session.advance(session.now + session.ticks(length))


def test_what_is_written_comes_back_as_firmware_answers() -> None:
    session, line, firmware = echo()
    later(session, "1 ms")
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
    later(session, "1 ms")
    data = bytes([0x00, 0x15, 0x0A, 0x1F])
    line.write(data)
    later(session, "2 ms")
    assert firmware.words == list(data)
    assert line.wrong == 0


@pytest.mark.parametrize(("wrong", "bit"), [("parity", PE), ("stop", FE)])
def test_wrong_bits_reach_the_status(wrong: Any, bit: int) -> None:
    session, line, firmware = echo("8e1", 0x67)
    later(session, "1 ms")
    line.write(b"\x55", wrong)
    later(session, "1 ms")
    line.write(b"\x56")
    later(session, "1 ms")
    assert [word >> 8 for word in firmware.words] == [bit, 0]
    assert [word & 0xFF for word in firmware.words] == [0x55, 0x56]


@pytest.mark.parametrize(
    ("data", "wrong", "sentence"), [("abc", "", "is no bytes"), (b"a", "foo", "wrong='foo': expected")]
)
def test_what_cannot_be_sent_is_refused(data: Any, wrong: Any, sentence: str) -> None:
    _, line, _ = echo()
    with pytest.raises(OutsideError, match=sentence):
        line.write(data, wrong)
    assert line.waiting == 0


def test_another_rate_is_a_mismatch_on_the_wire() -> None:
    session, line, firmware = echo(baud=57_600)
    later(session, "1 ms")
    line.write(b"\x00\x00")
    later(session, "2 ms")
    assert any(word >> 8 & FE for word in firmware.words)
    line.set(115_200)
    later(session, "1 ms")
    line.write(b"A")
    later(session, "1 ms")
    assert firmware.words[-1] == ord("A")


def test_a_break_is_one() -> None:
    session, line, firmware = echo()
    later(session, "1 ms")
    line.send_break("300 us")
    with pytest.raises(OutsideError, match="a break cannot begin: bytes are on their way"):
        line.send_break("300 us")
    later(session, "2 ms")
    assert (firmware.breaks, firmware.words) == (1, [FE << 8])


def test_a_break_lasts_until_it_is_ended_or_bytes_follow() -> None:
    session, line, firmware = echo()
    later(session, "1 ms")
    line.write(b"a")
    line.hold_break(True)
    line.hold_break(True)
    assert line.broken and line.waiting == 1
    later(session, "2 ms")
    assert (firmware.words[:2], session.level("RX")) == ([ord("a"), FE << 8], 0)
    assert firmware.breaks > 1  # it is there again whenever the module begins anew
    line.write(b"b")
    later(session, "1 ms")
    assert (line.broken, line.waiting, line.sent, session.level("RX")) == (False, 0, 2, 1)


def test_much_that_waits_is_bytes_and_no_events() -> None:
    session, line, _ = echo()
    later(session, "1 ms")
    line.write(bytes(1_000_000))
    before = session.scene.kernel.events
    later(session, "1 ms")
    assert session.scene.kernel.events - before < 2_000
    assert 999_980 < line.waiting < 1_000_000


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
def test_what_is_no_port_rate_or_format_is_refused(port: str, baud: int, form: str, sentence: str) -> None:
    session = Session(case("uart_logger", ("SCI-A",)), LINES)
    with pytest.raises(OutsideError, match=sentence):
        session.serial(port, baud, form)


def test_a_port_has_one_other_end_and_rx_leads_outside() -> None:
    session = Session(case("uart_logger", ("SCI-A",)), LINES)
    line = session.serial("dsp.SCI-A")
    with pytest.raises(OutsideError, match=r"dsp.SCI-A has its other end already"):
        session.serial("scia")
    with pytest.raises(OutsideError, match="wrong parity: the format has none; set one, as in 8e1"):
        line.write(b"a", "parity")
    with pytest.raises(OutsideError, match=r"RX of dsp.SCI-A does not lead outside; give it to the session"):
        Session(case("uart_logger", ("SCI-A",)), ("TX",)).serial("scia")
