"""Wires: what several parties do to one line, and who is told.

    Pin.drive --> settle: level, low if anybody pulls --> Sampler --> watcher(tick, levels)

A wire has a pull-up and any number of parties that may pull it low. `level` is the settled one: it changes
when all parties of an instant have acted, whatever their order, and a level that does not outlast the instant
is never seen. Whoever looks at several wires is told once of all that moved together.
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
    """One more party than a wire can have; one sentence."""


@final
class _WatcherAgent(Agent):
    """Hands what is sampled to a function."""

    STATE = State("_watcher")

    __slots__ = ("_watcher",)

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher

    def sampled(self, now: int, levels: int) -> None:
        self._watcher(now, levels)


class Wire(Settleable):
    """cause: the record of the last edge. recorded: somebody wants each edge, and perhaps who holds a low one.

    pulling: who pulls it low in the settled state; bit i is party i. attached: how many parties there are. version:
    another one whenever a party comes, or one who listens comes or goes.
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
        self._pulling_recorded = 0  # the same when it was recorded last
        self._parties: list[str] = []
        self._names_of: dict[int, str] = {}  # of those who pull, as records tell them
        self._named = 0  # who pulled it as somebody did when a record was made last, and their names
        self._names = ""
        self._watches: _Watch | None = None  # who is told: the first of a chain
        self._pull_watches: PullWatch | None = None
        self._queued = False
        self._moved = self._pulled = False  # in the instant that settled last: its level, those who pull it
        self._pulled_under = self._released_under = 0  # the last records under which that was done in this instant

    def attach(self, who: str) -> Pin:
        """A new party's hold on the line, released. TooManyParties for one too many."""
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
        """`watcher(tick, level)` on every change of the settled level."""
        return watch([self], watcher)

    def watch_pulls(self, agent: Agent, line: int = 0) -> None:
        """`agent.pulled(line, ...)` in each instant in which others pull the wire than before, whatever its level."""
        self._add_pull_watch(PullWatch(agent, line, None))

    def notify_on_pulls(self, sampler: Sampler) -> None:
        """`sampler`, which listens to the wire, is told in each such instant, too."""
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
        """The mask of the parties whose names begin with this."""
        return sum(BITS[place] for place, who in enumerate(self._parties) if who.startswith(prefix))

    def parties(self) -> list[str]:
        """Who has a hold on the line, pulling or not."""
        return list(self._parties)

    def held_by(self) -> list[str]:
        """Who pulls the line low now: what a person asks first of a stuck bus."""
        return [who for i, who in enumerate(self._parties) if self._pulling >> i & 1]

    def pull(self, mask: int, level: int) -> None:
        """Release (1) or pull low (0) the holds of `mask`. Edges that are skipped now are run before."""
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
        """A pull or release (1) under the present record."""
        if level:
            self._released_under = max(self._released_under, self.recorder.cause)
        else:
            self._pulled_under = max(self._pulled_under, self.recorder.cause)

    def settle(self) -> None:
        """Take the level that results from all pulls. Those who listen are due."""
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
            look = self._watches
            while look is not None:
                sampler = look.sampler
                sampler.levels ^= look.bit
                if not sampler.due:
                    sampler.due = BY_WIRE
                look = look.following

    def notify_parties(self, now: int) -> None:
        if self._pulled:
            watch = self._pull_watches
            while watch is not None:
                sampler = watch.sampler
                watch = watch.following
                if sampler is not None and sampler.due == BY_WIRE:
                    sampler.on_wire_settled(now)
        if self._moved:
            look = self._watches
            while look is not None:
                sampler = look.sampler
                look = look.following
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
        """An edge, if its level has moved; else perhaps that others hold it."""
        if moved:
            cause = self._released_under if self.level else self._pulled_under
            self.cause = self._record(self._edges, self.level, cause)
        elif self._records_holds and self._pulling != self._pulling_recorded:
            self._record(self._holds, self.level, self._pulled_under or self._released_under)
        self._pulled_under = self._released_under = 0

    def jump(self, pulling: int) -> None:
        """It was settled on these pulls before anybody looks again; nobody is told, and it is not recorded."""
        self._pulling = self.pulling = pulling
        level = 0 if pulling else 1
        if level != self.level:
            self.level = level
            look = self._watches
            while look is not None:
                look.sampler.jump(look.bit)
                look = look.following

    def restored(self) -> None:
        """The state has been restored, which is always a settled one."""
        self._queued = False

    def quiet(self) -> bool:
        """No pull is unsettled."""
        return self._pulling == self.pulling

    def listeners(self) -> list[Sampler | PullWatch]:
        """Return the subscribers to its level and to the parties that pull it."""
        listeners: list[Sampler | PullWatch] = []
        look, watch = self._watches, self._pull_watches
        while look is not None:
            listeners.append(look.sampler)
            look = look.following
        while watch is not None:
            if watch.sampler is None:  # else it is among those already
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
        """Who pulls the line in this instant, as records tell them; `pulling` is their mask."""
        names = self._names_of.get(pulling)
        if names is None:
            names = self._names_of[pulling] = ", ".join(self.held_by())
        return names

    def add(self, sampler: Sampler, bit: int) -> None:
        """From now on this wire's level is this bit of the sampler's levels."""
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
        """No longer."""
        self._changed()
        before, watch = None, self._watches
        while watch is not None and not (watch.sampler is sampler and watch.bit == bit):
            before, watch = watch, watch.following
        assert watch is not None
        if before is None:
            self._watches = watch.following
        else:
            before.following = watch.following
        if sampler.due == BY_WIRE:  # it has moved, and does not hand on to the sampler any more
            sampler.due = NOT_DUE
            self.kernel.request_sample(sampler)

    def _changed(self) -> None:
        """There are others on the wire than before: what passes at once does so for those only whom it knows."""
        self.kernel.materialize()
        self.version += 1


