"""Measures of events as text: "from EVENT to EVENT" goes in; what is measured, between which events, comes out.

    text --> words --> Said(form, events or names, rule) ; BadEvent says what was found where what was expected

    measure = "from" event "to" event [ "," rule ]
            | ( "period" | "jitter" | "count" ) "of" event
            | "level" "of" field
            | "interrupt" "latency" vector
            | [ "each" ] "time" "in" state
            | "cpu" "load" [ "of" unit ]
            | "bus" "load"
            | "slack"
            | "race" ( field | register )
            | "lost" "flags" [ register ]
            | "cleared" "along" field
            | "value" "error" [ "of" chip ] [ "at" ( "first" "bit" | "frame" ) ]
    state   = span | "flag" field "=" number | "wire" wire ( "high" | "low" )
            | "bus" ( "busy" | "free" ) | "interrupt" vector
    rule    = "next" | "same" "transfer" | "same" "round"
    event   = see `events`
    field, register, vector, span: [ unit ":" ] name; a name with blanks stands in quotes

Words stand apart by blanks; a span's name may have several words before "begin" or "end", and stands in quotes
where its first word is one that begins another state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

from ..devices.sensor_head import CHIPS
from .events import Event, read_event
from .names import BadEvent
from .words import Words

FORMS = {
    "from": "from EVENT to EVENT",
    "period": "period of EVENT",
    "jitter": "jitter of EVENT",
    "count": "count of EVENT",
    "level": "level of MODULE.REGISTER.FIELD",
    "interrupt": "interrupt latency NAME",
    "time": "time in STATE",
    "each": "each time in STATE",
    "cpu": "cpu load",
    "bus": "bus load",
    "slack": "slack",
    "race": "race MODULE.REGISTER.FIELD",
    "lost": "lost flags",
    "cleared": "cleared along MODULE.REGISTER.FIELD",
    "value": "value error of CHIP",
}
RULES = ("next", "same transfer", "same round")
LEVELS = ("high", "low")
BUS_STATES = ("busy", "free")


@dataclass(frozen=True)
class During:
    """A state: it begins with one of `enters` and is over with one of `leaves` that is none of `enters`."""

    text: str
    enters: tuple[Event, ...]
    leaves: tuple[Event, ...]


@dataclass(frozen=True)
class Said:
    """form: a key of FORMS. events: those named. rule: which of them belong together, or of values the instant.

    unit, name: of a field, vector, unit or chip. state: of times in one.
    """

    form: str
    events: tuple[Event, ...] = ()
    rule: str = "next"
    unit: str = ""
    name: str = ""
    state: During | None = None


def is_form(text: str) -> bool:
    """Whether a measure's text is one of this language, right or wrong."""
    return text.split(" ", 1)[0].rstrip(",") in FORMS


def near_form(text: str) -> str:
    """The form whose first word is nearly the text's; empty if none is."""
    close = get_close_matches(text.split(" ", 1)[0], list(FORMS), 1, 0.75)
    return FORMS[close[0]] if close else ""


def measure_of(text: str) -> Said:
    """What a measure's text says. BadEvent otherwise."""
    words = Words(text)
    said = _MEASURES[words.one_of(list(FORMS))](words)
    words.end()
    return said


def name_text(unit: str, name: str) -> str:
    return f"{unit}:{name}" if unit else name


def _from(words: Words) -> Said:
    begin = read_event(words)
    words.one_of(["to"])
    end = read_event(words)
    rule = "next"
    if words.took(",") or words.next in ("next", "same"):
        rule = words.one_of(["next", "same"])
        if rule == "same":
            rule = f"same {words.one_of(['transfer', 'round'])}"
    return Said("from", (begin, end), rule)


def _of_event(form: str) -> Callable[[Words], Said]:
    def parse(words: Words) -> Said:
        words.one_of(["of"])
        return Said(form, (read_event(words),))

    return parse


def _level(words: Words) -> Said:
    words.one_of(["of"])
    unit, name = words.name("a field")
    return Said("level", unit=unit, name=name)


def _latency(words: Words) -> Said:
    words.one_of(["latency"])
    unit, name = words.name("an interrupt's name")
    return Said("interrupt", unit=unit, name=name)


