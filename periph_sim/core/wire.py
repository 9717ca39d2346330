"""Wires: lines that several parties can pull, and the notification of the parties that sample them.

    Pin.drive --> settle: level, low if any party pulls --> SampledParty --> watcher(tick, levels)

A wire has a pull-up and up to MAX_PARTIES parties that may pull it low. `level` is the settled level. It changes only
at the end of a phase of a tick (`kernel`), when all agents of this phase have acted. So the order in which they act
does not matter, and a level that ends within the phase is never seen. A party that samples several wires is called once
for all wires that changed in the same phase.
"""

# core: compiled without checks for None

from __future__ import annotations

from typing import final

from .agent import BY_WIRE, NOT_DUE, Agent, SampledParty, Settleable, Shortcut
from .kernel import Kernel
from .records import Kind, Recorder, Topic
from .state import State

MAX_PARTIES = 62  # maximum number of parties of a wire or lines of a sampler; compiled masks are 64-bit integers
BITS = tuple(1 << place for place in range(MAX_PARTIES))


class TooManyParties(ValueError):
    """Error: more parties than a wire can have. The message is one sentence."""


class Wire(Settleable):
    """A line with a pull-up and the parties on it.

    cause: the number of the record of the last edge; 0 if no edge was recorded.
    recorded: True if the edges of this wire are recorded.
    pulling: mask of the parties that pull it low in the settled state; bit i is party i.
    attached: the number of parties.
    version: a number that increases when a party is attached or a listener is added or removed. If it is unchanged, a
        stored list of the parties or listeners is still valid.
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
        self.shortcut: Shortcut | None = None  # the shortcut that skips edges of this wire now
        self.attached = 0
        self._pulling = 0  # like `pulling`, with the changes that have not settled yet
        self._pulling_recorded = 0  # the value of `_pulling` at the last record of this wire
        self._parties: list[str] = []
        self._names_of: dict[int, str] = {}  # maps a mask of pulling parties to the names of these parties, for records
        self._named = 0  # mask of the parties whose names are in `_names`, a cache for the next record
        self._names = ""
        self._watches: _Watch | None = None  # the first entry in the linked list of subscribers to the level
        self._pull_watches: PullWatch | None = None
        self._queued = False
        # `_moved` is True if the last settling changed the level, `_pulled` if it changed the set of pulling parties.
        self._moved = self._pulled = False
        # `_pulled_under` is the number of the last record that caused a pull since the wire last settled, or 0.
        # `_released_under` is the number of the last record that caused a release since the wire last settled, or 0.
        self._pulled_under = self._released_under = 0

    def attach(self, who: str) -> Pin:
        """Add a party and return its pin, released. Raise TooManyParties if the wire has MAX_PARTIES parties."""
        place = len(self._parties)
        if place >= MAX_PARTIES:
            raise TooManyParties(f"wire {self.name}: {who} would be party {place + 1}; a wire has up to {MAX_PARTIES}")
        self._parties.append(who)
        self.attached += 1
        self._changed()
        self._names_of.clear()
        self._named = 0
        return Pin(self, BITS[place])

    def watch_pulls(self, agent: Agent, line: int = 0) -> None:
        """Call `agent.pulled(line, ...)` each time that this wire settles with a different set of pulling parties."""
        self._add_pull_watch(PullWatch(agent, line, None))

    def notify_on_pulls(self, sampler: SampledParty) -> None:
        """Notify `sampler`, a listener of the wire, also when the set of pulling parties changes."""
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
        """Return the names of the parties that pull the line low now, for example on a stuck bus."""
        return [who for i, who in enumerate(self._parties) if self._pulling >> i & 1]

    def pull(self, mask: int, level: int) -> None:
        """Pull the line low (0) or release it (1) for the parties in `mask`. Skipped edges up to now are run first."""
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
        """Note the present record as the cause of a release (level 1) or a pull (level 0)."""
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
                    sampler.notify(now)
        if self._moved:
            listener = self._watches
            while listener is not None:
                sampler = listener.sampler
                listener = listener.following
                if sampler.due == BY_WIRE:
                    sampler.notify(now)

    def _notify_pulled(self, first: PullWatch) -> None:
        watch: PullWatch | None = first
        while watch is not None:
            if watch.sampler is None:
                watch.agent.pulled(watch.line, self.kernel.now, self.pulling)
            elif not watch.sampler.due:
                watch.sampler.due = BY_WIRE
            watch = watch.following

    def _record_settled(self, moved: bool) -> None:
        """Record an edge if the level has changed. Otherwise record the set of pulling parties if it has changed."""
        if moved:
            cause = self._released_under if self.level else self._pulled_under
            self.cause = self._record(self._edges, self.level, cause)
        elif self._records_holds and self._pulling != self._pulling_recorded:
            self._record(self._holds, self.level, self._pulled_under or self._released_under)
        self._pulled_under = self._released_under = 0

    def jump(self, pulling: int) -> None:
        """Set the pulling parties and the level without records and notifications: a shortcut skips the edges."""
        self._pulling = self.pulling = pulling
        level = 0 if pulling else 1
        if level != self.level:
            self.level = level
            listener = self._watches
            while listener is not None:
                listener.sampler.jump(listener.bit)
                listener = listener.following

    def restored(self) -> None:
        """Mark the wire as settled after a snapshot was restored, because snapshots contain settled states only."""
        self._queued = False

    def quiet(self) -> bool:
        """Return True if all pulls have settled."""
        return self._pulling == self.pulling

    def listeners(self) -> list[SampledParty | PullWatch]:
        """Return the subscribers to the wire's level and to the set of its pulling parties, each of them once."""
        listeners: list[SampledParty | PullWatch] = []
        listener, watch = self._watches, self._pull_watches
        while listener is not None:
            listeners.append(listener.sampler)
            listener = listener.following
        while watch is not None:
            if watch.sampler is None:  # if `watch` has a sampler, the sampler is in `listeners` already
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

    def add(self, sampler: SampledParty, bit: int) -> None:
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

    def remove(self, sampler: SampledParty, bit: int) -> None:
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
        if sampler.due == BY_WIRE:  # this wire can no longer notify the sampler of the new level, so the kernel must
            sampler.due = NOT_DUE
            self.kernel.request_sample(sampler)

    def _changed(self) -> None:
        """Run skipped events and increase `version`, because the parties or the listeners change."""
        self.kernel.materialize()
        self.version += 1


@final
class PullWatch:
    """A subscriber to the set of pulling parties: a sampler, or an agent whose `pulled` receives the number `line`.

    following: the next subscriber in the linked list; None for the last subscriber.
    """

    __slots__ = ("agent", "following", "line", "sampler")

    def __init__(self, agent: Agent, line: int, sampler: SampledParty | None) -> None:
        self.agent = agent
        self.line = line
        self.sampler = sampler
        self.following: PullWatch | None = None


@final
class _Watch:
    """A sampler that listens to a wire.

    bit: the mask of the bit that represents the wire in the sampler's levels.
    following: the next entry in the wire's linked list; None for the last entry.
    """

    STATE = State("sampler bit", made=True)

    __slots__ = ("bit", "following", "sampler")

    def __init__(self, sampler: SampledParty, bit: int) -> None:
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
