"""The terminal on a case, with a test's console: greeting, keys, answers and the reason of its end."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue

import pytest

serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")

from serial.tools import miniterm  # noqa: E402

import periph_sim.live  # noqa: E402, F401
from periph_sim.outside.live.terminal import Terminal  # noqa: E402
from tests.outside.live.echo import written  # noqa: E402


class Console(miniterm.ConsoleBase):  # type: ignore[misc]
    """A console with keys pressed by a test, which can wait for text to be shown."""

    def __init__(self) -> None:
        self._keys: SimpleQueue[str] = SimpleQueue()
        self._written = threading.Condition()
        self._shown = ""
        self.press, self.getkey = self._keys.put, self._keys.get

    def write(self, text: str) -> None:
        with self._written:
            self._shown += text
            self._written.notify_all()

    def shows(self, text: str) -> bool:
        """Return True when this text is shown, or False if it is not within half a minute."""
        with self._written:
            return self._written.wait_for(lambda: text in self._shown, 30)


@pytest.fixture
def console(monkeypatch: pytest.MonkeyPatch) -> Console:
    one = Console()
    monkeypatch.setattr(miniterm, "Console", lambda: one)
    return one


@contextmanager
def talking(case: Path) -> Iterator[Terminal]:
    """Run a terminal in a thread until the end of the block."""
    with serial.serial_for_url(f"f28335://{case}?pace=1", baudrate=115_200, timeout=0.05) as port:
        terminal = Terminal(port, False, "lf", "default", "UTF-8")
        talk = threading.Thread(target=terminal.talk, args=("hello",))
        talk.start()
        yield terminal
        talk.join(30)
        assert not talk.is_alive()


def test_the_terminal_shows_a_greeting_and_the_answers_of_the_sci(console: Console, tmp_path: Path) -> None:
    with talking(written(tmp_path)) as terminal:
        assert console.shows("hello\r\n")
        console.press("a")
        assert console.shows("hello\r\nb")
        console.press("\x1d")
    assert terminal.failed == ""


def test_the_terminal_ends_after_the_thread_that_shows_answers(
    console: Console, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended, reader = [], miniterm.Miniterm.reader

    def slow(self: Terminal) -> None:
        reader(self)
        time.sleep(0.2)
        ended.append(True)

    monkeypatch.setattr(miniterm.Miniterm, "reader", slow)
    with talking(written(tmp_path)):
        assert console.shows("hello\r\n")
        console.press("\x1d")
    assert ended == [True]


def test_the_terminal_keeps_the_error_that_ended_the_session(console: Console, tmp_path: Path) -> None:
    case = written(tmp_path)
    (tmp_path / "echo_firmware.py").write_text("def main(dsp, settings):\n    dsp.compute(1000)\n    1 / 0\n")
    with talking(case) as terminal:
        assert console.shows("\r\nthe session has ended; press a key\r\n")
        console.press("a")
    assert "ZeroDivisionError at line 3 of echo_firmware.py" in terminal.failed
