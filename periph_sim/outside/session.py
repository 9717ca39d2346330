"""A case that external code, called the outside, runs step by step. The outside also moves some lines of the case.

    apply(at, levels) --> OutsidePins --> wires of the scene <-- units, chips, agents of the case
    advance(until)    --> kernel runs up to `until` --> changes of the pins of the case
    finish()          --> Result, as from a run

`now` is the next tick. None of its events have run, so a level that is applied at `now` is effective in this tick. The
records depend only on the calls of `apply`, and not on the steps in which time advances.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, final

from ..core.agent import Agent, Event
from ..core.chip import NEVER
from ..core.input_files import inputs_of_one_command
from ..core.kernel import Kernel
from ..core.phrases import did_you_mean
from ..core.table import duration
from ..core.wire import Pin, Wire
from ..form.c_types import BigInt, Text
from ..records.recording import Subscribe
from ..scene.case.load import load
from ..scene.case.model import BadCase, Case
from ..scene.firmware_loader import Firmware
from ..scene.outside_parties import with_outside
from ..scene.result import Result
from ..scene.scene import Scene
from .errors import OutsideError
from .i2c_master import Master
from .log import LogWriter
from .reaction import Reaction
from .serial_line import SerialLine, sci_of

WHO = "outside"  # name of the outside in records, and as a party on the wires


class Change(NamedTuple):
    """A change of a line by the case, which has released it (level 1) or pulled it low (level 0) at tick `at`."""

    at: int
    line: str
    level: int


@final
class OutsidePins(Agent):
    """The pins of the outside on the wires. Times are in ticks of the kernel.

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
        self._event: Event | None = None  # the kernel's event for the earliest tick in `_put`
        self._levels = {name: self.held(name) for name in wires}
        self._changes: list[Change] = []
        for line, wire in enumerate(wires.values()):
            wire.watch_pulls(self, line)

    def put(self, at: int, name: Text, level: int) -> None:
        """Schedule a move of a line at tick `at`, which must not be past.

        If there are several moves of a line for one tick, only the last one has an effect.
        """
        self._put.setdefault(at, {})[name] = level

    def plan(self) -> None:
        """Schedule the kernel's event for the earliest move. Call this just before time advances."""
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
        """Return 0 if any party of the case pulls the line low, else 1."""
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
        """Return the changes by the case since the last call, in order of time.

        Changes that were undone in the same tick are left out. Of several changes of a line in one tick, only the last
        one is returned.
        """
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


