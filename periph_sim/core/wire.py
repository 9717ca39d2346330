"""Wires: lines that several parties can pull, and the notification of the parties that sample them.

    Pin.drive --> settle: level, low if any party pulls --> Sampler --> watcher(tick, levels)

A wire has a pull-up and any number of parties that may pull it low. `level` is the settled level: it changes when all
parties of an instant have acted, independently of their order, and a level that does not outlast the instant is never
seen. A party that samples several wires is called once for all that changed together.
"""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import final

from .kernel import BY_WIRE, NOT_DUE, Agent, Kernel, SampledParty, Settleable, Shortcut
from .records import Kind, Recorder, Topic
from .state import State

Watcher = Callable[[int, int], None]

MAX_PARTIES = 62  # parties of a wire, lines of a sampler: their masks are C integers of 64 bits in the compiled form
BITS = tuple(1 << place for place in range(MAX_PARTIES))


_bit_of = attrgetter("bit")


class TooManyParties(ValueError):
    """More parties than a wire can have. The message is one sentence."""


@final
class _WatcherAgent(Agent):
    """An agent that calls a function with the sampled levels."""

    STATE = State("_watcher")

    __slots__ = ("_watcher",)

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher

    def sampled(self, now: int, levels: int) -> None:
        self._watcher(now, levels)


