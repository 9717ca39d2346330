"""Records of a run and the subscriptions to them.

A record is one noted event. It has a kind, a number, a time in ticks, a place, and the number of the record that caused
it (0: none). Producers call `Recorder.wants` to find out whether a kind has subscribers; most of them do so only once,
when a scene is built. Records without a subscriber are not made.
A subscription to edges, frames, flags or accesses can be limited to some wires or registers: its subjects.

    producer --> Topic.emit --> listeners: tag, tick, value            (budgets)
                           '--> sinks: all fields, as plain arguments  (recording files, detection of races)
                           '--> callbacks: a Record                    (text files, diagrams)

All records with the same kind, the same place (`where`, such as a wire or a module) and the same thing (`what`, such as
a register) form a topic. `tag_of` of a listener or sink is called once for each topic. It returns the tag under which
the listener or sink receives the topic's records, or UNWANTED. So it does not have to filter records.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from enum import Enum
from typing import Any, NamedTuple, TypeAlias, final

from ..form.c_types import BigInt, Text
from .state import State


class Kind(Enum):
    EDGE = "edge"  # a wire changed: value = its level, text = the pulling parties
    ACCESS = "access"  # a CPU access: what = R or W with the register, value = the word
    FLAG = "flag"  # hardware or an access changed a register field, or put a new word into a data field
    IRQ = "irq"  # an interrupt is requested, entered or left
    SPAN = "span"  # a part of the firmware to which the firmware gave a name begins (value 1) or ends (value 0)
    BUS = "bus"  # an event on an I2C bus: START, STOP, address, byte, NACK, arbitration lost, bus clear, a stuck line
    FRAME = "frame"  # an event on a UART line: a frame begins, ends, is invalid or is cut; a byte is sent; a collision
    NOTE = "note"  # a note for the user, such as: firmware broke a rule of the manual, or data was lost (`chip.Note`)
    WAIT = "wait"  # firmware begins (value 1) or ends (value 0) a wait: what = the fields that it polls, or IDLE
    HOLD = "hold"  # the set of parties that pull a wire has changed, and the wire stays low: text = the pulling parties
    # The records of the following kinds are derived. Objects that `scene/derived_records.py` attaches make them from
    # transfers, frames, wires and other records, but only if a subscriber names them (argument `things` of
    # `Recorder.subscribe`). A derived record has no number of its own, but that of the last record that is not derived.
    # Its tick may be earlier than the tick of that record.
    TRANSFER = "transfer"  # a complete I2C transfer: its phases, acknowledges, stretches
    ROUND = "round"  # a round, one execution of the controller's periodic list of requests, is due, complete or missed
    RECEIVER = "receiver"  # an SCI's number of waiting words changes, or a character is received or lost
    DATA = "data"  # bytes that were read, with their correctness, age or error

    __hash__ = object.__hash__  # the hash of the object's identity, because the hash method of Enum is slow


TIMED_OUT = "timeout"  # the text of the WAIT record at the end of a wait that timed out; "" if the wait ended otherwise
DERIVED = frozenset({Kind.TRANSFER, Kind.ROUND, Kind.RECEIVER, Kind.DATA})
RECORDED = tuple(kind for kind in Kind if kind not in DERIVED)  # the kinds that a recording of a whole run contains


class Record(NamedTuple):
    """One record. field: the register field that the firmware named in an access; "" for the whole register."""

    number: int
    tick: int
    kind: Kind
    where: str
    what: str
    value: int
    text: str
    cause: int
    field: str = ""


_made = tuple.__new__  # makes a Record faster than `Record(...)`, which calls a Python function

RecordCallback = Callable[[Record], None]
Party: TypeAlias = "Listener | RecordSink | RecordCallback"
Subjects = Mapping[Kind, Collection[str]]
Things = Collection[tuple[Kind, str]]


UNWANTED = -1  # the result of `tag_of` for a topic that the subscriber does not need
NOWHERE, OF_MODIFIES, EVERYWHERE = range(3)  # the values that the method `RecordSink.places` returns


class Listener:
    """A subscriber that needs only the time and value of each record, such as a measure."""

    __slots__ = ()

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Return the tag under which `on_record` receives this topic; UNWANTED if the listener does not need it."""
        raise NotImplementedError

    def on_record(self, tag: int, tick: int, value: int) -> None:
        """Handle a record. tag: the result of `tag_of` for the topic of the record."""
        raise NotImplementedError


