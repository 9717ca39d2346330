"""The host unit: its frames equal those of a case's [host]; datagrams, valid and invalid; ports with simulated time."""

from __future__ import annotations

import os
import socket
import struct
import sys
from contextlib import AbstractContextManager
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.imu.host_frame import Encoding
from periph_sim.imu.host_frames import frames_of
from periph_sim.imu.host_unit import FlightFrames, UdpFrames, pacer_for, send_frames
from periph_sim.outside import OutsideError
from periph_sim.outside.live.pacing import Pacer
from tests.outside.live.echo import written

PERIOD = Fraction(20, 1000)
FLIGHT = """\
time [s],phi [deg],theta [deg],psi [deg],ax [g],ay [g],az [g]
0,0,0,170,0,0,0
0.1,30,10,-170,0.1,-0.2,0
0.2,0,0,0,0,0,0.5
"""


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    path = tmp_path / "flight.csv"
    path.write_text(FLIGHT)
    return path


def test_a_flight_gives_the_frames_of_a_host_in_a_case(flight: Path) -> None:
    source = FlightFrames(flight, Encoding(), PERIOD)
    same = frames_of({"kind": "flight", "file": str(flight)}, Encoding(), Fraction(0), PERIOD)
    frames = [source.frame(number) for number in range(11)]
    assert frames == [struct.pack("<6h", *same(number)) for number in range(11)]
    assert len(set(frames)) == 11
    assert [source.over(number) for number in (10, 11)] == [False, True]


class Datagrams(AbstractContextManager):
    def __init__(self, order: str = "little") -> None:
        self.said: list[str] = []
        self.source = UdpFrames("127.0.0.1", 0, Encoding(), order, self.said.append)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, data: bytes) -> None:
        self._socket.sendto(data, ("127.0.0.1", self.source.port))

    def __exit__(self, *_: object) -> None:
        self.source.close()
        self._socket.close()


@pytest.mark.parametrize(("order", "mark"), [("little", "<"), ("big", ">")])
def test_datagrams_of_simulink_are_converted_to_frames(order: str, mark: str) -> None:
    counts = (100, -200, 300, 1000, 0, -1)
    values = (0.01, -0.02, 0.03, 1.0, 0.0, -0.001)
    with Datagrams(order) as udp:
        assert udp.source.frame(0) is None and udp.source.held == 0
        assert not udp.source.over(10**6), "datagrams may come forever"
        for data in (struct.pack(f"{mark}6d", *values), struct.pack(f"{mark}6f", *values), struct.pack("<6h", *counts)):
            udp.send(b"older")
            udp.send(data)
            assert udp.source.frame(1) == struct.pack("<6h", *counts)
        assert udp.source.frame(2) == struct.pack("<6h", *counts)
        assert (udp.source.held, udp.source.refused) == (1, 3)
        assert udp.said == ["a datagram was refused: it has 5 bytes; expected six doubles (48 bytes), six singles (24) "
                            "or a frame as it is (12)"]  # fmt: skip


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "it has 0 bytes"),
        (bytes(60_000), "it has 60000 bytes"),
        (struct.pack("<6d", 0, 0, 0, float("nan"), 0, 0), "a value is infinite or no number"),
        (struct.pack("<6f", 0, 0, 9.0, 0, 0, 0), "psi is 9, which is 90000 counts"),
        (struct.pack("<6d", 0, 0, 1e308, 0, 0, 0), "psi is 1e+308, which is inf counts"),
    ],
)
def test_an_invalid_datagram_is_ignored(data: bytes, sentence: str) -> None:
    with Datagrams() as udp:
        udp.send(bytes(48))
        udp.send(data)
        assert udp.source.frame(0) == bytes(12)
        assert udp.source.refused == 1 and sentence in udp.said[0]


def test_a_udp_port_that_is_taken_is_refused() -> None:
    with Datagrams() as udp, pytest.raises(OutsideError, match=r"port \d+ of 127.0.0.1: Address already in use"):
        UdpFrames("127.0.0.1", udp.source.port, Encoding(), "little", print)


def test_a_closed_source_leaves_its_udp_port_free() -> None:
    source = UdpFrames("127.0.0.1", 0, Encoding(), "little", print)
    source.close()
    UdpFrames("127.0.0.1", source.port, Encoding(), "little", print).close()


@pytest.mark.skipif(sys.platform != "linux", reason="open files are listed in /proc")
def test_a_refused_port_leaves_no_file_open() -> None:
    with Datagrams() as udp:
        before = len(os.listdir("/proc/self/fd"))
        with pytest.raises(OutsideError) as refused:
            UdpFrames("127.0.0.1", udp.source.port, Encoding(), "little", print)
        assert len(os.listdir("/proc/self/fd")) == before
        assert refused.value is not None  # the exception keeps the frames alive in which the socket was made


def test_frames_are_sent_at_their_rate_in_simulated_time(flight: Path, tmp_path: Path) -> None:
    serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")
    import periph_sim.live

    assert periph_sim.live.PACKAGE in serial.protocol_handler_packages
    with serial.serial_for_url(f"f28335://{written(tmp_path)}?pace=0", 115_200) as port:
        pacer = pacer_for(port)
        sent = send_frames(port, FlightFrames(flight, Encoding(), PERIOD), PERIOD, pacer)
        assert (sent.frames, sent.came) == (11, 120)  # the answer to the last frame comes later
        assert 0.2 < port.clock() < 0.203
        assert pacer.worst < 1e-6


class Port:
    """A port whose clock advances by the timeout of each read, which returns 3 bytes."""

    def __init__(self) -> None:
        self.now = self.timeout = 0.0
        self.reads: list[int] = []
        self.calls: list[str] = []

    def read(self, count: int) -> bytes:
        self.reads.append(count)
        self.now += self.timeout
        return b"abc"

    def write(self, data: bytes) -> None:
        self.calls.append(data.hex())

    def flush(self) -> None:
        self.calls.append("flush")


class Numbers:
    """Six frames of one byte, of which number 1 is missing."""

    def frame(self, number: int) -> bytes | None:
        return None if number == 1 else bytes([number])

    def over(self, number: int) -> bool:
        return number >= 6


@pytest.mark.parametrize(
    ("frames", "stops_at", "written", "due"),
    [
        (None, 99.0, ["00", "02", "03", "04", "05"], [0, 40, 60, 80, 100]),
        (2, 99.0, ["00", "02"], [0, 40]),
        (None, 0.03, ["00", "02"], [0, 40]),  # stopped while waiting: the frame that is due is still sent
    ],
)
def test_frames_are_sent_when_due_and_the_port_is_read_meanwhile(
    frames: int | None, stops_at: float, written: list[str], due: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    port, reached = Port(), []
    pacer = Pacer(10**9, Fraction(1), clock=lambda: port.now)
    monkeypatch.setattr(pacer, "reached", lambda tick: reached.append(tick // 10**6))
    sent = send_frames(port, Numbers(), PERIOD, pacer, frames, lambda: port.now >= stops_at)
    assert port.calls == [*written, "flush"] and reached == due
    assert (sent.frames, sent.came) == (len(written), 3 * len(port.reads))
    assert set(port.reads) == {4096} and port.now == pytest.approx(due[-1] / 1000)