def _time(form: str) -> Callable[[Words], Said]:
    def parse(words: Words) -> Said:
        if form == "each":
            words.one_of(["time"])
        words.one_of(["in"])
        begin = words.place
        state = _STATES.get(words.next, _span_state)
        enters, leaves = state(words)
        return Said(form, state=During(words.between(begin), enters, leaves))

    return parse


States = tuple[tuple[Event, ...], tuple[Event, ...]]


def _span_state(words: Words) -> States:
    words.took("span")
    begin = words.place
    unit, name = words.name("a span's name")
    while words.next:
        name += f" {words.take('a span')}"
    text = f"span {words.between(begin)}"
    return (Event("span", f"{text} begin", unit, name, "begin"),), (Event("span", f"{text} end", unit, name, "end"),)


def _flag_state(words: Words) -> States:
    begin = words.place
    words.one_of(["flag"])
    unit, name = words.name("a field")
    place = words.between(begin)
    words.one_of(["="])
    number = words.number(0xFFFFFFFF)
    if number is None:
        raise BadEvent(f"{words.text!r}: a number is expected after =")
    enters = Event("flag", words.between(begin), unit, name, "=", number)
    return (enters,), (Event("flag", f"{place} change", unit, name, "change"),)


def _wire_state(words: Words) -> States:
    words.one_of(["wire"])
    name = words.name("a wire")[1]
    edges = [Event("edge", f"edge {name} {how}", "", name, how) for how in ("rise", "fall")]
    if words.one_of(list(LEVELS)) == "low":
        edges.reverse()
    return (edges[0],), (edges[1],)


def _bus_state(words: Words) -> States:
    words.one_of(["bus"])
    begins = (Event("bus", "bus START", "", "START"),)
    ends = tuple(Event("bus", f"bus {name}", "", name) for name in ("STOP", "arbitration lost"))
    return (begins, ends) if words.one_of(list(BUS_STATES)) == "busy" else (ends, begins)


def _routine_state(words: Words) -> States:
    words.one_of(["interrupt"])
    begin = words.place
    unit, name = words.name("an interrupt's name")
    text = f"interrupt {words.between(begin)}"
    enters, leaves = (Event("interrupt", f"{text} {how}", unit, name, how) for how in ("enter", "leave"))
    return (enters,), (leaves,)


_STATES: dict[str, Callable[[Words], States]] = {
    "span": _span_state,
    "flag": _flag_state,
    "wire": _wire_state,
    "bus": _bus_state,
    "interrupt": _routine_state,
}


def _cpu(words: Words) -> Said:
    words.one_of(["load"])
    return Said("cpu", unit=words.take("a unit") if words.took("of") else "")


def _bus_load(words: Words) -> Said:
    words.one_of(["load"])
    return Said("bus")


def _race(words: Words) -> Said:
    unit, name = words.name("a field or a register")
    return Said("race", unit=unit, name=name)


def _lost(words: Words) -> Said:
    words.one_of(["flags"])
    unit, name = words.name("a register") if words.next else ("", "")
    return Said("lost", unit=unit, name=name)


def _cleared(words: Words) -> Said:
    words.one_of(["along"])
    unit, name = words.name("a field")
    return Said("cleared", unit=unit, name=name)


def _value(words: Words) -> Said:
    words.one_of(["error"])
    chip = words.one_of(list(CHIPS)) if words.took("of") else ""
    instant = "first bit"
    if words.took("at"):
        instant = words.one_of(["first", "frame"])
        if instant == "first":
            instant = f"first {words.one_of(['bit'])}"
    return Said("value", rule=instant, name=chip)


_MEASURES: dict[str, Callable[[Words], Said]] = {
    "from": _from,
    "period": _of_event("period"),
    "jitter": _of_event("jitter"),
    "count": _of_event("count"),
    "level": _level,
    "interrupt": _latency,
    "time": _time("time"),
    "each": _time("each"),
    "cpu": _cpu,
    "bus": _bus_load,
    "slack": lambda words: Said("slack"),
    "race": _race,
    "lost": _lost,
    "cleared": _cleared,
    "value": _value,
}
