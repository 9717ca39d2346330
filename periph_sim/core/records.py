"""The vocabulary of a run, and who listens to it.

Everything recorded is one of the kinds below, has a number, a time in ticks, a place, and
the number of the record that caused it (0: nothing recorded did). Producers ask `wants`
once, when a scene is built; what nobody wants is never made. Edges, flags and accesses can be
wanted of some wires and registers only: these are the subjects of a subscription.

    producer --> Topic.emit --> listeners: tag, tick, value      (budgets)
                           '--> keepers: all of it, as columns   (`.psr`, races)
                           '--> sinks: a Record                  (files, diagrams)

Records of one kind, place and thing are a topic. A listener is asked once for each topic whether it has any use for it,
so that no record has to be looked at by those who have none.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from enum import Enum
from functools import partial
from typing import Any, NamedTuple, TypeAlias, final

from ..form.c_types import BigInt, Text
from .state import State


class Kind(Enum):
    EDGE = "edge"  # a wire changed: what = level, who pulled in `text`
    ACCESS = "access"  # a CPU access: what = R or W and the register, value
    FLAG = "flag"  # a register field changed by itself or by an access
    IRQ = "irq"  # interrupt requested, entered, left
    SPAN = "span"  # a stretch of firmware begins (1) or ends (0)
    BUS = "bus"  # what a party on the wire did or saw: START, address, byte, ACK, STOP
    FRAME = "frame"  # a UART frame on the wire
    NOTE = "note"  # a duty broken, something lost, something unknown
    WAIT = "wait"  # firmware begins (1) or ends (0) to wait: what = the fields it polls, or IDLE
    HOLD = "hold"  # a wire stays low, but others pull it now: who in `text`
    # Made only where a subscriber names them, by `scene/derived_records.py`. They follow from the records above. Their
    # ticks may lie before those of the records around them, and they have the number of the record before them.
    TRANSFER = "transfer"  # an I2C transfer that is over: its phases, answers, stretches
    ROUND = "round"  # a round of requests: due, over, missed
    RECEIVER = "receiver"  # an SCI's receiver: words waiting, characters received and lost
    DATA = "data"  # bytes that were read: whether they are right, how old they are, how far from the truth

    __hash__ = object.__hash__  # each is one object; Enum's own hash is a call in Python, made for every record


DERIVED = frozenset({Kind.TRANSFER, Kind.ROUND, Kind.RECEIVER, Kind.DATA})
RECORDED = tuple(kind for kind in Kind if kind not in DERIVED)  # the kinds that recordings of a whole run hold


class Record(NamedTuple):
    """field: of an access, the register field that the firmware named; "" for the whole register."""

    number: int
    tick: int
    kind: Kind
    where: str
    what: str
    value: int
    text: str
    cause: int
    field: str = ""


_made = tuple.__new__  # a Record without the call in Python that its own constructor is

RecordCallback = Callable[[Record], None]
Party: TypeAlias = "Listener | RecordSink | RecordCallback"
Subjects = Mapping[Kind, Collection[str]]
Things = Collection[tuple[Kind, str]]


UNWANTED = -1  # instead of a tag: there is no use for such records
NOWHERE, OF_MODIFIES, EVERYWHERE = range(3)  # of which accesses a keeper wants the place in the firmware


class Listener:
    """Who needs no more of a record than its time and value: a measure."""

    __slots__ = ()

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Under which tag it is to be told of these records; UNWANTED if it has no use for them."""
        raise NotImplementedError

    def on_record(self, tag: int, tick: int, value: int) -> None:
        """A record was made of what got this tag."""
        raise NotImplementedError


class RecordSink:
    """Who keeps records, without the object that a Record is."""

    __slots__ = ()

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """As a listener's."""
        raise NotImplementedError

    def places(self, tag: int) -> int:
        """Which of the records with this tag it wants with their place in the firmware.

        OF_MODIFIES: accesses that may be one half of a read-modify-write, so not a field that is only read.
        """
        return EVERYWHERE

    def keep(self, tag: int, number: int, tick: int, value: int, text: Text, cause: int, field: Text) -> None:
        """A record was made of what got this tag."""
        raise NotImplementedError


