"""A serial line over TCP: clients of pyserial and plain sockets that vanish, connect second or send garbage."""

from __future__ import annotations

import errno
import socket
import struct
import sys
import threading
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.outside import OutsideError
from periph_sim.outside.live import backlog
from periph_sim.outside.live.port_door import PortDoor
from tests.outside.live.echo import Echo

serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")

from periph_sim.outside.live import rfc2217_door  # noqa: E402
from periph_sim.outside.live.rfc2217_door import ManagedPort, Rfc2217Door  # noqa: E402
from tests.outside.sessions import refuses  # noqa: E402


class Served(Echo):
    """A case with a TCP port, advanced by the test, or by a thread while a blocking client is connected."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.said: list[str] = []
        self.door = Rfc2217Door(self.line, 115_200, "8n1", 0, notify=self.said.append)
        self.address = ("127.0.0.1", int(self.door.path.rpartition(":")[2]))

    def client(self) -> socket.socket:
        """Connect a client without Telnet; the Telnet negotiation is read and ignored."""
        came = socket.create_connection(self.address)
        self.passes("2 ms")
        assert came.recv(100).startswith(b"\xff")
        came.setblocking(False)
        return came

    def answer(self, client: socket.socket, data: bytes) -> bytes:
        """Return what the client reads 2 ms after it has sent these bytes."""
        client.send(data)
        self.passes("2 ms")
        return client.recv(4096)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    one = Served(tmp_path)
    yield one
    one.door.close()


def test_the_line_has_the_rate_and_format_of_the_client(tmp_path: Path) -> None:
    ended, ready = threading.Event(), threading.Event()
    made: list[Served] = []

    def serve() -> None:
        """Advance the session in this thread, because firmware must stay in the thread that started it."""
        made.append(Served(tmp_path))
        ready.set()
        while not ended.wait(0.0005):
            made[0].passes("1 ms")
        made[0].passes("2 ms")
        made[0].door.close()

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        assert ready.wait(30)
        with serial.serial_for_url(made[0].door.path, 115_200, timeout=30) as port:
            port.write(b"hello\xff")
            assert port.read(6) == b"ifmmp\x00"
            port.baudrate = 9600
            port.parity, port.stopbits = "E", 2
            assert made[0].line._bit == Fraction(made[0].session.ticks_per_second, 9600)
            assert (made[0].line._format.parity, made[0].line._format.stop) == ("even", 2)
            port.parity, port.stopbits = "M", 1
            assert (made[0].line._format.address, made[0].line._ninth) == (True, 1)
            with pytest.raises(ValueError, match="mark"):
                port.parity = "mark"
            port.baudrate, port.parity, port.stopbits = 115_200, "N", 1
            port.write(b"a")
            assert port.read() == b"b"
            port.break_condition = True
            port.break_condition = False
    finally:
        ended.set()
        thread.join()
    assert [sentence.split()[-1] for sentence in made[0].said] == ["connected", "left"]
    assert made[0].session.level("RX") == 1
    assert made[0].session.scene.measured.value_of("dsp.SCI-A", "SCIRXST.BRKDT") == 1


def test_a_client_without_telnet_uses_the_initial_rate_and_format(served: Served) -> None:
    with served.client() as client:
        assert served.answer(client, b"abc\xff\xff") == b"bcd\x00"
    served.passes("2 ms")
    assert [sentence.split()[-1] for sentence in served.said] == ["connected", "left"]


@pytest.mark.parametrize("system", ["this system", "one without poll"])
def test_a_second_client_is_rejected_with_the_name_of_the_first(
    served: Served, system: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if system == "one without poll":
        monkeypatch.delattr(rfc2217_door.select, "poll", raising=False)
    with served.client() as first, socket.create_connection(served.address) as second:
        served.passes("2 ms")
        name = "{}:{}".format(*first.getsockname())
        assert second.recv(100).decode() == f"this SCI has a client already, {name}; close that first\r\n"
        assert second.recv(100) == b""
        turned_away = "client {}:{} was rejected".format(*second.getsockname())
        assert served.said[1:] == [f"{turned_away}: client {name} has the line"]
        assert served.answer(first, b"a") == b"b"
    served.passes("2 ms")
    with served.client() as third:
        assert served.answer(third, b"x") == b"y"


@pytest.mark.parametrize("garbage", [b"\xff\xf0", b"\xff\xfa\x2c\x03\x77\xff\xf0", b"\xff\xfa" + b"x" * 300])
def test_garbage_only_disconnects_its_client(served: Served, garbage: bytes) -> None:
    with served.client() as client:
        client.send(b"ab" + garbage)
        served.passes("5 ms")
        assert "was disconnected" in served.said[-1]
        with pytest.raises(ConnectionError):
            while client.recv(100):
                pass
            raise ConnectionError
    assert served.line.sent == 2
    with served.client() as client:
        assert served.answer(client, b"c").endswith(b"d")


@pytest.mark.parametrize(("length", "stays"), [(256, True), (257, False)])
def test_a_telnet_option_has_at_most_256_bytes(served: Served, length: int, stays: bool) -> None:
    with served.client() as client:
        client.send(b"\xff\xfa" + b"x" * length)
        served.passes("2 ms")
        assert ("was disconnected" in served.said[-1]) != stays


@pytest.mark.parametrize(("most", "stays"), [(300, True), (299, False)])
def test_unread_answers_to_telnet_options_have_a_limit(
    served: Served, monkeypatch: pytest.MonkeyPatch, most: int, stays: bool
) -> None:
    with served.client() as client:
        monkeypatch.setattr(rfc2217_door, "MOST", most)
        client.send(b"\xff\xfd\x63" * 100)  # each has an answer of three bytes
        served.passes("2 ms")
        assert ("faster than it read the answers" in served.said[-1]) != stays


def test_a_closed_door_disconnects_its_client(served: Served) -> None:
    with served.client() as client:
        assert len(served.door.files()) == 2
        served.door.close()
        client.settimeout(10)
        assert client.recv(10) == b""
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(served.address)


def test_a_client_ahead_of_the_line_does_not_end_a_wait(served: Served) -> None:
    assert len(served.door.files()) == 1
    with served.client():
        assert len(served.door.files()) == 2
        served.line.write(bytes(backlog.MOST))
        assert len(served.door.files()) == 1


def test_bytes_of_a_client_that_vanishes_within_a_frame_are_sent(served: Served) -> None:
    client = served.client()
    client.send(b"abcdefghijkl" + b"\xff\xfa\x2c\x05\x05\xff\xf0")  # and a break that the client never ends
    served.passes("0.2 ms")
    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()  # closed by a TCP reset
    served.passes("10 ms")
    assert "vanished" in served.said[-1]
    assert served.line.sent == 12 and not served.line.waiting
    assert served.session.level("RX") == 1
    with socket.create_connection(served.address) as other:
        served.passes("1 ms")
        assert b"defghijklm" in other.recv(100)  # the vanished client had not read them


def test_a_client_a_megabyte_ahead_of_the_line_waits(served: Served) -> None:
    sent = 0
    with served.client() as client:
        for _ in range(20):
            try:
                while True:
                    sent += client.send(bytes(1 << 16))
            except BlockingIOError:
                served.passes("1 ms")
        held = served.line.waiting
        assert sent > held and 1 << 20 <= held <= (1 << 20) + 4096
        served.door.close()
        assert 0 < served.door.unread <= sent - served.line.sent - served.line.waiting


class Line:
    """A line that logs the calls of a port."""

    broken = False

    def __init__(self) -> None:
        self.calls: list[object] = []

    def set(self, baud: int, form: str) -> None:
        if baud > 1_000_000:
            raise OutsideError("too fast")
        self.calls.append((baud, form))

    def hold_break(self, on: bool) -> None:
        self.broken = on
        self.calls.append(on)

    def read(self) -> bytes:
        return b"old"


def test_rate_format_and_break_are_set_after_earlier_bytes(served: Served) -> None:
    line = Line()
    port = ManagedPort(line, 9600, "7e2", served.door)  # type: ignore[arg-type]
    port.before = lambda: line.calls.append("before")
    assert (port.baudrate, port.bytesize, port.parity, port.stopbits) == (9600, 7, "E", 2)
    port.baudrate = 19_200
    port.bytesize, port.parity, port.stopbits = 8, "N", 1
    port.break_condition = True
    assert port.break_condition
    changes = [(19_200, "7E2"), (19_200, "8E2"), (19_200, "8N2"), (19_200, "8N1"), True]
    assert line.calls == [one for change in changes for one in ("before", change)]
    with pytest.raises(OutsideError, match="too fast"):
        port.baudrate = 2_000_000
    assert (port.baudrate, port.bytesize, port.parity, port.stopbits) == (19_200, 8, "N", 1)
    served.door.back.add(b"older")
    port.reset_input_buffer()
    assert len(served.door.back) == 0
    modem = [port.rts, port.dtr, port.cts, port.dsr, port.ri, port.cd, port.xonxoff, port.rtscts]
    assert modem == [True] * 2 + [False] * 6


def test_a_port_that_is_taken_is_refused(served: Served, tmp_path: Path) -> None:
    refuses(
        r"port \d+ of 127.0.0.1: Address already in use; give another one",
        Rfc2217Door,
        served.line,
        115_200,
        "8n1",
        served.address[1],
    )
    refuses(
        r"port 0 of 192.0.2.1: Cannot assign requested address; give another one",
        Rfc2217Door,
        served.line,
        115_200,
        "8n1",
        0,
        "192.0.2.1",
    )  # an address reserved by RFC 5737


def test_without_pyserial_the_error_names_the_package(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    way_out = r"needs pyserial: pip install 'periph-sim\[live\]'"
    refuses(f"RFC 2217 {way_out}", Rfc2217Door, served.line, 115_200, "8n1", 0)
    refuses(f"a real port {way_out}", PortDoor, served.line, "/dev/none", 115_200, "8n1")


def test_a_disconnected_client_is_replaced_on_a_system_without_poll(served: Served, monkeypatch) -> None:
    monkeypatch.delattr(rfc2217_door.select, "poll", raising=False)
    served.client().close()
    with socket.create_connection(served.address) as second:
        served.door.turn()
        assert [sentence.partition(" ")[2].split()[1] for sentence in served.said[1:]] == ["left", "connected"]
        assert served.answer(second, b"a").endswith(b"b")


@pytest.mark.posix("poll, which reports a disconnect while bytes are unread")
def test_a_disconnect_of_a_client_ahead_of_the_line_is_detected_when_the_next_connects(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last bytes of the first client are discarded unread; the next client is accepted."""
    first = served.client()
    monkeypatch.setattr(rfc2217_door, "MOST", 100)
    first.send(bytes(5000))
    served.door.turn()
    assert served.line.waiting == backlog.AT_ONCE
    first.close()
    with socket.create_connection(served.address) as second:
        served.door.turn()
        assert [sentence.partition(" ")[2].partition(" ")[2] for sentence in served.said[1:]] == [
            "left",
            f"connected; {backlog.AT_ONCE} unsent bytes of the one before are discarded",
        ]
        assert served.answer(second, b"a").endswith(b"b")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems name these options otherwise")
def test_a_client_on_a_computer_that_is_gone_is_disconnected_after_25_seconds(served: Served) -> None:
    """After 10 s of silence, three probes are sent 5 s apart."""
    with served.client():
        connection = served.door._client._connection
        options = (socket.TCP_KEEPIDLE, socket.TCP_KEEPINTVL, socket.TCP_KEEPCNT)
        idle, every, count = (connection.getsockopt(socket.IPPROTO_TCP, option) for option in options)
        assert connection.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE) == 1
        assert (idle, every, count, idle + every * count) == (10, 5, 3, 25)
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) == 1  # each byte is sent at once


def test_a_connection_that_the_system_cannot_accept_is_reported(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    listener = served.door._listener

    class Full:
        """A listener for which the system has no file left."""

        fileno, close = listener.fileno, listener.close

        def accept(self) -> None:
            raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(served.door, "_listener", Full())
    served.door.turn()
    assert served.said == ["a client could not be accepted: Too many open files"]
    monkeypatch.undo()
    served.client().close()
    assert served.said[1].endswith(" connected")
