"""Measures of events as text, such as "from EVENT to EVENT": their syntax and its parser.

    text --> words --> Said(form, events or names, rule), or BadEvent with the wrong word and the expected words

    measure = pair { clause }
            | ( "count" | "value" | "sum" ) "of" event { clause }
            | "count" "of" event pair { clause }
            | "period" "of" event
            | "jitter" "of" ( event | measure )
            | "level" "of" ( field | "variable" variable ) [ "at" event ]
            | "calls" "of" span
            | "stack" "high-water" [ "of" unit ]
            | "interrupt" "latency" vector [ "to" "first" "access" ]
            | "reaction" [ "of" unit ]
            | "gap" "between" "rounds"
            | "margin" "of" [ unit ":" ] "I2CDXR"
            | "SCL" "held" "per" "transfer" [ "by" unit ]
            | [ "each" ] "time" "in" state
            | "share" "of" ( "time" | "any" duration ) "in" state
            | "cpu" "load" [ "of" unit ] [ "per" duration ]
            | "bus" "load" [ "per" duration ]
            | "slack"
            | "race" ( field | register )
            | "lost" "flags" [ register ]
            | "cleared" "along" field
            | [ "model" ] "age" [ "of" chip ]
            | "value" "error" [ "of" chip ] [ "at" ( "first" "bit" | "frame" ) ]
    state   = span | ( "flag" field | "variable" variable ) "=" number | "wire" wire ( "high" | "low" )
            | "bus" ( "busy" | "free" ) | "cpu" ( "busy" | "idle" ) [ "of" unit ] | "interrupt" vector
    pair    = "from" event "to" event { "," rule }
    rule    = "in" "order" | "next" | "last" | "same" ( "transfer" | "round" | "unit" )
    clause  = "," ( "for" "each" | "measured" "at" | "given" | "unless" | "unfinished" ) event
    event   = see `events`
    field, register, vector, span, variable: [ unit ":" ] name; a name with blanks is quoted

Words are separated by blanks. A span's name may have several words before "begin" or "end"; it is quoted if its first
word begins another state.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from msgspec import Struct
from msgspec.structs import replace

from ...core.settings import duration
from ...devices.sensor_rounds import known_sensors
from .events import EVENTS, Event, read_event
from .scope import BadEvent
from .tokens import Words

CLAUSES = {
    "for": "for each",  # an event that is an occasion to measure
    "measured": "measured at",  # an event that shows that an occasion was measured, if the values do not show it
    "given": "given",  # an event without which the budget is not judged
    "unless": "unless",  # an event that cannot be judged, so the budget is not judged if it happens
    "unfinished": "unfinished",  # an event with a value that the end of the run cuts off
}
LEVELS, BUS_STATES, CPU_STATES = ("high", "low"), ("busy", "free"), ("busy", "idle")


class During(Struct, frozen=True):
    """A state of the run. It begins with an event in `enters`, and ends with an event in `leaves` but not in `enters`.

    cpu, unit: one of CPU_STATES and its unit, if the state is that of a CPU; it then has no `enters` and `leaves`.
    """

    text: str
    enters: tuple[Event, ...] = ()
    leaves: tuple[Event, ...] = ()
    cpu: str = ""
    unit: str = ""


class Said(Struct, frozen=True):
    """The parsed text of a measure.

    form: a key of FORMS. text: the whole text. events: the events that it names, in order.
    unit, name: the unit, and the field, vector or chip that it names. state: the state in which time is measured.
    pairing: one of PAIRINGS, or "". group: "transfer", "round" or "unit", if both events must be in the same one.
    instant: for a value error, "first bit" or "frame": the instant at which the true value is taken.
    window: the length of the window of a share, as text; "" for the whole run.
    of: the measure whose jitter is meant. clauses: the clauses at the end, each with its event.
    access: True if an interrupt's latency is measured up to the first access.
    """

    form: str
    events: tuple[Event, ...] = ()
    text: str = ""
    unit: str = ""
    name: str = ""
    state: During | None = None
    pairing: str = ""
    group: str = ""
    instant: str = ""
    window: str = ""
    of: Said | None = None
    access: bool = False
    clauses: tuple[tuple[str, Event], ...] = ()


def is_form(text: str) -> bool:
    """Return True if the first word of a measure's text is in FORMS. The other words are not checked."""
    return text.split(" ", 1)[0].rstrip(",") in FORMS


def near_form(text: str) -> str:
    """Return the form whose first word resembles the first word of a text; "" if there is none."""
    from difflib import get_close_matches  # imported here, because only errors need it

    close = get_close_matches(text.split(" ", 1)[0], list(FORMS), 1, 0.75)
    return FORMS[close[0]] if close else ""