class Wire(Settleable):
    """A line with a pull-up and the parties on it.

    cause: the record of the last edge.
    recorded: True if edges are recorded, and perhaps the parties that hold a low level.
    pulling: mask of the parties that pull it low in the settled state; bit i is party i.
    attached: the number of parties.
    version: changes when a party is attached or the set of listeners changes.
    """

    STATE = State("level pulling _pulling _pulling_recorded", records="cause", chains="_watches")

    _records_holds: bool

    def __init__(self, kernel: Kernel, name: str, recorder: Recorder) -> None:
        self.name = name
        self.level = 1
        self.cause = 0
        self.recorder = recorder
        self.recorded = recorder.wants(Kind.EDGE, name)
        self.rank = kernel.rank()
        self.kernel = kernel
        self._records_holds = self.recorded and recorder.wants(Kind.HOLD)
        self.version = 0
        self._edges = recorder.topic(Kind.EDGE, name, "level")
        self._holds = recorder.topic(Kind.HOLD, name, "held")
        self.pulling = 0
        self.shortcut: Shortcut | None = None  # what skips edges of this wire now
        self.attached = 0
        self._pulling = 0  # the same, in an instant that is not settled yet
        self._pulling_recorded = 0  # the same, at the last record
        self._parties: list[str] = []
        self._names_of: dict[int, str] = {}  # by mask of the pulling parties, for records
        self._named = 0  # mask of the parties named last in a record, and their names
        self._names = ""
        self._watches: _Watch | None = None  # subscribers to the level: the first of a chain
        self._pull_watches: PullWatch | None = None
        self._queued = False
        self._moved = self._pulled = False  # changed when it settled last: its level, its pulling parties
        self._pulled_under = self._released_under = 0  # the last records that caused pulls and releases in this instant

    def attach(self, who: str) -> Pin:
        """Add a party and return its pin, released. TooManyParties if there is no place for it."""
        place = len(self._parties)
        if place >= MAX_PARTIES:
            raise TooManyParties(f"wire {self.name}: {who} would be party {place + 1}; a wire has up to {MAX_PARTIES}")
        self._parties.append(who)
        self.attached += 1
        self._changed()
        self._names_of.clear()
        self._named = 0
        return Pin(self, BITS[place])

    def watch(self, watcher: Watcher) -> Sampler:
        """Call `watcher(tick, level)` on every change of the settled level."""
        return watch([self], watcher)

    def watch_pulls(self, agent: Agent, line: int = 0) -> None:
        """Call `agent.pulled(line, ...)` in each instant in which the set of pulling parties changes."""
        self._add_pull_watch(PullWatch(agent, line, None))

    def notify_on_pulls(self, sampler: Sampler) -> None:
        """Also notify `sampler`, which listens to the wire, in each such instant."""
        self._add_pull_watch(PullWatch(sampler.agent, 0, sampler))

    def _add_pull_watch(self, watch: PullWatch) -> None:
        self._changed()
        if self._pull_watches is None:
            self._pull_watches = watch
        else:
            last = self._pull_watches
            while last.following is not None:
                last = last.following
            last.following = watch

    def mask_of_parties(self, prefix: str) -> int:
        """Return the mask of the parties whose names begin with `prefix`."""
        return sum(BITS[place] for place, who in enumerate(self._parties) if who.startswith(prefix))

    def parties(self) -> list[str]:
        """Return the names of all parties, pulling or not."""
        return list(self._parties)

    def held_by(self) -> list[str]:
        """Return the names of the parties that pull the line low now, such as those of a stuck bus."""
        return [who for i, who in enumerate(self._parties) if self._pulling >> i & 1]

    def pull(self, mask: int, level: int) -> None:
        """Release (1) or pull low (0) the line for the parties in `mask`. Edges that are skipped now are run before."""
        if self.shortcut is not None:
            self.shortcut.materialize()
        pulling = self._pulling & ~mask if level else self._pulling | mask
        if pulling == self._pulling:
            return
        self._pulling = pulling
        if self.recorded:
            self._under(level)
        if not self._queued:
            self._queued = True
            self.kernel.moved(self)

    def _under(self, level: int) -> None:
        """Note the present record as the cause of a release (1) or pull (0)."""
        if level:
            self._released_under = max(self._released_under, self.recorder.cause)
        else:
            self._pulled_under = max(self._pulled_under, self.recorder.cause)

    def settle(self) -> None:
        """Take the level that results from all pulls and mark listeners as due."""
        self._queued = False
        self._pulled = self._pulling != self.pulling
        if self._pulled:
            self.pulling = self._pulling
            if self._pull_watches is not None:
                self._notify_pulled(self._pull_watches)
        level: int = 0 if self.pulling else 1
        moved: bool
        self._moved = moved = level != self.level
        self.level = level
        if self.recorded:
            self._record_settled(moved)
        if moved:
            listener = self._watches
            while listener is not None:
                sampler = listener.sampler
                sampler.levels ^= listener.bit
                if not sampler.due:
                    sampler.due = BY_WIRE
                listener = listener.following

    def notify_parties(self, now: int) -> None:
        if self._pulled:
            watch = self._pull_watches
            while watch is not None:
                sampler = watch.sampler
                watch = watch.following
                if sampler is not None and sampler.due == BY_WIRE:
                    sampler.on_wire_settled(now)
        if self._moved:
            listener = self._watches
            while listener is not None:
                sampler = listener.sampler
                listener = listener.following
                if sampler.due == BY_WIRE:
                    sampler.due = NOT_DUE
                    if sampler.plain:
                        sampler.agent.sampled(now, sampler.levels)
                    else:
                        sampler.deliver(now)

    def _notify_pulled(self, first: PullWatch) -> None:
        watch: PullWatch | None = first
        while watch is not None:
            if watch.sampler is None:
                watch.agent.pulled(watch.line, self.kernel.now, self.pulling)
            elif not watch.sampler.due:
                watch.sampler.due = BY_WIRE
            watch = watch.following

    def _record_settled(self, moved: bool) -> None:
        """Record an edge, or the new set of holding parties if the level is the same."""
        if moved:
            cause = self._released_under if self.level else self._pulled_under
            self.cause = self._record(self._edges, self.level, cause)
        elif self._records_holds and self._pulling != self._pulling_recorded:
            self._record(self._holds, self.level, self._pulled_under or self._released_under)
        self._pulled_under = self._released_under = 0

    def jump(self, pulling: int) -> None:
        """Set the settled pulls without records and notifications, at the end of skipped edges."""
        self._pulling = self.pulling = pulling
        level = 0 if pulling else 1
        if level != self.level:
            self.level = level
            listener = self._watches
            while listener is not None:
                listener.sampler.jump(listener.bit)
                listener = listener.following

    def restored(self) -> None:
        """Clear what a snapshot does not have: its state is always settled."""
        self._queued = False

    def quiet(self) -> bool:
        """Return True if no pull is unsettled."""
        return self._pulling == self.pulling

    def listeners(self) -> list[Sampler | PullWatch]:
        """Return the subscribers to its level and to the parties that pull it."""
        listeners: list[Sampler | PullWatch] = []
        listener, watch = self._watches, self._pull_watches
        while listener is not None:
            listeners.append(listener.sampler)
            listener = listener.following
        while watch is not None:
            if watch.sampler is None:  # otherwise it is in the list already
                listeners.append(watch)
            watch = watch.following
        return listeners

    def _record(self, topic: Topic, level: int, cause: int) -> int:
        recorder = self.recorder
        self._pulling_recorded = pulling = self._pulling
        if pulling and pulling != self._named:
            self._named, self._names = pulling, self._names_for(pulling)
        outer, recorder.cause = recorder.cause, cause
        number = topic.emit(self.kernel.now, level, self._names if pulling else "")
        recorder.cause = outer
        return number

    def _names_for(self, pulling: int) -> str:
        """Return the names of the parties that pull the line, for records; `pulling` is their mask."""
        names = self._names_of.get(pulling)
        if names is None:
            names = self._names_of[pulling] = ", ".join(self.held_by())
        return names

    def add(self, sampler: Sampler, bit: int) -> None:
        """Add a listener: this wire's level becomes this bit of the sampler's levels."""
        self._changed()
        watch = _Watch(sampler, bit)
        if self._watches is None:
            self._watches = watch
        else:
            last = self._watches
            while last.following is not None:
                last = last.following
            last.following = watch

    def remove(self, sampler: Sampler, bit: int) -> None:
        """Remove a listener that was added with this bit."""
        self._changed()
        before, watch = None, self._watches
        while watch is not None and not (watch.sampler is sampler and watch.bit == bit):
            before, watch = watch, watch.following
        assert watch is not None
        if before is None:
            self._watches = watch.following
        else:
            before.following = watch.following
        if sampler.due == BY_WIRE:  # the wire has changed and no longer notifies the sampler
            sampler.due = NOT_DUE
            self.kernel.request_sample(sampler)

    def _changed(self) -> None:
        """Note that parties or listeners change. Shortcuts are valid only for those they know."""
        self.kernel.materialize()
        self.version += 1


