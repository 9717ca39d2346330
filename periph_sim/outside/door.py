"""Wires of a scene that lead outside. The outside moves them at given ticks, and changes of our pulls are reported.

    put(tick, levels) --event of that tick--> pins --> wires <-- units, chips
                       on_instant <-----------'        '--our pulls-> changes

Our pulls are those of the case's units, chips and agents. Pulls of the outside are not reported. All lines that move in
one tick move together, regardless of the order of the calls of `put`.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple, final

from ..core.agent import Agent, Event
from ..core.kernel import Kernel
from ..core.wire import Wire
from ..form.c_types import Text

if TYPE_CHECKING:
    from ..core.wire import Pin

WHO = "outside"  # name of the outside in records, and as a party on the wires


class Change(NamedTuple):
    """Our side has released a line (level 1) or pulled it low (level 0) at tick `at`."""

    at: int
    line: str
    level: int


@final
class Door(Agent):
    """The pins of the outside on the wires.

    on_instant: a function that is called for each tick in which the outside moves lines, with the tick and the levels
        of these lines.
    """

    def __init__(
        self, kernel: Kernel, wires: Mapping[str, Wire], on_instant: Callable[[int, Mapping[str, int]], None]
    ) -> None:
        self._kernel = kernel
        self._wires = dict(wires)
        self._names = list(wires)
        self._pins = {name: wire.attach(WHO) for name, wire in wires.items()}
        self._on_instant = on_instant
        self._put: dict[int, dict[str, int]] = {}
        self._event: Event | None = None  # the kernel's event for the first entry of `_put`
        self._levels = {name: self.held(name) for name in wires}
        self._changes: list[Change] = []
        for line, wire in enumerate(wires.values()):
            wire.watch_pulls(self, line)

    def put(self, at: int, name: Text, level: int) -> None:
        """Schedule a move of a line at tick `at`, which must not be past.

        If a line is moved several times in one tick, only the last call has an effect.
        """
        self._put.setdefault(at, {})[name] = level

    def plan(self) -> None:
        """Schedule the kernel's event for the first move. Call this just before time advances."""
        if self._put:
            self._event = self._kernel.schedule(min(self._put), self)

    def withdraw(self) -> None:
        """Cancel the event that `plan` has scheduled, so that the kernel has only events of the case."""
        if self._event is not None:
            self._kernel.cancel(self._event)
            self._event = None

    def act(self, tag: int) -> None:
        now = self._kernel.now
        levels = self._put.pop(now)
        self._on_instant(now, levels)
        for name, level in levels.items():
            self._drive(name, level)
        self._event = None
        self.plan()

    def _drive(self, name: Text, level: int) -> None:
        pin: Pin = self._pins[name]
        pin.drive(level)

    def held(self, name: Text) -> int:
        """Return 0 if our side pulls the line low, else 1."""
        wire: Wire
        pin: Pin
        wire, pin = self._wires[name], self._pins[name]
        return int(not wire.pulling & ~pin.mask)

    def pulled(self, line: int, now: int, pulling: int) -> None:
        name = self._names[line]
        level = self.held(name)
        if level != self._levels[name]:
            self._levels[name] = level
            self._changes.append(Change(now, name, level))

    def changes(self) -> list[Change]:
        """Return the changes since the last call, in order of time, except those that were undone in the same tick."""
        found = self._changes
        if not found:
            return []
        self._changes = []
        last: dict[tuple[int, str], Change] = {(change.at, change.line): change for change in found}
        if len(last) == len(found):
            return found
        moves: dict[tuple[int, str], int] = {}
        for change in found:
            moves[change.at, change.line] = moves.get((change.at, change.line), 0) + 1
        return [change for place, change in last.items() if moves[place] % 2]