@lru_cache(maxsize=1024)  # the scenes of one case have the same measures
def measure_of(text: str) -> Said:
    """Return the parsed text of a measure. Raise BadEvent if it cannot be parsed."""
    words = Words(text)
    said = _PARSERS[words.one_of(list(FORMS))](words)
    words.end()
    return replace(said, text=text)


def _from(words: Words) -> Said:
    begin = read_event(words)
    words.one_of(["to"])
    end = read_event(words)
    pairing = group = ""
    while not (pairing and group) and (
        (words.following not in CLAUSES and words.took(",")) or words.next in ("in", "next", "last", "same")
    ):
        said = words.one_of([word for word in ("in", "next", "last") if not pairing] + ["same"] * (not group))
        if said == "same":
            group = words.one_of(["transfer", "round", "unit"])
        else:
            pairing = f"in {words.one_of(['order'])}" if said == "in" else said
    return Said("from", (begin, end), pairing=pairing, group=group, clauses=_clauses(words))


def _clauses(words: Words) -> tuple[tuple[str, Event], ...]:
    found = []
    while words.following in CLAUSES and words.took(","):
        clause = CLAUSES[words.take("a clause")]
        for word in clause.split()[1:]:
            words.one_of([word])
        found.append((clause, read_event(words)))
    return tuple(found)


def _of_event(form: str, clauses: bool = True) -> Callable[[Words], Said]:
    def parse(words: Words) -> Said:
        words.one_of(["of"])
        return Said(form, (read_event(words),), clauses=_clauses(words) if clauses else ())

    return parse


def _count(words: Words) -> Said:
    words.one_of(["of"])
    counted = read_event(words)
    if not words.took("from"):
        return Said("count", (counted,), clauses=_clauses(words))
    pair = _from(words)
    return replace(pair, form="count", events=(counted, *pair.events))


def _jitter(words: Words) -> Said:
    words.one_of(["of"])
    form = words.next
    if form in EVENTS and words.following not in ("latency", "load"):
        return Said("jitter", (read_event(words),))
    if form not in FORMS:
        words.take("a measure or an event")
        return Said("jitter", name=" ".join(filter(None, (form, words.rest()))))
    words.take("a measure")
    return Said("jitter", of=_PARSERS[form](words))


def _level(words: Words) -> Said:
    words.one_of(["of"])
    kind = "variable" if words.took("variable") else "flag"
    begin = words.place
    unit, name = words.name("a variable of an image" if kind == "variable" else "a field")
    change = Event(kind, f"{kind} {words.between(begin)} change", unit, name, "change")
    events = (read_event(words),) if words.took("at") else ()
    return Said("level", (change, *events), unit=unit, name=name)


def _calls(words: Words) -> Said:
    words.one_of(["of"])
    begins, _ = _span_state(words)
    return Said("calls", begins)


def _latency(words: Words) -> Said:
    said = _phrase("interrupt", "latency", "an interrupt's name")(words)
    if words.took("to"):
        _phrase("interrupt", "first access")(words)
        return replace(said, access=True)
    return said


def _time(form: str) -> Callable[[Words], Said]:
    def parse(words: Words) -> Said:
        if form == "each":
            words.one_of(["time"])
        return Said(form, state=_during(words))

    return parse


def _share(words: Words) -> Said:
    words.one_of(["of"])
    if words.one_of(["time", "any"]) == "time":
        return Said("share", state=_during(words))
    length = []
    while words.next and words.next != "in":
        length.append(words.take("the length of a window"))
    window = _checked_window(words, " ".join(length))
    return Said("share", state=_during(words), window=window)


def _during(words: Words) -> During:
    """Read the word "in" and the state that follows it."""
    words.one_of(["in"])
    begin = words.place
    if words.next == "cpu" and words.following in CPU_STATES:
        words.take("cpu")
        cpu = words.one_of(list(CPU_STATES))
        unit = words.take("a unit") if words.took("of") else ""
        return During(words.between(begin), cpu=cpu, unit=unit)
    enters, leaves = _STATES.get(words.next, _span_state)(words)
    return During(words.between(begin), enters, leaves)


States = tuple[tuple[Event, ...], tuple[Event, ...]]


def _span_state(words: Words) -> States:
    words.took("span")
    begin = words.place
    unit, name = words.name("a span's name")
    while words.next:
        name += f" {words.take('a span')}"
    text = f"span {words.between(begin)}"
    return (Event("span", f"{text} begin", unit, name, "begin"),), (Event("span", f"{text} end", unit, name, "end"),)


def _value_state(words: Words) -> States:
    begin = words.place
    kind = words.one_of(["flag", "variable"])
    unit, name = words.name("a field" if kind == "flag" else "a variable of an image")
    place = words.between(begin)
    words.one_of(["="])
    number = words.value()
    enters = Event(kind, words.between(begin), unit, name, "=", number)
    return (enters,), (Event(kind, f"{place} change", unit, name, "change"),)


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
    "flag": _value_state,
    "variable": _value_state,
    "wire": _wire_state,
    "bus": _bus_state,
    "interrupt": _routine_state,
}


