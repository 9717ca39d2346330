"""Parties that sample wires. Each time wires settle, a party is notified at most once, with all its lines' levels."""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import final

from .agent import NOT_DUE, Agent, SampledParty
from .kernel import Kernel
from .records import Recorder
from .state import State
from .wire import BITS, MAX_PARTIES, Wire

Watcher = Callable[[int, int], None]

_bit_of = attrgetter("bit")


@final
class _WatcherAgent(Agent):
    """An agent that calls a function with the sampled levels."""

    STATE = State("_watcher")

    __slots__ = ("_watcher",)

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher

    def sampled(self, now: int, levels: int) -> None:
        self._watcher(now, levels)


@final
class _Line:
    """One line of a sampler. wire: the wire of the line; None if the owner sets its level with `put`."""

    STATE = State("bit wire", made=True)

    __slots__ = ("bit", "wire")

    def __init__(self, bit: int) -> None:
        self.bit = bit
        self.wire: Wire | None = None


@final
class Sampler(SampledParty):
    """The lines that one party samples: bit i of `levels` is line i.

    A line is a wire (`listen`) or has a level that the owner sets (`put`).
    agent: the agent whose `sampled` is called with the tick and `levels`, once after each settling that changes any
        line. If changes of any line have recorded causes, `Recorder.cause` during this call is the cause of the change
        of the lowest line that changed.
    """

    STATE = State("levels plain agent _seen _lines", records="_put_under")

    __slots__ = ("_kernel", "_lines", "_put_under", "_recorder", "_seen")

    def __init__(self, kernel: Kernel, recorder: Recorder, agent: Agent | Watcher, levels: int = 0) -> None:
        self.levels = levels
        self.due = NOT_DUE
        self.rank = kernel.rank()
        self._kernel = kernel
        self._recorder = recorder
        self.agent = agent if isinstance(agent, Agent) else _WatcherAgent(agent)
        self.plain = True  # True while no line can have a recorded cause; `Recorder.cause` is then not set
        self._lines: list[_Line] = []  # lines set by `listen` or `put`, the lowest first
        self._put_under = 0  # the number of the record that caused the last `put`
        self._seen = levels  # the levels at the last notification; not used while `plain` is True

    def listen(self, line: int, wire: Wire) -> None:
        """Connect this line to a wire instead of its former wire or level. Raise ValueError if `line` is too large."""
        if line >= MAX_PARTIES:
            raise ValueError(f"wire {wire.name} would be line {line}; a sampler has lines 0 to {MAX_PARTIES - 1}")
        self._leave(line).wire = wire
        if wire.recorded:
            self._record_causes()
        wire.add(self, BITS[line])
        self._set(line, wire.level)

    def put(self, line: int, level: int) -> None:
        """Set the level of this line. If the line was a wire, the wire is detached."""
        self._leave(line)
        self._put_under = self._recorder.cause
        if self._put_under:
            self._record_causes()
        self._set(line, level)

    def jump(self, bits: int) -> None:
        """Invert the levels of the lines in the mask `bits`. No party is notified, since a shortcut skips the edges."""
        self.levels ^= bits
        if not self.plain:
            self._seen ^= bits

    def restored(self) -> None:
        """Clear `due`: nothing is due in a restored state."""
        self.due = NOT_DUE

    def request_sample(self) -> None:
        """Request a call of `agent.sampled` at the end of this phase, even if no line changes."""
        self._kernel.request_sample(self)

    def deliver(self, now: int) -> None:
        moved = self.levels ^ self._seen
        self._seen = self.levels
        recorder = self._recorder
        outer = recorder.cause
        if moved:
            recorder.cause = self._moved_under(moved)
        self.agent.sampled(now, self.levels)
        recorder.cause = outer

    def _record_causes(self) -> None:
        """Begin to set `Recorder.cause` at each notification. `_seen` is needed to find the changed lines."""
        if self.plain:
            self.plain = False
            self._seen = self.levels

    def _set(self, line: int, level: int) -> None:
        if self.levels >> line & 1 != level:
            self.levels ^= BITS[line]
            self.request_sample()

    def _moved_under(self, moved: int) -> int:
        """Return the number of the record that caused the change of the lowest line in the mask `moved`."""
        line: _Line
        for line in self._lines:
            if moved & line.bit:
                return self._put_under if line.wire is None else line.wire.cause
        return self._put_under

    def _leave(self, number: int) -> _Line:
        """Detach the line of this number from its wire, and return the line. Create it first if it does not exist."""
        bit = BITS[number]
        line: _Line
        for line in self._lines:
            if line.bit == bit:
                wire: Wire | None
                wire, line.wire = line.wire, None
                if wire is not None:
                    wire.remove(self, bit)
                return line
        line = _Line(bit)
        self._lines.append(line)
        self._lines.sort(key=_bit_of)
        return line


def watch(wires: Sequence[Wire], watcher: Agent | Watcher) -> Sampler:
    """Return a sampler that calls `watcher(tick, levels)` when any of these wires has changed; bit i is wire i.

    If `watcher` is an agent, its `sampled` is called. Raise ValueError if there are no wires, or more than MAX_PARTIES.
    """
    if not wires:
        raise ValueError("there is no wire to watch")
    wires[0].kernel.materialize()
    levels = sum(wire.level << i for i, wire in enumerate(wires))
    sampler = Sampler(wires[0].kernel, wires[0].recorder, watcher, levels)
    for line, wire in enumerate(wires):
        sampler.listen(line, wire)
    return sampler