@final
class PullWatch:
    """A subscriber to the set of pulling parties: an agent, which knows the wire as `line`, or a sampler.

    following: the next one.
    """

    __slots__ = ("agent", "following", "line", "sampler")

    def __init__(self, agent: Agent, line: int, sampler: Sampler | None) -> None:
        self.agent = agent
        self.line = line
        self.sampler = sampler
        self.following: PullWatch | None = None


@final
class _Watch:
    """A sampler that listens to a wire, and the bit of its levels that the wire is. following: the next one."""

    STATE = State("sampler bit", made=True)

    __slots__ = ("bit", "following", "sampler")

    def __init__(self, sampler: Sampler, bit: int) -> None:
        self.sampler = sampler
        self.bit = bit
        self.following: _Watch | None = None


@final
class Pin:
    """The connection of one party to a wire."""

    STATE = State("wire mask", made=True)

    __slots__ = ("mask", "wire")

    def __init__(self, wire: Wire, mask: int) -> None:
        self.wire = wire
        self.mask = mask

    def drive(self, level: int) -> None:
        """Pull the wire low (0) or release it (1)."""
        self.wire.pull(self.mask, level)


@final
class _Line:
    """One line of a sampler: a wire, or None if the owner sets its level with `put`."""

    STATE = State("bit wire", made=True)

    __slots__ = ("bit", "wire")

    def __init__(self, bit: int) -> None:
        self.bit = bit
        self.wire: Wire | None = None


@final
class Sampler(SampledParty):
    """The lines that one party samples: bit i of `levels` is line i.

    A line is a wire (`listen`) or has a level that the owner sets (`put`).
    agent: its `sampled` is called with the tick and `levels` once in each instant in which any line changes. The record
        under which the first of these lines changed is then the present one.
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
        self.plain = True  # no record can be the cause of a change
        self._lines: list[_Line] = []  # lines set by `listen` or `put`, the lowest first
        self._put_under = 0  # the record under which a level was put last
        self._seen = levels

    def listen(self, line: int, wire: Wire) -> None:
        """Make this line a wire. ValueError if the number is too large."""
        if line >= MAX_PARTIES:
            raise ValueError(f"wire {wire.name} would be line {line}; a sampler has lines 0 to {MAX_PARTIES - 1}")
        self._leave(line).wire = wire
        if wire.recorded:
            self.plain = False
        wire.add(self, BITS[line])
        self._set(line, wire.level)

    def put(self, line: int, level: int) -> None:
        """Set the level of this line, which is no wire any more."""
        self._leave(line)
        self._put_under = self._recorder.cause
        if self._put_under:
            self.plain = False
        self._set(line, level)

    def jump(self, bits: int) -> None:
        """Toggle these lines without notification; the changes belong to skipped edges."""
        self.levels ^= bits
        self._seen ^= bits

    def restored(self) -> None:
        """Clear `due`: nothing is due in a restored state."""
        self.due = NOT_DUE

    def request_sample(self) -> None:
        """Request a call in this instant, even if no line changes."""
        self._kernel.request_sample(self)

    def on_wire_settled(self, now: int) -> None:
        """Deliver the levels; called by a wire."""
        self.due = NOT_DUE
        if self.plain:
            self.agent.sampled(now, self.levels)
        else:
            self.deliver(now)

    def deliver(self, now: int) -> None:
        self._deliver_under_record(now)

    def _deliver_under_record(self, now: int) -> None:
        moved = self.levels ^ self._seen
        self._seen = self.levels
        recorder = self._recorder
        outer = recorder.cause
        if moved:
            recorder.cause = self._moved_under(moved)
        self.agent.sampled(now, self.levels)
        recorder.cause = outer

    def _set(self, line: int, level: int) -> None:
        if self.levels >> line & 1 != level:
            self.levels ^= BITS[line]
            self.request_sample()

    def _moved_under(self, moved: int) -> int:
        """Return the record under which the first of these lines has changed."""
        line: _Line
        for line in self._lines:
            if moved & line.bit:
                return self._put_under if line.wire is None else line.wire.cause
        return self._put_under

    def _leave(self, number: int) -> _Line:
        """Return the line of this number, detached from its wire if it had one."""
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
    """Call `watcher(tick, levels)` whenever any of these wires has changed; bit i is wire i. ValueError without wires.

    If `watcher` is an agent, its `sampled` is called.
    """
    if not wires:
        raise ValueError("there is no wire to watch")
    wires[0].kernel.materialize()
    levels = sum(wire.level << i for i, wire in enumerate(wires))
    sampler = Sampler(wires[0].kernel, wires[0].recorder, watcher, levels)
    for line, wire in enumerate(wires):
        sampler.listen(line, wire)
    return sampler
