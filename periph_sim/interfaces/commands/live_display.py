"""The display of a live session of `periph-sim serve`, in the terminal or on a page."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, ExitStack
from types import TracebackType

import click

from ...core.records import Recorder
from ...core.time import Timebase
from ...outside.live.loop import Door
from ...outside.live.pacing import Pacer
from ...outside.live.view.browser import Browser
from ...outside.live.view.last_round import LastRound
from ...outside.live.view.status import Board, Status
from ...outside.serial_line import SerialLine
from ...outside.session import Session

WIRES = ("SCL", "SDA", "RX", "TX")


class LiveDisplay(AbstractContextManager["LiveDisplay"]):
    """The display of a live session, as a context manager. If it ends without an error, it shows the last snapshot.

    in_terminal: True to display the session in the terminal.
    address: the address and the port of the page that displays the session; None for no page.
    url: the URL of the page; "" without a page.

    Raise OutsideError if the port of the page is in use.
    """

    def __init__(self, in_terminal: bool, address: tuple[str, int] | None) -> None:
        self.url = ""
        self._in_terminal = in_terminal
        self._is_viewed = False  # True while the terminal displays the session
        self._is_shown = in_terminal or address is not None
        self._board = Board()
        self._wave = None if address is None else LastRound(WIRES)
        self._status: Status | None = None
        self._parts = ExitStack()  # closes the page and the view in the terminal
        if address is not None:
            browser = Browser(self._board, address[1], address[0])
            self._parts.callback(browser.close)
            self.url = browser.url

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if error is None and self._status is not None:
            self._status.close()
        self._board.close()
        self._parts.close()

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        """Subscribe the waveform of the page to the records of the session. A Scene calls this method once."""
        if self._wave is not None:
            self._wave.subscribe(recorder, timebase)

    def doors(self, session: Session, line: SerialLine | None, pacer: Pacer, where: str) -> Sequence[Door]:
        """Return the doors (objects that the session's loop serves) for the display; none without a display.

        line: the serial line of the session; None if the session serves the I2C bus.
        where: the path of the port that other programs open; it is displayed.
        """
        if not self._is_shown:
            return ()
        self._status = Status(session, line, pacer, self._board, where, self._wave)
        return (self._status,)

    def begin(self) -> None:
        """Begin the display in the terminal. Call this method after all output that precedes the session."""
        if self._in_terminal:
            from .live_view import start_view  # imported here, because only the terminal needs Rich

            self._parts.callback(start_view(self._board).join)
            self._is_viewed = True

    def say(self, sentence: str) -> None:
        """Display a sentence that the session's port reports, for example about a client."""
        if self._status is not None:
            self._status.say(sentence)
        if not self._is_viewed:
            click.echo(sentence, err=True)