@final
class _ListenerEntry:
    """One entry in a topic's chain of listeners. following: the next entry."""

    __slots__ = ("following", "listener", "tag")

    listener: Listener
    tag: int
    following: _ListenerEntry | None


@final
class _KeeperEntry:
    """One entry in a topic's chain of keepers. following: the next entry."""

    __slots__ = ("following", "keeper", "tag")

    keeper: RecordSink
    tag: int
    following: _KeeperEntry | None


_NO_CALLBACKS: list[Any] = []  # stays empty


@final
class Topic:
    """All records of one kind, place and thing.

    has_subscribers: anybody is told of them. needs_details: somebody looks at more of them than time and value.
    places: of which of them somebody wants the place in the firmware, whose working out costs more than all else.
    """

    __slots__ = (
        "_callbacks",
        "_keepers",
        "_kind",
        "_last_keeper",
        "_last_listener",
        "_listeners",
        "_recorder",
        "_step",
        "_what",
        "_where",
        "has_subscribers",
        "needs_details",
        "places",
    )

    def __init__(self, recorder: Recorder, kind: Kind, where: str, what: str) -> None:
        self.has_subscribers = self.needs_details = False
        self.places = NOWHERE
        self._recorder = recorder
        self._kind = kind
        self._where = where
        self._what = what
        self._listeners: _ListenerEntry | None = None  # the first of a chain
        self._last_listener: _ListenerEntry | None = None
        self._keepers: _KeeperEntry | None = None
        self._last_keeper: _KeeperEntry | None = None
        self._step: int = 0 if kind in DERIVED else 1  # from the number of the record before
        self._callbacks: list[RecordCallback] = _NO_CALLBACKS

    def add(self, party: Party) -> None:
        """Somebody more is told, if it has any use for these records."""
        if isinstance(party, Listener):
            subscriber = _ListenerEntry()
            subscriber.listener, subscriber.following = party, None
            subscriber.tag = party.tag_of(self._kind, self._where, self._what)
            if subscriber.tag == UNWANTED:
                return
            if self._last_listener is None:
                self._listeners = subscriber
            else:
                self._last_listener.following = subscriber
            self._last_listener = subscriber
        elif isinstance(party, RecordSink):
            writer = _KeeperEntry()
            writer.keeper, writer.following = party, None
            writer.tag = party.tag_of(self._kind, self._where, self._what)
            if writer.tag == UNWANTED:
                return
            if self._last_keeper is None:
                self._keepers = writer
            else:
                self._last_keeper.following = writer
            self._last_keeper = writer
            self.places = max(self.places, party.places(writer.tag))
        else:
            self._callbacks = [*self._callbacks, party]
            self.places = EVERYWHERE
        self.has_subscribers = True
        self.needs_details = self._keepers is not None or bool(self._callbacks)

    def makes_records(self) -> bool:
        """As `Recorder.makes_records`, of this topic."""
        return bool(self._callbacks)

    def close(self) -> None:
        """Nobody is told any more."""
        self._listeners = self._last_listener = None
        self._keepers = self._last_keeper = None
        self._callbacks = _NO_CALLBACKS
        self.has_subscribers = self.needs_details = False
        self.places = NOWHERE

    def emit(self, tick: int, value: int = 0, text: Text = "", field: Text = "") -> int:
        """Return the number of the new record. Its cause is the record being worked under."""
        recorder = self._recorder
        number = recorder.number + self._step
        recorder.number = number
        subscriber = self._listeners
        while subscriber is not None:
            subscriber.listener.on_record(subscriber.tag, tick, value)
            subscriber = subscriber.following
        if self.needs_details:
            cause = recorder.cause
            writer = self._keepers
            while writer is not None:
                writer.keeper.keep(writer.tag, number, tick, value, text, cause, field)
                writer = writer.following
            if self._callbacks:
                record = _made(Record, (number, tick, self._kind, self._where, self._what, value, text, cause, field))
                for callback in self._callbacks:
                    callback(record)
        return number


