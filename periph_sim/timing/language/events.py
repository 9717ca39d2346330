"""Named events: their syntax, and the matchers of their records.

    event   = one { "or" one } | ( "first" | "last" | number ( "st" | "nd" | "rd" | "th" ) ) one "of" group
    group   = "transfer" | "round" | "burst" | "interrupt" vector
    one     = "edge" wire ( "rise" | "fall" | "change" )
            | "flag" field ( "rise" | "fall" | "change" | "=" number )
            | "access" ( ( "R" | "W" ) register | "by" unit )
            | "interrupt" vector ( "enter" | "leave" )
            | "span" span ( "begin" | "end" )                    unit "any": in any unit
            | "bus" ( "START" | "repeated" "START" | "STOP" | "arbitration" "lost" | "stuck" | "clear"
                    | "NACK" [ "address" | "byte" ] | "byte" [ number ]
                    | "address" [ number ] [ "read" | "write" ] [ "ACK" | "NACK" ] )
            | "frame" [ line ] [ number ] [ "begin" | "end" | "error" | "cut" | "collision" ]
            | "variable" variable ( "change" | "=" number )
            | "note" [ unit ":" ] ( "duty" | "lost" | "unknown" | "overflow" )
            | "record" ( "transfer" | "round" | "receiver" | "data" | "bus" ) thing [ "of" ( chip | unit | number ) ]

    text --event_of--> Event + Scope --matcher--> Matcher

`thing` names a derived record (see `timing/derived`). `EVENTS` lists the kinds of events.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache

from msgspec import Struct
from msgspec.structs import replace

from ...core.phrases import did_you_mean
from ...core.records import Kind
from ...devices.sensor_rounds import known_sensors
from .matcher import ANYTHING, EVERYTHING, Group, Matcher
from .scope import LINES, RECORDS, BadEvent, Scope
from .tokens import Words, name_text

CHANGES = ("rise", "fall", "change")
NOTES = ("duty", "lost", "unknown", "overflow")
BUS = ("START", "repeated START", "STOP", "address", "byte", "arbitration lost", "stuck", "clear", "NACK")
OF_AGENT = ("arbitration lost", "clear")  # events that only the controller of a case records
WAYS, ACKS = ("read", "write"), ("ACK", "NACK")
OF_PAIRS = ("cut", "collision")
FRAME_PARTS = ("begin", "end", "error", *OF_PAIRS)
# In the text of a measure, only these words can follow an event; "" is the end of the text.
BEHIND_EVENTS = ("", "to", "from", "or", "of", "at", ",", "in", "next", "last", "same")
NTH = re.compile(r"(\d+)(st|nd|rd|th)")
GROUPS = ("transfer", "round", "burst", "interrupt")
ANY_UNIT = "any"


class Event(Struct, frozen=True):
    """An event that the text of a measure names.

    kind: the first word of the event.
    unit: the unit that the text names, or for a record the unit or chip; "" if it names none.
    name: the wire, field, span or other thing that the event is about; for a record its kind, such as "round".
    how: the kind of change ("rise", "begin", ...), the direction of an access, or the thing of a record.
    number: the value that the text gives; None if it gives no value.
    others: alternative events, joined by "or".
    nth: the number of the event that counts in each group, from 1; -1 for the last event; 0 if every event counts.
    group: the kind of group, such as "transfer"; "" if every event counts.
    routine: the interrupt whose service routine is the group; "" for other groups.
    """

    kind: str
    text: str
    unit: str = ""
    name: str = ""
    how: str = ""
    number: int | None = None
    others: tuple[Event, ...] = ()
    nth: int = 0
    group: str = ""
    routine: str = ""


@lru_cache(maxsize=1024)  # the scenes of one case name the same events
def event_of(text: str) -> Event:
    """Return the event that a text names. Raise BadEvent if it names none."""
    words = Words(text)
    event = read_event(words)
    words.end()
    return event


def read_event(words: Words) -> Event:
    """Read the next event from the words of a text. Raise BadEvent if the next words do not name an event."""
    begin = words.place
    nth = _read_nth(words)
    first = _read_one(words)
    if nth:
        words.one_of(["of"])
        group = words.one_of(list(GROUPS))
        routine = name_text(*words.name("an interrupt's name")) if group == "interrupt" else ""
        return replace(first, text=words.between(begin), nth=nth, group=group, routine=routine)
    others = []
    while words.took("or"):
        others.append(_read_one(words))
    return replace(first, text=words.between(begin), others=tuple(others)) if others else first


def _read_nth(words: Words) -> int:
    """Read an ordinal such as "3rd" and return its number, or -1 for "last".

    If the next word is not an ordinal, read nothing and return 0.
    """
    for word, nth in (("first", 1), ("last", -1)):
        if words.took(word):
            return nth
    found = NTH.fullmatch(words.next)
    if found is None:
        return 0
    if not int(found[1]):
        raise BadEvent(f"{words.text!r}: {found[0]!r}, but counting begins with 1st")
    words.take("a number")
    return int(found[1])


def _read_one(words: Words) -> Event:
    begin = words.place
    kind = words.one_of(list(EVENTS))
    unit, name, how, number = EVENTS[kind][0](words)
    return Event(kind, words.between(begin), unit, name, how, number)


def matcher(event: Event | str, scope: Scope) -> Matcher:
    """Return the test of whether a record is an event. Raise BadEvent if the event cannot happen in this scene."""
    if isinstance(event, str):
        event = event_of(event)
    found = EVENTS[event.kind][1](event, scope)
    if event.others:
        return replace(found, others=tuple(matcher(other, scope) for other in event.others))
    return replace(found, nth=event.nth, group=group_of(event, scope)) if event.nth else found


def group_of(event: Event, scope: Scope) -> Group:
    """Return the group in which an event is counted. Raise BadEvent if the scene does not have this group."""
    if event.group not in ("burst", "interrupt"):
        return stretch_of(event.group, scope, f"{event.text!r}: a {event.group}")
    what, ends = f"interrupt {event.routine}", ("enter", "leave")
    if event.group == "burst":
        if event.kind != "frame":
            raise BadEvent(f"{event.text!r}: a burst is one of frames; write of transfer or of round")
        what, ends = f"frame {event.name}", ("begin", "end")
    return Group(event.group, *(matcher(f"{what} {how}", scope) for how in ends))


def stretch_of(name: str, scope: Scope, whose: str, hint: str = "") -> Group:
    """Return a Group for transfers or for rounds. Raise BadEvent if the scene has no bus, or no rounds.

    name: "transfer" or "round". whose, hint: the first and the last words of the error's text.
    """
    if not (scope.rounds if name == "round" else scope.bus):
        needs = "[controller] or [rounds]" if name == "round" else "SCL and SDA"
        raise BadEvent(f"{whose} needs {needs} in the scene, which has none{hint}")
    return Group(name, matcher("bus START", scope), matcher("bus STOP", scope))


Parts = tuple[str, str, str, int | None]


def _read_named(expected: str, *hows: str) -> Callable[[Words], Parts]:
    """Return a function that reads a name and one of the words `hows` after the name.

    expected: a description of the name for messages.
    """

    def read(words: Words) -> Parts:
        unit, name = words.name(expected)
        how = words.one_of(list(hows))
        return unit, name, how, words.value() if how == "=" else None

    return read


def _read_access(words: Words) -> Parts:
    way = words.one_of(["R", "W", "by"])
    if way == "by":
        return words.take("a unit"), "", way, None
    return *words.name("a register"), way, None


def _read_span(words: Words) -> Parts:
    unit, name = words.name("a span's name")
    while words.next and words.next not in ("begin", "end", "to", ","):
        name += f" {words.take('begin or end')}"
    return unit, name, words.one_of(["begin", "end"]), None


def _read_bus(words: Words) -> Parts:
    what = words.one_of([name.split()[0] for name in BUS])
    if more := [name.split()[1] for name in BUS if name.startswith(f"{what} ")]:
        return "", f"{what} {words.one_of(more)}", "", None
    if what == "NACK":
        return "", what, words.one_of(["address", "byte"]) if words.next in ("address", "byte") else "", None
    if what == "address":
        number = words.number(0x7F)
        return "", what, " ".join(words.take("a word") for choices in (WAYS, ACKS) if words.next in choices), number
    return "", what, "", words.number(0xFF) if what == "byte" else None


def _read_frame(words: Words) -> Parts:
    named = words.next not in (*FRAME_PARTS, *BEHIND_EVENTS) and not words.next[:1].isdigit()
    wire = words.take("a line") if named else LINES[0]
    number = words.number(0xFF)
    if words.next in FRAME_PARTS:
        return "", wire, words.one_of(list(FRAME_PARTS)), number
    return "", wire, "begin" if number is None else "end", number  # a frame's value is known at its end


def _read_note(words: Words) -> Parts:
    unit, name = words.name("a note's code")
    if name not in NOTES:
        raise BadEvent(f"{words.text!r}: there is no note {name!r}; {did_you_mean(name, NOTES)}")
    return unit, name, "", None


def _read_record(words: Words) -> Parts:
    kind = words.one_of(list(RECORDS))
    thing = words.phrase(list(RECORDS[kind]))
    of = "chip" if kind == "data" else RECORDS[kind][thing].of
    if not of or not words.took("of"):
        return "", kind, thing, None
    if of == "address":
        return "", kind, thing, words.address()
    return words.one_of(list(known_sensors())) if of == "chip" else words.take("a unit"), kind, thing, None


def _match_edge(event: Event, scope: Scope) -> Matcher:
    return Matcher(event.text, Kind.EDGE, frozenset((scope.wire(event.name),)), "level", *_values(event))


def _values(event: Event) -> tuple[int, int]:
    """Return `mask` and `want` of the matcher for the change or the value in an event."""
    if event.how == "change":
        return 0, 0
    return EVERYTHING, {"rise": 1, "fall": 0}.get(event.how, event.number or 0)


def _match_flag(event: Event, scope: Scope) -> Matcher:
    unit, module, register, field = scope.field(event.unit, event.name)
    width = field.msb - field.lsb + 1
    if event.number is not None and event.number >> width:
        raise BadEvent(f"{event.name} has {width} bits and so is never {event.number:#x}")
    if width > 1 and event.how in ("rise", "fall"):
        raise BadEvent(f"{event.name} has {width} bits and so does not {event.how}; write change, or = and a value")
    place = frozenset((f"{unit}.{module}",))
    return Matcher(event.text, Kind.FLAG, place, f"{register.name}.{field.name}", *_values(event))


def _match_access(event: Event, scope: Scope) -> Matcher:
    if event.how == "by":
        return Matcher(event.text, Kind.ACCESS, frozenset((scope.unit(event.unit),)), ANYTHING)
    unit, module, register = scope.register(event.unit, event.name)
    return Matcher(event.text, Kind.ACCESS, frozenset((unit,)), f"{event.how} {module}.{register.name}")


def _match_interrupt(event: Event, scope: Scope) -> Matcher:
    unit = scope.vector(event.unit, event.name)
    return Matcher(event.text, Kind.IRQ, frozenset((unit,)), event.name, EVERYTHING, int(event.how == "enter"))


def _match_span(event: Event, scope: Scope) -> Matcher:
    begins = int(event.how == "begin")
    if event.unit == ANY_UNIT:
        if len(scope.units) == 1:
            scope.span("", event.name)
        return Matcher(event.text, Kind.SPAN, None, event.name, EVERYTHING, begins, free=True)
    unit, known = scope.span(event.unit, event.name)
    return Matcher(event.text, Kind.SPAN, frozenset((unit,)), event.name, EVERYTHING, begins, free=not known)


def _match_bus(event: Event, scope: Scope) -> Matcher:
    if not (scope.controller if event.name in OF_AGENT else scope.bus):
        needs = "[controller]" if event.name in OF_AGENT else "SCL and SDA"
        raise BadEvent(
            f"{event.text!r} needs {needs} in the scene, which has none; give it [controller], or a unit I2C-A"
        )
    mask = want = 0
    if event.name == "address":  # bits of the value: NACK (0), R/W (1), address (2 and up)
        mask, want = (0, 0) if event.number is None else (-4, event.number << 2)
        for word in event.how.split():
            bit = 2 if word in WAYS else 1
            mask, want = mask | bit, want | (bit if word in ("read", "NACK") else 0)
    elif event.name == "NACK" and event.how:
        mask, want = EVERYTHING, int(event.how == "byte")
    elif event.number is not None:
        mask, want = -2, event.number << 1
    return Matcher(event.text, Kind.BUS, None, event.name, mask, want)


def _match_frame(event: Event, scope: Scope) -> Matcher:
    if event.name not in scope.lines:
        if event.name in LINES:
            # The lines whose names are longer than RX or TX, such as SCI-B.RX or left.SCI-A.TX.
            named = [line for line in scope.lines if "." in line]
            alike = [line for line in named if line.endswith(f".{event.name}")]
            hint = f"write frame {' or '.join(alike or named)}" if named else "give a unit SCI-A"
            raise BadEvent(f"{event.text!r} needs {event.name} in the scene, which has no such wire; {hint}")
        hint = did_you_mean(event.name, [*scope.lines, *FRAME_PARTS[:3]])
        raise BadEvent(f"{event.text!r}: there is no serial line {event.name!r}; {hint}")
    if event.how in OF_PAIRS and event.name not in scope.pairs:
        hint = f"write frame {scope.pairs[0]} {event.how}" if scope.pairs else "give a [[transceiver]]"
        raise BadEvent(f"{event.text!r}: only on an RS-485 pair is a frame {event.how}; {hint}")
    wire = frozenset((event.name,))
    if event.number is None:
        return Matcher(event.text, Kind.FRAME, wire, event.how)
    if event.how == "begin":
        what = "what a frame carries is known at its end"
        raise BadEvent(f"{event.text!r}: {what}; write {event.text.removesuffix(' begin')} end")
    return Matcher(event.text, Kind.FRAME, wire, event.how, EVERYTHING, event.number)


def _match_variable(event: Event, scope: Scope) -> Matcher:
    place = frozenset((f"{scope.variable(event.unit, event.name)}.memory",))
    return Matcher(event.text, Kind.FLAG, place, event.name, *_values(event))


def _match_note(event: Event, scope: Scope) -> Matcher:
    return Matcher(event.text, Kind.NOTE, scope.places(event.unit), event.name)


def _match_record(event: Event, scope: Scope) -> Matcher:
    thing = RECORDS[event.name][event.how]
    place = frozenset((scope.unit(event.unit) if thing.of else event.unit,)) if event.unit else None
    value = (0, 0) if event.number is None else (EVERYTHING, event.number)
    return Matcher(event.text, Kind(event.name), place, event.how, *value, thing=thing)


# EVENTS maps the first word of an event to the parser of the next words and the function that makes the matcher.
EVENTS: dict[str, tuple[Callable[[Words], Parts], Callable[[Event, Scope], Matcher]]] = {
    "edge": (_read_named("a wire", *CHANGES), _match_edge),
    "flag": (_read_named("a field", *CHANGES, "="), _match_flag),
    "access": (_read_access, _match_access),
    "interrupt": (_read_named("an interrupt's name", "enter", "leave"), _match_interrupt),
    "span": (_read_span, _match_span),
    "bus": (_read_bus, _match_bus),
    "frame": (_read_frame, _match_frame),
    "variable": (_read_named("a variable of an image", "change", "="), _match_variable),
    "note": (_read_note, _match_note),
    "record": (_read_record, _match_record),
}