class RecordSink:
    """A subscriber that needs all fields of each record, but no Record object."""

    __slots__ = ()

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Return the tag under which `keep` receives this topic; UNWANTED if the sink does not need it."""
        raise NotImplementedError

    def places(self, tag: int) -> int:
        """Return for which accesses the sink needs the place in the firmware.

        Finding a place takes much time, so it is only done where a sink needs it.
        NOWHERE: for no access.
        OF_MODIFIES: for accesses that may belong to a read-modify-write; these are all accesses except reads of a
            single field.
        EVERYWHERE: for all accesses.
        """
        return EVERYWHERE

    def keep(self, tag: int, number: int, tick: int, value: int, text: Text, cause: int, field: Text) -> None:
        """Handle a record. tag: the result of `tag_of` for the topic of the record."""
        raise NotImplementedError


@final
class _Entry:
    """One entry in a topic's linked list of listeners or of sinks. following: the next entry; None for the last entry.

    Only one of `listener` and `sink` is set.
    """

    __slots__ = ("following", "listener", "sink", "tag")

    listener: Listener
    sink: RecordSink
    tag: int
    following: _Entry | None


def _appended(first: _Entry | None, entry: _Entry) -> _Entry:
    """Append an entry to a linked list, and return the first entry of the list."""
    if first is None:
        return entry
    last = first
    while last.following is not None:
        last = last.following
    last.following = entry
    return first


_NO_CALLBACKS: list[Any] = []  # shared by all topics without callbacks, so it must stay empty


@final
class Topic:
    """All records of one kind, one place and one thing.

    has_subscribers: True if any subscriber receives these records.
    needs_details: True if any subscriber receives more than the time and the value of each record.
    places: for which accesses any subscriber needs the place in the firmware: NOWHERE, OF_MODIFIES or EVERYWHERE, as
        `RecordSink.places` returns it.
    """

    __slots__ = (
        "_callbacks",
        "_kind",
        "_listeners",
        "_recorder",
        "_sinks",
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
        self._listeners: _Entry | None = None  # the first entry in the linked list of listeners
        self._sinks: _Entry | None = None
        self._step: int = 0 if kind in DERIVED else 1  # by how much `Recorder.number` increases with each record
        self._callbacks: list[RecordCallback] = _NO_CALLBACKS

    def add(self, party: Party) -> None:
        """Add a subscriber, unless its tag for this topic is UNWANTED."""
        if isinstance(party, Listener | RecordSink):
            entry = _Entry()
            entry.tag, entry.following = party.tag_of(self._kind, self._where, self._what), None
            if entry.tag == UNWANTED:
                return
            if isinstance(party, Listener):
                entry.listener = party
                self._listeners = _appended(self._listeners, entry)
            else:
                entry.sink = party
                self._sinks = _appended(self._sinks, entry)
                self.places = max(self.places, party.places(entry.tag))
        else:
            self._callbacks = [*self._callbacks, party]
            self.places = EVERYWHERE
        self.has_subscribers = True
        self.needs_details = self._sinks is not None or bool(self._callbacks)

    def makes_records(self) -> bool:
        """Return True if a callback receives this topic as Record objects."""
        return bool(self._callbacks)

    def close(self) -> None:
        """Remove all subscribers."""
        self._listeners = self._sinks = None
        self._callbacks = _NO_CALLBACKS
        self.has_subscribers = self.needs_details = False
        self.places = NOWHERE

    def emit(self, tick: int, value: int = 0, text: Text = "", field: Text = "") -> int:
        """Make a record and return its number. The cause of the record is `Recorder.cause`."""
        recorder = self._recorder
        number = recorder.number + self._step
        recorder.number = number
        subscriber = self._listeners
        while subscriber is not None:
            subscriber.listener.on_record(subscriber.tag, tick, value)
            subscriber = subscriber.following
        if self.needs_details:
            cause = recorder.cause
            writer = self._sinks
            while writer is not None:
                writer.sink.keep(writer.tag, number, tick, value, text, cause, field)
                writer = writer.following
            if self._callbacks:
                record = _made(Record, (number, tick, self._kind, self._where, self._what, value, text, cause, field))
                for callback in self._callbacks:
                    callback(record)
        return number


@final
class Recorder:
    """Numbers records and passes each to the subscribers to its topic.

    cause: the number of the present record, whose effects the simulation runs now; 0 if there is none. New records get
        it as their cause. Samplers, sockets and CPUs set it while they run the effects of a record.
    number: the number of the last record.
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
        """Subscribe `party` to the records of these kinds.

        A listener or a sink receives only the topics for which its `tag_of` returns a tag.
        only: for each kind in it, the needed subjects: wires for EDGE and FRAME; registers for FLAG and ACCESS, with
            unit and module ("dsp.I2C-A.I2CSTR"). If a kind is missing, or `only` is None, all subjects are needed. The
            party may also receive subjects that others need.
        things: the pairs of kind and thing that the party needs; `tag_of` is not called for others. None means all.
        """
        for kind in kinds:
            self._parties[kind].append((party, things))
            if only is None or kind not in only:
                self._of_all.add(kind)
            else:
                self._subjects[kind].update(only[kind])
            for (known, _, what), topic in self._topics.items():
                if known is kind and (things is None or (kind, what) in things):
                    topic.add(party)

    def close(self) -> None:
        """Remove all subscribers of all topics."""
        for parties in self._parties.values():
            parties.clear()
        for topic in self._topics.values():
            topic.close()

    def wants(self, kind: Kind, subject: str | None = None) -> bool:
        """Return True if any subscriber needs records of this kind, and of this subject if one is given."""
        if subject is None:
            return bool(self._parties[kind])
        return kind in self._of_all or subject in self._subjects[kind]

    def named_things(self, kind: Kind) -> set[str]:
        """Return the things that subscribers named for this kind. A subscriber that needs all things has named none."""
        return {what for _, things in self._parties[kind] for named, what in things or () if named is kind}

    def makes_records(self, kind: Kind) -> bool:
        """Return True if a subscriber to this kind is a callback, which receives Record objects.

        A callback may inspect the scene and keep references to its objects. Listeners and sinks receive only values.
        """
        return any(not isinstance(party, Listener | RecordSink) for party, _ in self._parties[kind])

    def subjects(self, kind: Kind) -> frozenset[str] | None:
        """Return the subjects of this kind that subscribers need; None if any subscriber needs all subjects."""
        return None if kind in self._of_all else frozenset(self._subjects[kind])

    def named(self, kind: Kind) -> frozenset[str]:
        """Return the subjects of this kind that subscribers named, even if other subscribers need all subjects."""
        return frozenset(self._subjects[kind])

    def topic(self, kind: Kind, where: str, what: str) -> Topic:
        """Return the topic of this kind, place and thing. Producers that emit often should store it."""
        topic = self._topics.get((kind, where, what))
        if topic is None:
            topic = self._topics[kind, where, what] = Topic(self, kind, where, what)
            thing = kind, what
            for party, things in self._parties[kind]:
                if things is None or thing in things:
                    topic.add(party)
        return topic

    def emit(
        self, tick: int, kind: Kind, where: Text, what: Text, value: BigInt = 0, text: Text = "", field: Text = ""
    ) -> int:
        """Make a record of the topic with this kind, place and thing, and return its number."""
        return self.topic(kind, where, what).emit(tick, value, text, field)
