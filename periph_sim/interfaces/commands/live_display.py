"""The display of a live session of `periph-sim serve`, in the terminal or on a page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from types import TracebackType

    from ...core.records import Recorder
    from ...core.time import Timebase
    from ...outside.live.loop import Door
    from ...outside.live.pacing import Pacer
    from ...outside.live.view.browser import Browser
    from ...outside.live.view.last_round import LastRound
    from ...outside.live.view.status import Board, Status, ViewDoor
    from ...outside.serial_line import SerialLine
    from ...outside.session import Session
    from .live_view import LiveView

WIRES = ("SCL", "SDA", "RX", "TX")


class LiveDisplay:
    """The display of a live session, as a context manager. At its end, it displays the session's last snapshot.

    in_terminal: True to display the session in the terminal.
    address: the address and the port of the page that displays the session; None for no page.
    url: the URL of the page; "" without a page.

    Raise OutsideError if the port of the page is in use.
    """

    def __init__(self, in_terminal: bool, address: tuple[str, int] | None) -> None:
        self.url = ""
        self._in_terminal = in_terminal
        self._board: Board | None = None
        self._wave: LastRound | None = None
        self._door: ViewDoor | None = None
        self._status: Status | None = None
        self._browser: Browser | None = None
        self._view: LiveView | None = None
        if in_terminal or address is not None:
            from ...outside.live.view.status import Board

            self._board = Board()
        if address is not None:
            from ...outside.live.view.browser import Browser
            from ...outside.live.view.last_round import LastRound

            assert self._board is not None
            self._wave = LastRound(WIRES)
            self._browser = Browser(self._board, address[1], address[0])
            self.url = self._browser.url

    def __enter__(self) -> LiveDisplay:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if error is None and self._door is not None:
            self._door.close()
        for part in (self._board, self._view, self._browser):
            if part is not None:
                part.close()

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        """Subscribe the waveform of the page to the records of the session. A Scene calls this method once."""
        if self._wave is not None:
            self._wave.subscribe(recorder, timebase)

    def doors(self, session: Session, line: SerialLine | None, pacer: Pacer, where: str) -> Sequence[Door]:
        """Return the doors (objects that the session's loop serves) for the display; none without a display.

        line: the serial line of the session; None if the session serves the I2C bus.
        where: the path of the port that other programs open; it is displayed.
        """
        if self._board is None:
            return ()
        from ...outside.live.view.status import Status, ViewDoor

        self._status = Status(session, line, pacer, where, self._wave)
        self._door = ViewDoor(self._status, self._board)
        return (self._door,)

    def begin(self) -> None:
        """Begin the display in the terminal. Call this method after all output that precedes the session."""
        if self._in_terminal:
            from .live_view import LiveView

            assert self._board is not None
            self._view = LiveView(self._board)

    def say(self, sentence: str) -> None:
        """Display a sentence that the session's port reports, for example about a client."""
        if self._status is not None:
            self._status.say(sentence)
        if self._view is None:
            click.echo(sentence, err=True)
