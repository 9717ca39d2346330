"""A door at a real port, here a pseudo-terminal: opened by another program, unplugged within a frame, plugged again."""

from __future__ import annotations

import io
import os
import select
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")

from periph_sim.outside import OutsideError, Session  # noqa: E402
from periph_sim.outside.live import port_door  # noqa: E402
from periph_sim.outside.live.port_door import (  # noqa: E402
    GONE,
    PortDoor,
    in_our_words,
)
from tests.outside.live.echo import Echo, written  # noqa: E402
from tests.outside.sessions import refuses  # noqa: E402


class Cable:
    """A cable, with its far end and a name that is the same whenever it is plugged in."""

    def __init__(self, name: Path) -> None:
        self.name = name
        self.plug()

    def plug(self) -> None:
        self.far, near = os.openpty()
        tty.setraw(near)
        os.set_blocking(self.far, False)
        self.name.symlink_to(os.ttyname(near))
        self._near = near

    def unplug(self) -> None:
        self.name.unlink()
        os.close(self.far)
        os.close(self._near)


def send(cable: Cable, door: PortDoor, data: bytes) -> None:
    """Send data from the far end, and wait until the system has delivered it."""
    os.write(cable.far, data)
    while door._port.in_waiting < len(data):
        select.select(door.files(), [], [], 60)


def got(cable: Cable, count: int) -> bytes:
    came = b""
    while len(came) < count and select.select([cable.far], [], [], 60)[0]:
        came += os.read(cable.far, count)
    return came


class Plugged(Echo):
    """A session whose line is connected to a cable."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.cable, self.said, self.now = Cable(folder / "ttyUSB0"), [], 0.0
        self.door = PortDoor(self.line, str(self.cable.name), 115_200, "8n1", self.said.append, lambda: self.now)


@pytest.fixture
def plugged(tmp_path: Path) -> Iterator[Plugged]:
    one = Plugged(tmp_path)
    yield one
    one.door.close()
    one.cable.unplug()


def test_a_port_that_is_unplugged_within_a_frame_is_reported_and_opened_again(plugged: Plugged) -> None:
    cable, said, line, door = plugged.cable, plugged.said, plugged.line, plugged.door
    refuses(
        "ttyUSB0: another program has it open; close it there first", PortDoor, line, str(cable.name), 115_200, "8n1"
    )
    plugged.passes("1 ms")
    send(cable, door, b"abc")
    plugged.passes("0.1 ms")
    assert (line.sent, line.received) == (2, 0)  # the first is being sent, and the second is next
    cable.unplug()
    plugged.passes("1.2 ms")
    assert said == [f"{cable.name}: {GONE}; it will be opened again once it is back"] and door.files() == []
    plugged.now = 1.5
    plugged.passes("1.2 ms")
    cable.plug()
    plugged.passes("1.2 ms")
    assert len(said) == 1
    plugged.now = 2.6
    plugged.passes("1.2 ms")
    send(cable, door, b"d")
    plugged.passes("1.2 ms")
    assert said[1:] == [f"{cable.name} is back"]
    assert (line.sent, line.received, got(cable, 4)) == (4, 4, b"bcde")


def test_an_unplugged_port_is_not_opened_again_for_a_second(plugged: Plugged) -> None:
    """
    s      0             0.99      1.0
    port   gone, there   there     there
    door   closed        closed    open
    """
    plugged.cable.unplug()
    plugged.door.turn()
    plugged.cable.plug()
    for plugged.now, is_open in ((0.0, False), (0.99, False), (1.0, True)):
        plugged.door.turn()
        assert bool(plugged.door.files()) == is_open


def test_a_port_without_a_file_number_as_on_windows_is_polled_at_each_step(plugged: Plugged, monkeypatch) -> None:
    door = plugged.door
    send(plugged.cable, door, b"y")
    monkeypatch.setattr(door._port, "fileno", io.RawIOBase().fileno)
    assert door.files() == []
    door.turn()
    assert plugged.line.waiting == 1
    monkeypatch.undo()


def test_bytes_beyond_the_capacity_of_the_line_stay_in_the_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The line accepts 100 bytes: the next one stays in the system until one is sent, and is counted if it is lost."""
    monkeypatch.setattr(port_door, "MOST", 100)
    plugged = Plugged(tmp_path)
    cable, line, door = plugged.cable, plugged.line, plugged.door
    line.write(b"x" * 99)
    assert len(door.files()) == 1
    send(cable, door, b"y")
    door.turn()
    assert (line.waiting, door.files()) == (100, [])
    os.write(cable.far, b"z")
    while not door._port.in_waiting:
        select.select([door._port.fileno()], [], [], 60)
    door.turn()
    assert line.waiting == 100
    door.close()
    assert door.unread == 1
    cable.unplug()


@pytest.mark.parametrize(
    ("port", "sentence"),
    [
        ("/dev/none", "/dev/none: there is no such port"),
        ("{folder}", "{folder}: it is no serial port"),
        ("{folder}/plain", "{folder}/plain: it is no serial port"),
    ],
)
def test_an_invalid_port_is_refused_in_one_sentence(port: str, sentence: str, tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    session = Session(written(tmp_path), ("RX", "TX"))
    with pytest.raises(OutsideError) as refused:
        PortDoor(session.serial("scia"), port.format(folder=tmp_path), 115_200, "8n1")
    assert str(refused.value) == sentence.format(folder=tmp_path)


def test_errors_of_pyserial_are_reworded() -> None:
    said = [
        (serial.SerialException("write failed: [Errno 5] Input/output error"), GONE),
        (serial.SerialException("device reports readiness to read but returned no data (device ...)"), GONE),
        (OSError(5, "Input/output error"), GONE),
        (PermissionError(13, "Permission denied"), "no permission to open it; join the group"),
        (serial.SerialException("its own words"), "its own words"),
    ]
    assert all(in_our_words("P", error).startswith(f"P: {words}") for error, words in said)
    with pytest.raises(serial.SerialException) as refused:
        serial.serial_for_url("socket://127.0.0.1:1")
    assert in_our_words("there", refused.value) == "there: no server is listening; start it first"
