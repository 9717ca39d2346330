"""A pseudo-terminal at an SCI: clients connect, set a rate and disconnect; no sent byte is lost."""

from __future__ import annotations

import errno
import os
import select
import sys
import termios
import tty
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.outside.live import pty_door
from periph_sim.outside.live.backlog import MOST
from periph_sim.outside.live.pty_door import PtyDoor
from tests.outside.live.echo import Echo
from tests.outside.sessions import refuses


class Served(Echo):
    """A case with a pseudo-terminal, advanced by the test."""

    def __init__(self, folder: Path, link: Path | None = None) -> None:
        super().__init__(folder)
        self.said: list[str] = []
        self.door = PtyDoor(self.line, 115_200, "8n1", link, self.said.append)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    one = Served(tmp_path)
    yield one
    one.door.close()


def client(path: str | Path) -> int:
    file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    tty.setraw(file)
    return file


def read_until(served: Served, file: int, end: bytes) -> bytes:
    """Return what a client reads until `end`, for which the system may need some time."""
    got = b""
    for _ in range(500):
        served.passes("1 ms")
        with suppress(BlockingIOError):
            got += os.read(file, 4096)
        if got.endswith(end):
            break
    return got


def test_clients_connect_and_disconnect(tmp_path: Path) -> None:
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


def test_bytes_wait_while_the_client_reads_nothing(served: Served) -> None:
    file, data, sent = client(served.door.path), bytes(range(256)) * 24, 0
    for _ in range(200):
        if sent < len(data):
            sent += os.write(
                file, data[sent : sent + 50]
            )  # with pauses, since the firmware's own rate is slightly lower
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


def test_the_terminal_is_watched_until_the_line_has_enough_to_send(served: Served) -> None:
    file = client(served.door.path)
    ready, _, _ = select.select(served.door.files(), [], [], 0)
    os.write(file, b"a")
    written, _, _ = select.select(served.door.files(), [], [], 1)
    assert (ready, written) == ([], list(served.door.files()))
    served.line.write(bytes(MOST))
    assert served.door.files() == []
    os.close(file)


def test_the_terminal_is_raw_without_settings_of_the_client(served: Served) -> None:
    """CR and LF are kept, Ctrl-C and Ctrl-D are bytes, and what the SCI sends is not echoed to it."""
    file = os.open(served.door.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    os.write(file, b"\r\n\x03\x04\x11\x09\x0c")
    assert read_until(served, file, b"\x0d") == b"\x0e\x0b\x04\x05\x12\x0a\x0d"
    served.passes("2 ms")
    assert served.line.sent == 7
    os.close(file)


def test_the_line_has_the_rate_of_the_client(served: Served) -> None:
    file = client(served.door.path)
    attributes = termios.tcgetattr(file)
    assert attributes[4:6] == [termios.B115200] * 2
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


def test_the_line_has_the_rate_at_which_the_client_sends(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    """A terminal may have two rates: this client receives at 9600 baud and sends at 19,200."""
    of_both = termios.tcgetattr(served.door._kept)
    split = [*of_both[:4], termios.B9600, termios.B19200, of_both[6]]
    monkeypatch.setattr(termios, "tcgetattr", lambda _: split)
    served.door.turn()
    assert served.line._bit == Fraction(served.session.ticks_per_second, 19_200)


def test_a_client_ahead_of_the_line_waits_and_unread_bytes_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
    assert 0 < served.door.unread <= sent - served.line.sent - served.line.waiting
    os.close(file)


def test_a_link_left_by_a_session_is_replaced_and_any_other_is_refused(tmp_path: Path) -> None:
    link, other = tmp_path / "dsp", Served(tmp_path)
    pts = Path(other.door.path).parent
    link.symlink_to(pts / "99999")  # left by a session that was killed
    served = Served(tmp_path, link)
    assert str(link.readlink()) == served.door.path
    refuses(f"dsp: it is a link to {served.door.path} already; give the link", Served, tmp_path, link)
    assert str(link.readlink()) == served.door.path
    link.unlink()
    link.symlink_to(other.door.path)  # meanwhile it belongs to another session
    served.door.close()
    assert str(link.readlink()) == other.door.path
    other.door.close()
    link.unlink()
    link.symlink_to(tmp_path / "gone")
    refuses(r"dsp: it is a link to .*/gone already", Served, tmp_path, link)
    assert link.is_symlink()


def test_a_link_that_may_not_be_replaced_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The link is to an earlier pseudo-terminal of the same number, in a folder that is not writable."""

    def unlink(path: Path, missing_ok: bool = False) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    link = tmp_path / "dsp"
    monkeypatch.setattr(os, "ttyname", lambda _: "/dev/pts/99999")
    monkeypatch.setattr(pty_door, "Openings", Unopened)
    monkeypatch.setattr(Path, "unlink", unlink)
    link.symlink_to("/dev/pts/99999")
    refuses("dsp: it is a link to /dev/pts/99999 already; give the link another name", pty_door.TerminalDoor, link)


class Unopened:
    """A stand-in for `Openings`, since the pseudo-terminal does not exist."""

    def __init__(self, path: str) -> None:
        assert path == "/dev/pts/99999"

    def close(self) -> None:
        """Do nothing, since no file is open."""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux's inotify reports who opens a terminal")
def test_all_bytes_written_before_a_disconnect_are_sent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The line accepts 100 of 3000 bytes while a client is connected; it writes between two turns and disconnects."""
    monkeypatch.setattr(pty_door, "MOST", 100)
    served = Served(tmp_path)
    file = client(served.door.path)
    served.door.turn()
    assert os.write(file, bytes(3000)) == 3000
    os.close(file)
    served.door.turn()
    assert served.line.waiting == 3000
    served.door.close()
    assert served.door.unread == 0


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux's inotify reports who opens a terminal")
def test_unsent_bytes_of_a_disconnected_client_do_not_delay_the_next_client(served: Served) -> None:
    file = client(served.door.path)
    for _ in range(20):
        os.write(file, b"x" * 1000)
        served.door.turn()
    os.close(file)
    served.passes("5 ms")
    assert served.line.waiting > 19_000
    file = client(served.door.path)
    served.passes("1 ms")
    os.write(file, b"hello")
    assert read_until(served, file, b"ifmmp").strip(b"y") == b"ifmmp" and not served.line.waiting
    (sentence,) = served.said
    assert sentence.startswith("a client connected: 19") and sentence.endswith(
        "unsent bytes of the one before are discarded"
    )
    os.close(file)
    file = client(served.door.path)
    os.write(file, b"short")
    served.door.turn()
    os.close(file)
    served.door.turn()
    file = client(served.door.path)  # at once, so the five bytes of the previous client are still sent
    assert read_until(served, file, b"tipsu") == b"tipsu" and len(served.said) == 1
    os.close(file)