class Session:
    """A case that external code runs step by step, and whose lines it moves.

    case: a case from `load` or `make_case`, or the path of its file.
    outside: the names of the wires that lead outside; None for those in the [outside] table of the case.
    log: the path of a log of the outside's moves, from which `replay` can repeat the run.
    subscribe: a function that is called with the recorder and the timebase while the scene is built, and can subscribe
        to records.
    programs: by the name of a unit, a Python function that runs in place of the unit's firmware in the case.

    Times are ticks (`ticks_per_second`), counted from the beginning of the case. A session is a context manager; if the
    block is left without `finish`, the log has no "end" line.

    Raise BadCase if the case cannot be built or lacks one of the wires, or if neither `outside` nor the case names any.
    Raise OutsideError if the log cannot be written or is a file that the session reads.

    After `finish`, `advance`, `next_output` and `apply` raise OutsideError.
    """

    scene: Scene
    ticks_per_second: int
    _kernel: Kernel
    _start: int
    _log: LogWriter | None

    def __init__(
        self,
        case: Case | str | Path,
        outside: Sequence[str] | None = None,
        *,
        log: str | Path | None = None,
        subscribe: Subscribe | None = None,
        programs: Mapping[str, Firmware] | None = None,
    ) -> None:
        case = case if isinstance(case, Case) else load(Path(case))
        if outside is None and case.outside is not None:
            outside = case.outside.wires
        if outside is None:
            raise BadCase(f"case {case.name}: no wire leads outside; name them: Session(case, outside=('SDA', 'SCL'))")
        case = with_outside(case, tuple(outside))
        self.case = case
        self.lines = tuple(outside)
        with inputs_of_one_command():
            self.scene = Scene(case, subscribe, programs)
            self.ticks_per_second = self.scene.timebase.per_second
            self._kernel = self.scene.kernel
            self._start = self.scene.start
            self._pins = OutsidePins(self._kernel, {name: self.scene.wire(name) for name in self.lines}, self._acted)
            self._log = None if log is None else LogWriter(Path(log), case, self.ticks_per_second, self.lines)
        self._reaction = Reaction(self.scene, self.lines)
        self._now = 0
        self._master: Master | None = None
        self._serial: dict[str, SerialLine] = {}
        self._result: Result | None = None

    def __enter__(self) -> Session:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._log is not None and self._result is None:
            self._log.close()

    # Time ------------------------------------------------------------------------

    @property
    def now(self) -> int:
        """The next tick; all ticks before it have been run."""
        return self._now

    def ticks(self, length: Text) -> int:
        """Convert a duration such as "5 us" to ticks, rounded to the nearest. Raise ValueError if it is invalid."""
        return self.scene.timebase.ticks(duration(length), "nearest")

    def advance(self, until: BigInt) -> list[Change]:
        """Run up to tick `until`, exclusive, and return the changes of lines by the case.

        Raise OutsideError if `until` is past or is not a whole number.
        """
        self._check_tick(until)
        if until < self._now:
            raise OutsideError(f"{self._at(until)} is past: the session is at {self._at(self._now)}")
        for line in self._serial.values():
            line.feed(until)
        if until > self._now:
            if self._log is not None:
                self._log.begin()
            self._pins.plan()
            try:
                self.scene.advance(self._start + until - 1)
            finally:
                self._pins.withdraw()
            self._now = until
            self._reaction.advanced(self._start + until)
        changes = self._pins.changes()
        return [change._replace(at=change.at - self._start) for change in changes] if changes else changes

    def next_output(self) -> int | None:
        """Return a tick before which no pin of the case moves if the outside moves no line; None if no pin ever moves.

        The outside moves lines by `apply` and by writes to a serial line. If bytes wait in the queue of a serial line,
        the returned tick is not later than the next start bit.
        """
        self._open()
        due = self._reaction.due()
        for line in self._serial.values():
            due = min(due, self._start + line.next_begin())
        return None if due >= NEVER else max(due - self._start, self._now)

    # Lines -----------------------------------------------------------------------

    def apply(self, at: int, levels: Mapping[str, int]) -> None:  # core: python
        """Pull lines low (0) or release them (1) from outside, all at tick `at`.

        If a line is moved several times in one tick, only the last call has an effect.

        Raise OutsideError, and move no line, if the tick is past or not a whole number, or if a line does not lead
        outside, or a level is invalid.
        """
        self._check_tick(at)
        if at < self._now:
            raise OutsideError(f"lines cannot move at {self._at(at)}: the session is at {self._at(self._now)} already")
        for name, level in levels.items():
            if name not in self.lines:
                known = did_you_mean(name, self.lines)
                raise OutsideError(f"line {name!r} does not lead outside of case {self.case.name}; {known}")
            if level not in (0, 1):
                raise OutsideError(f"{name} at {self._at(at)}: found {level!r}, expected 0, pulled low, or 1, let go")
        tick = self._start + at
        for name, level in levels.items():
            self._pins.put(tick, name, int(level))
            self._reaction.put(tick, name, int(level))

    def pulls(self, line: Text) -> bool:
        """Return True if the case pulls a line low, regardless of the outside.

        Raise OutsideError if the line does not lead outside.
        """
        if line not in self.lines:
            raise OutsideError(f"line {line!r} does not lead outside; {did_you_mean(line, self.lines)}")
        return not self._pins.held(line)

    def level(self, line: Text) -> int:
        """Return the level of a wire, as driven by case and outside, at the end of the last tick that has run."""
        if line not in self.scene.wires:
            raise OutsideError(f"there is no wire {line!r}; {did_you_mean(line, self.scene.wires)}")
        return self.scene.wires[line].level

    # Whole transfers and characters ---------------------------------------------------

    @property
    def i2c(self) -> Master:
        """A controller on SDA and SCL. Its rate is 100 kHz, unless `Master.rate` is set."""
        if self._master is None:
            self._master = Master(self)
        return self._master

    def serial(self, port: Text, baud: BigInt = 115_200, form: Text = "8n1") -> SerialLine:
        """Create the other end of an SCI's lines, which sends and receives bytes.

        Raise OutsideError if there is no such SCI, its RX does not lead outside, its other end exists already, or the
        rate or the format is invalid.

        port: the SCI, for example "scia", "SCI-A" or "dsp.SCI-A".
        form: data bits, parity and stop bits, such as "8n1".
        """
        sci = sci_of(self.case, port)
        name = f"{sci.unit}.{sci.module}"
        if sci.rx not in self.lines:
            way_out = f"give it to the session: outside=({sci.rx!r}, ...)"
            raise OutsideError(f"{sci.rx} of {name} does not lead outside; {way_out}")
        if name in self._serial:
            raise OutsideError(f"{name} has its other end already; use that, or close the session")
        line = self._serial[name] = SerialLine(self, sci.rx, sci.tx, baud, form)
        self.scene.uart.sent(line.rx, 0)
        if self._log is not None:
            self._log.serial(line.rx)
        return line

    # The end -----------------------------------------------------------------------

    def finish(self) -> Result:
        """End the session and its firmware, and return the result, judged by the case's budgets."""
        if self._result is None:
            self._result = self.scene.finish(self._now)
            self.scene.close()
            if self._log is not None:
                self._log.end(self._now)
        return self._result

    def _check_tick(self, tick: object) -> None:
        self._open()
        if type(tick) is not int:
            raise OutsideError(f"{tick!r} is no tick: expected a whole number, as from session.ticks('5 us')")

    def _open(self) -> None:
        if self._result is not None:
            raise OutsideError("the session is finished; begin another one")

    def _acted(self, tick: int, levels: Mapping[str, int]) -> None:
        begun = [line.rx for line in self._serial.values() if line.begins(tick - self._start)]
        for wire in begun:
            self.scene.uart.sent(wire, 1)
        if self._log is not None:
            self._log.instant(tick - self._start, levels, begun)

    def _at(self, tick: int) -> str:
        return f"tick {tick} ({self.scene.timebase.show(tick)})"