@final
class PullWatch:
    """Who is told of who pulls a wire, and what that wire is to it; or its sampler. following: the next one."""

    __slots__ = ("agent", "following", "line", "sampler")

    def __init__(self, agent: Agent, line: int, sampler: Sampler | None) -> None:
        self.agent = agent
        self.line = line
        self.sampler = sampler
        self.following: PullWatch | None = None


@final
class _Watch:
    """One party's look at a wire: which bit of its levels the wire is. following: the next one's."""

    STATE = State("sampler bit", made=True)

    __slots__ = ("bit", "following", "sampler")

    def __init__(self, sampler: Sampler, bit: int) -> None:
        self.sampler = sampler
        self.bit = bit
        self.following: _Watch | None = None


@final
class Pin:
    """One party's hold on a wire."""

    STATE = State("wire mask", made=True)

    __slots__ = ("mask", "wire")

    def __init__(self, wire: Wire, mask: int) -> None:
        self.wire = wire
        self.mask = mask

    def drive(self, level: int) -> None:
        """0 pulls the wire low, 1 lets go."""
        self.wire.pull(self.mask, level)


@final
class _Line:
    """A line of a sampler by its bit: a wire, or None where its owner puts the level."""

    STATE = State("bit wire", made=True)

    __slots__ = ("bit", "wire")

    def __init__(self, bit: int) -> None:
        self.bit = bit
        self.wire: Wire | None = None


@final
class Sampler(SampledParty):
    """The lines that one party looks at: bit i of `levels` is line i. It is told once an instant in which any moved.

    A line is a wire (`listen`) or what the owner says (`put`). agent: its `sampled` is called with the tick and
    `levels`, under the record of the first of the lines that moved.
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
        self.plain = True  # there is no record to work under
        self._lines: list[_Line] = []  # those that were listened to or put, the lowest first
        self._put_under = 0  # the record under which a level was put last
        self._seen = levels

    def listen(self, line: int, wire: Wire) -> None:
        """From now on this line is a wire. ValueError for a line too many."""
        if line >= MAX_PARTIES:
            raise ValueError(f"wire {wire.name} would be line {line}; who samples has lines 0 to {MAX_PARTIES - 1}")
        self._leave(line).wire = wire
        if wire.recorded:
            self.plain = False
        wire.add(self, BITS[line])
        self._set(line, wire.level)

    def put(self, line: int, level: int) -> None:
        """From now on this line is at `level`."""
        self._leave(line)
        self._put_under = self._recorder.cause
        if self._put_under:
            self.plain = False
        self._set(line, level)

    def jump(self, bits: int) -> None:
        """These lines have moved some time ago, and were looked at since."""
        self.levels ^= bits
        self._seen ^= bits

    def restored(self) -> None:
        """The state has been restored: nothing is due."""
        self.due = NOT_DUE

    def request_sample(self) -> None:
        """Be told in this instant, also if nothing moves."""
        self._kernel.request_sample(self)

    def on_wire_settled(self, now: int) -> None:
        """A wire hands on."""
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
        """The record under which the first of these lines has moved."""
        line: _Line
        for line in self._lines:
            if moved & line.bit:
                return self._put_under if line.wire is None else line.wire.cause
        return self._put_under

    def _leave(self, number: int) -> _Line:
        """The line of this number, which is no wire any more."""
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
    """`watcher(tick, levels)` whenever any of these wires has changed; bit i is wire i. ValueError without wires.

    Of an agent it is `sampled` that is called.
    """
    if not wires:
        raise ValueError("there is no wire to watch")
    wires[0].kernel.materialize()
    levels = sum(wire.level << i for i, wire in enumerate(wires))
    sampler = Sampler(wires[0].kernel, wires[0].recorder, watcher, levels)
    for line, wire in enumerate(wires):
        sampler.listen(line, wire)
    return sampler
