"""An I2CDriver door in a session's loop: commands from its pseudo-terminal advance time, and pacing continues."""

from __future__ import annotations

import os
import sys
import tty
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.interfaces.commands.live_case import files_of
from periph_sim.outside import Session
from periph_sim.outside.live import i2cdriver_door
from periph_sim.outside.live.case_for_line import case_for_bus
from periph_sim.outside.live.i2cdriver_door import I2cDriverDoor
from periph_sim.outside.live.loop import Loop
from periph_sim.outside.live.pacing import Pacer
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene
from tests.outside.live.registers import written
from tests.outside.sessions import Records, refuses

REGISTER = bytes([ord("r"), 0x50, 1, 2])  # read two registers from 1 on


class Served:
    """A client at the pseudo-terminal, and the loop, advanced by the test."""

    def __init__(self, folder: Path, log: Path | None = None, pace: int = 0) -> None:
        self.records = Records()
        self.session = Session(case_for_bus(written(folder)), log=log, subscribe=self.records.subscribe)
        self.door = I2cDriverDoor(self.session)
        self.file = os.open(self.door.path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        os.set_blocking(self.file, False)
        self.now = 0.0
        self.pacer = Pacer(self.session.ticks_per_second, Fraction(pace), clock=lambda: self.now)
        self.loop = Loop(self.session, self.pacer, [self.door])

    def passes(self, length: str) -> None:
        self.loop.run(self.session.now + self.session.ticks(length))

    def answer(self, command: bytes) -> bytes:
        """Return what the client reads 2 ms after this command."""
        os.write(self.file, command)
        self.passes("2 ms")
        return os.read(self.file, 10)

    def next_client(self) -> None:
        """Disconnect the client, and connect another one."""
        os.close(self.file)
        self.passes("1 ms")
        self.file = os.open(self.door.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self.passes("1 ms")

    def close(self) -> None:
        os.close(self.file)
        self.door.close()


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    one = Served(tmp_path)
    yield one
    one.close()


def test_commands_that_are_never_read_are_counted(tmp_path: Path) -> None:
    served = Served(tmp_path)
    os.write(served.file, REGISTER)
    served.door.close()
    os.close(served.file)
    assert served.door.unread == len(REGISTER)


def test_commands_take_simulated_time_and_replace_the_controller_of_the_case(tmp_path: Path, log: Path) -> None:
    served = Served(tmp_path, log)
    served.passes("2 ms")
    os.write(served.file, REGISTER)
    before = served.session.now
    served.door.turn()
    assert served.session.now - before > served.session.ticks("500 us")  # six bytes at 100 kHz
    assert os.read(served.file, 10) == b"\x22\x33"
    served.passes("1 ms")
    result = served.session.finish()
    served.close()
    assert result.notes == ["SDA and SCL are driven from outside, in place of [controller]"]
    assert [(one.name, one.verdict) for one in result.budgets] == [("all rounds", "not judged"), ("work", "pass")]
    assert (
        result.wire_bytes == 5 and result.counts["rounds"] == 0
    )  # the case reads from register 0, and this read was from 1 on
    files, target = files_of(log, str(tmp_path / "again"))
    target.write_text(files[target])
    again = Records()
    replayed = Scene(load(target), again.subscribe).run()
    assert (replayed.notes, replayed.budgets, replayed.wire_bytes) == (result.notes, result.budgets, 5)
    assert again.kept == served.records.kept


def test_the_loop_waits_for_the_clock_after_commands_of_a_client(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    served = Served(tmp_path, pace=1)
    begin = served.session.now

    def select(files: list[int], _: object, __: object, left: float) -> tuple[list[int], list[int], list[int]]:
        """Deliver commands in the middle of the second step that take several steps."""
        if served.now == 0:
            served.now = 0.0005
            os.write(served.file, REGISTER * 3)
            return files, [], []
        served.now += left
        return [], [], []

    monkeypatch.setattr("periph_sim.outside.live.loop.select.select", select)
    served.passes("2 ms")
    taken = (served.session.now - begin) / served.session.ticks_per_second
    assert taken > 0.0025 and served.now == pytest.approx(
        taken - 0.001, abs=1e-5
    )  # the clock starts with the first step
    assert served.pacer.worst == 0
    served.close()


def test_commands_of_a_client_are_not_read_while_it_reads_no_answers(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(i2cdriver_door, "MOST", 100)
    for waiting, waited_for in ((99, 1), (100, 0)):
        served.door.back.add(bytes(waiting))
        assert len(served.door.files()) == waited_for
        served.door.back.clear()
    asked = b"eA" * 40_000
    sent, got = 0, b""
    for _ in range(60):
        with suppress(BlockingIOError):
            sent += os.write(served.file, asked[sent:])
        served.door.turn()
    assert sent < len(asked) and len(served.door.back) < 3 * 4096 and served.door.files() == []
    while len(got) < len(asked) // 2:
        try:
            got += os.read(served.file, 4096)
        except BlockingIOError:
            sent += os.write(served.file, asked[sent:]) if served.door.files() else 0
        served.door.turn()
    assert got == b"A" * 40_000 and not served.door.back.lost


def test_a_missing_wire_and_an_unknown_measure_are_refused(tmp_path: Path) -> None:
    refuses("SCL of case registers does not lead outside", I2cDriverDoor, Session(load(written(tmp_path)), ("SDA",)))
    refuses("cpu lode", case_for_bus, written(tmp_path), ("budget.1.measure=cpu lode",), error=BadCase)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux's inotify reports who opens a terminal")
@pytest.mark.parametrize("left", [b"r\x50\x01", b"\xc3\x01", b"c", b"eA" * 5 + b"s"])
@pytest.mark.parametrize("unread", [True, False])
def test_an_incomplete_command_of_a_disconnected_client_is_discarded(served: Served, left: bytes, unread: bool):
    served.passes("2 ms")
    os.write(served.file, left)
    if not unread:
        served.passes("1 ms")
    served.next_client()
    assert served.answer(b"r\x50\x03\x01") == b"\x44" and not served.door.adapter.capturing


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux's inotify reports who opens a terminal")
def test_answers_to_a_disconnected_client_are_discarded_and_a_closed_door_is_removed(tmp_path: Path) -> None:
    """The answers are 2000 statuses of 80 bytes, more than the buffer of a pseudo-terminal holds."""
    served = Served(tmp_path)
    os.write(served.file, b"?" * 2000)
    served.passes("1 ms")
    assert len(served.door.back) > 0
    served.next_client()
    assert len(served.door.back) == 0
    with pytest.raises(BlockingIOError):
        os.read(served.file, 10)
    served.close()
    assert not Path(served.door.path).exists()