def _margin(words: Words) -> Said:
    words.one_of(["of"])
    unit, name = words.name("I2CDXR")
    if name.removeprefix("I2C-A.") != "I2CDXR":
        raise BadEvent(f"{words.text!r}: only I2CDXR has a margin; write margin of I2CDXR")
    return Said("margin", unit=unit)


def _load(form: str) -> Callable[[Words], Said]:
    def parse(words: Words) -> Said:
        if words.next != "load":
            what = f"there is no measure {words.text!r}; write {words.text.split(maxsplit=1)[0]} load"
            raise BadEvent(f"{what}, the part of the time that it is busy")
        words.take("load")
        unit = words.take("a unit") if form == "cpu" and words.took("of") else ""
        return Said(form, unit=unit, window=_checked_window(words, words.rest()) if words.took("per") else "")

    return parse


def _checked_window(words: Words, given: str) -> str:
    """Return the text `given` unchanged. Raise BadEvent if it is not the length of a window."""
    if not given:
        raise BadEvent(f"{words.text!r} ends where the length of a window is expected; write for instance per 20 ms")
    try:
        length = duration(given)
    except ValueError as error:
        raise BadEvent(f"{words.text!r}: {error}") from None
    if not length:
        raise BadEvent(f"{words.text!r}: a window is longer than 0")
    return given


def _lost(words: Words) -> Said:
    words.one_of(["flags"])
    unit, name = words.name("a register") if words.next else ("", "")
    return Said("lost", unit=unit, name=name)


def _model_age(words: Words) -> Said:
    words.one_of(["age"])
    return Said("model", name=_chip(words))


def _chip(words: Words) -> str:
    return words.one_of(list(known_sensors())) if words.took("of") else ""


def _value(words: Words) -> Said:
    if words.next == "of":
        return _of_event("value")(words)
    words.one_of(["error"])
    chip = _chip(words)
    instant = "first bit"
    if words.took("at"):
        instant = words.one_of(["first", "frame"])
        if instant == "first":
            instant = f"first {words.one_of(['bit'])}"
    return Said("value", instant=instant, name=chip)


def _phrase(form: str, fixed: str = "", name: str = "", unit: str = "") -> Callable[[Words], Said]:
    """Return the parser of the words `fixed`, then of a name and a unit.

    name: a description of the name for messages; "" for no name. unit: the word before the unit; "" for no unit.
    """

    def parse(words: Words) -> Said:
        for word in fixed.split():
            words.one_of([word])
        whose, found = words.name(name) if name else ("", "")
        if unit and words.took(unit):
            whose = words.take("a unit")
        return Said(form, unit=whose, name=found)

    return parse


_MEASURES: dict[str, tuple[str, Callable[[Words], Said]]] = {
    "from": ("from EVENT to EVENT", _from),
    "period": ("period of EVENT", _of_event("period", False)),
    "jitter": ("jitter of EVENT", _jitter),
    "count": ("count of EVENT", _count),
    "sum": ("sum of EVENT", _of_event("sum")),
    "level": ("level of MODULE.REGISTER.FIELD", _level),
    "calls": ("calls of FUNCTION", _calls),
    "stack": ("stack high-water", _phrase("stack", "high-water", unit="of")),
    "interrupt": ("interrupt latency NAME", _latency),
    "reaction": ("reaction", _phrase("reaction", unit="of")),
    "gap": ("gap between rounds", _phrase("gap", "between rounds")),
    "margin": ("margin of I2CDXR", _margin),
    "SCL": ("SCL held per transfer", _phrase("SCL", "held per transfer", unit="by")),
    "time": ("time in STATE", _time("time")),
    "each": ("each time in STATE", _time("each")),
    "share": ("share of time in STATE", _share),
    "cpu": ("cpu load", _load("cpu")),
    "bus": ("bus load", _load("bus")),
    "slack": ("slack", _phrase("slack")),
    "race": ("race MODULE.REGISTER.FIELD", _phrase("race", name="a field or a register")),
    "lost": ("lost flags", _lost),
    "cleared": ("cleared along MODULE.REGISTER.FIELD", _phrase("cleared", "along", "a field")),
    "age": ("age of CHIP", lambda words: Said("age", name=_chip(words))),
    "model": ("model age of CHIP", _model_age),
    "value": ("value error of CHIP", _value),
}
FORMS = {form: shown for form, (shown, _) in _MEASURES.items()}
_PARSERS = {form: parser for form, (_, parser) in _MEASURES.items()}
