"""A pseudo-terminal in front of an SCI: clients that come, set a rate, leave; nothing that was sent is lost."""

from __future__ import annotations

import os
import termios
import tty
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.outside import OutsideError, Session
from periph_sim.outside.live import pty_door
from periph_sim.outside.live.loop import Loop
from periph_sim.outside.live.pacing import Pacer
from periph_sim.outside.live.pty_door import PtyDoor
from tests.outside.live.echo import written


class Served:
    """A case with a pseudo-terminal, stepped by the test."""

    def __init__(self, folder: Path, link: Path | None = None) -> None:
        self.session = Session(written(folder), ("RX", "TX"))
        self.line = self.session.serial("scia")
        self.door = PtyDoor(self.line, 115_200, "8n1", link)

    def passes(self, length: str) -> None:
        pacer = Pacer(self.session.ticks_per_second, Fraction(0))
        Loop(self.session, pacer, [self.door]).run(self.session.now + self.session.ticks(length))


def client(path: str | Path) -> int:
    file = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(file)
    os.set_blocking(file, False)
    return file


def test_clients_come_and_go(tmp_path: Path) -> None:
    link = tmp_path / "dsp"
    served = Served(tmp_path, link)
    served.passes("5 ms")
    for data, answer in ((b"hello", b"ifmmp"), (b"\x00\x11\x13\xff", b"\x01\x12\x14\x00")):
        file = client(link)
        os.write(file, data)
        served.passes("5 ms")
        assert os.read(file, 100) == answer
        os.close(file)
        served.passes("5 ms")
    served.door.close()
    assert not link.is_symlink()


def test_what_comes_while_nobody_listens_waits(tmp_path: Path) -> None:
    served = Served(tmp_path)
    file = client(served.door.path)
    data = bytes(range(256)) * 24
    sent = 0
    for _ in range(200):
        if sent < len(data):
            sent += os.write(file, data[sent : sent + 50])  # in pauses: the firmware's own rate is a little lower
        served.passes("10 ms")
    got = b""
    for _ in range(200):
        try:
            got += os.read(file, 4096)
        except BlockingIOError:
            break
        served.passes("1 ms")
    assert sent == len(data)
    assert got == bytes(byte + 1 & 0xFF for byte in data)
    os.close(file)
    served.door.close()


def test_the_client_s_rate_is_the_line_s(tmp_path: Path) -> None:
    served = Served(tmp_path)
    file = client(served.door.path)
    attributes = termios.tcgetattr(file)
    assert attributes[5] == termios.B115200
    attributes[4] = attributes[5] = termios.B9600
    termios.tcsetattr(file, termios.TCSANOW, attributes)
    os.write(file, b"a")
    served.passes("10 ms")
    with pytest.raises(BlockingIOError):
        assert os.read(file, 100) != b"b"
        os.read(file, 100)
    attributes[4] = attributes[5] = termios.B115200
    termios.tcsetattr(file, termios.TCSANOW, attributes)
    served.passes("1 ms")
    os.close(file)
    served.door.close()


def test_who_is_ahead_waits_and_what_was_not_taken_is_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pty_door, "MOST", 100)
    served = Served(tmp_path)
    file, sent = client(served.door.path), 0
    for _ in range(20):
        with suppress(BlockingIOError):
            while True:
                sent += os.write(file, bytes(1000))
        served.passes("1 ms")
    assert 0 < served.line.waiting < 100 + 4096 and served.line.sent + served.line.waiting < sent
    served.door.close()
    assert 0 < served.door.unheard <= sent - served.line.sent - served.line.waiting
    os.close(file)


def test_a_name_that_is_taken_is_refused(tmp_path: Path) -> None:
    link = tmp_path / "dsp"
    link.write_text("mine")
    with pytest.raises(OutsideError, match=r"dsp: File exists; give the link another name"):
        Served(tmp_path, link)
    assert link.read_text() == "mine"