@final
class Recorder:
    """Numbers records and hands each to those who asked for its kind and have a use for it.

    cause: the record under whose effects the simulation runs now; `core.socket` and
    `core.wire` set it around each delivery. number: of the last record.
    """

    STATE = State(records="number cause")

    def __init__(self) -> None:
        self.cause = 0
        self.number = 0
        self._topics: dict[tuple[Kind, str, str], Topic] = {}
        self._parties: dict[Kind, list[tuple[Party, Things | None]]] = {kind: [] for kind in Kind}
        self._of_all: set[Kind] = set()
        self._subjects: dict[Kind, set[str]] = {kind: set() for kind in Kind}

    def subscribe(
        self, kinds: Iterable[Kind], party: Party, only: Subjects | None = None, things: Things | None = None
    ) -> None:
        """`party` is told of every record of these kinds; of a listener or a keeper, of those that it gave a tag.

        only: subjects that are enough for it, of kinds that have any: EDGE and FRAME wires; FLAG and ACCESS registers,
        with unit and module ("dsp.I2C-A.I2CSTR").
        It may still be told of others, which others want.
        things: kinds and things of all records that it has a use for; of others it is not even asked for a tag.
        """
        for kind in kinds:
            self._parties[kind].append((party, things))
            if only is None or kind not in only:
                self._of_all.add(kind)
            else:
                self._subjects[kind].update(only[kind])
            for (of, _, what), topic in self._topics.items():
                if of is kind and (things is None or (kind, what) in things):
                    topic.add(party)

    def close(self) -> None:
        """Nobody is told of anything any more."""
        for parties in self._parties.values():
            parties.clear()
        for topic in self._topics.values():
            topic.close()

    def wants(self, kind: Kind, subject: str | None = None) -> bool:
        """Whether anybody wants records of this kind; of this subject, if one is given."""
        if subject is None:
            return bool(self._parties[kind])
        return kind in self._of_all or subject in self._subjects[kind]

    @property
    def names_things(self) -> bool:
        """True if a subscriber names the things that it has a use for."""
        return any(things is not None for parties in self._parties.values() for _, things in parties)

    def named_things(self, kind: Kind) -> set[str]:
        """Return the things of this kind that subscribers name; a subscriber to all of a kind names none."""
        return {what for _, things in self._parties[kind] for of, what in things or () if of is kind}

    def makes_records(self, kind: Kind) -> bool:
        """Whether somebody is told of this kind as a Record, and so may look about and keep what it finds."""
        return any(not isinstance(party, Listener | RecordSink) for party, _ in self._parties[kind])

    def subjects(self, kind: Kind) -> frozenset[str] | None:
        """The subjects that somebody wants; None for all."""
        return None if kind in self._of_all else frozenset(self._subjects[kind])

    def named(self, kind: Kind) -> frozenset[str]:
        """The subjects that somebody wants by name, whoever wants all."""
        return frozenset(self._subjects[kind])

    def topic(self, kind: Kind, where: str, what: str) -> Topic:
        """The records of one kind, place and thing, for whoever makes them often."""
        topic = self._topics.get((kind, where, what))
        if topic is None:
            topic = self._topics[kind, where, what] = Topic(self, kind, where, what)
            thing = kind, what
            for party, things in self._parties[kind]:
                if things is None or thing in things:
                    topic.add(party)
        return topic

    def carried(self, action: Callable[[], None]) -> Callable[[], None]:
        """The action, for a later time, as an effect of the record being worked under now."""
        return partial(self._under, self.cause, action) if self.cause else action

    def _under(self, cause: int, action: Callable[[], None]) -> None:
        outer, self.cause = self.cause, cause
        action()
        self.cause = outer

    def emit(
        self, tick: int, kind: Kind, where: Text, what: Text, value: BigInt = 0, text: Text = "", field: Text = ""
    ) -> int:
        """The number of the new record of a topic."""
        return self.topic(kind, where, what).emit(tick, value, text, field)
