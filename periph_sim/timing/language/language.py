"""Measures of events as text, such as "from EVENT to EVENT": their syntax and its parser.

    text --> words --> ParsedMeasure(form, events or names, rule), or BadEvent with the wrong and the expected words

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
            | "busy" "time" "of" number
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
    field, register, vector, span, variable = [ unit ":" ] name        a name with blanks is quoted

Words are separated by blanks. A span's name may have several words before "begin" or "end". If another state begins
with the same word as the name, the name must be quoted.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from msgspec import Struct
from msgspec.structs import replace

from ...core.phrases import nearest
from ...core.table import duration
from ...devices.sensor_rounds import known_sensors
from .events import EVENTS, Event, read_event
from .scope import BadEvent
from .states import During, read_span, read_state
from .tokens import Words

CLAUSES = {
    "for": "for each",  # the event at which a value should be measured
    "measured": "measured at",  # the event at which a value was measured, if the measure does not determine this itself
    "given": "given",  # an event that must happen, or the budget is not judged
    "unless": "unless",  # an event that must not happen, or the budget is not judged
    "unfinished": "unfinished",  # the event that reports an occurrence cut off by the run's end, with the value so far
}


class ParsedMeasure(Struct, frozen=True):
    """The parsed text of a measure.

    form: a key of FORMS.
    text: the whole text.
    events: the events that the text names, in order.
    unit: the unit that the text names; "" if it names none.
    name: the field, register, vector, chip, memory address or measure with a fixed name that the text names; "" if it
        names none.
    state: the state in which time is measured; None for other measures.
    pairing: "in order", "next", "last" or "".
    group: "transfer", "round" or "unit" if both events of a pair must be in the same transfer, round or unit; else "".
    instant: for a value error, "first bit" or "frame": the instant at which the true value is taken.
    window: the length of the window of a share or a load, as text; "" for the whole run.
    of: for the jitter of a measure that has a form, this measure; else None. For the jitter of an event, `events` has
        the event. For the jitter of a measure with a fixed name, `name` has this name.
    access: True if the latency of an interrupt is measured up to the first register access of its routine.
    clauses: pairs of a clause at the end of the text, such as "given", and the event in this clause.
    """

    form: str = ""
    events: tuple[Event, ...] = ()
    text: str = ""
    unit: str = ""
    name: str = ""
    state: During | None = None
    pairing: str = ""
    group: str = ""
    instant: str = ""
    window: str = ""
    of: ParsedMeasure | None = None
    access: bool = False
    clauses: tuple[tuple[str, Event], ...] = ()


def is_form(text: str) -> bool:
    """Return True if a measure's text begins with the first word of a form. The other words are not checked."""
    return text.split(" ", 1)[0].rstrip(",") in FORMS


def near_form(text: str) -> str:
    """Return the form, such as "count of EVENT", whose first word resembles that of a text; "" if there is none."""
    close = nearest(text.split(" ", 1)[0], FORMS, 0.75)
    return FORMS[close[0]] if close else ""


@lru_cache(maxsize=1024)  # the scenes of one case have the same measures
def measure_of(text: str) -> ParsedMeasure:
    """Return the parsed text of a measure. Raise BadEvent if it cannot be parsed."""
    words = Words(text)
    said = _parsed(words)
    words.end()
    return replace(said, text=text)


def _parsed(words: Words) -> ParsedMeasure:
    form = words.one_of(list(FORMS))
    _, fixed, parse = _MEASURES[form]
    for word in fixed.split():
        words.one_of([word])
    return replace(parse(words), form=form)


def _from(words: Words) -> ParsedMeasure:
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
    return ParsedMeasure(events=(begin, end), pairing=pairing, group=group, clauses=_clauses(words))


def _clauses(words: Words) -> tuple[tuple[str, Event], ...]:
    found = []
    while words.following in CLAUSES and words.took(","):
        clause = CLAUSES[words.take("a clause")]
        for word in clause.split()[1:]:
            words.one_of([word])
        found.append((clause, read_event(words)))
    return tuple(found)


def _event(words: Words) -> ParsedMeasure:
    return ParsedMeasure(events=(read_event(words),))


def _sum(words: Words) -> ParsedMeasure:
    return replace(_event(words), clauses=_clauses(words))


def _count(words: Words) -> ParsedMeasure:
    counted = read_event(words)
    if not words.took("from"):
        return ParsedMeasure(events=(counted,), clauses=_clauses(words))
    pair = _from(words)
    return replace(pair, events=(counted, *pair.events))


def _jitter(words: Words) -> ParsedMeasure:
    form = words.next
    if form in EVENTS and words.following not in ("latency", "load"):
        return _event(words)
    if form not in FORMS:
        words.take("a measure or an event")
        return ParsedMeasure(name=" ".join(filter(None, (form, words.rest()))))
    return ParsedMeasure(of=_parsed(words))


def _level(words: Words) -> ParsedMeasure:
    kind = "variable" if words.took("variable") else "flag"
    begin = words.place
    unit, name = words.name("a variable of an image" if kind == "variable" else "a field")
    change = Event(kind, f"{kind} {words.between(begin)} change", unit, name, "change")
    events = (read_event(words),) if words.took("at") else ()
    return ParsedMeasure(events=(change, *events), unit=unit, name=name)


def _calls(words: Words) -> ParsedMeasure:
    return ParsedMeasure(events=read_span(words)[:1])


def _latency(words: Words) -> ParsedMeasure:
    unit, name = words.name("an interrupt's name")
    to_access = words.took("to")
    for word in ("first", "access") if to_access else ():
        words.one_of([word])
    return ParsedMeasure(unit=unit, name=name, access=to_access)


def _time(words: Words) -> ParsedMeasure:
    return ParsedMeasure(state=read_state(words))


def _share(words: Words) -> ParsedMeasure:
    if words.one_of(["time", "any"]) == "time":
        return _time(words)
    length = []
    while words.next and words.next != "in":
        length.append(words.take("the length of a window"))
    window = _checked_window(words, " ".join(length))
    return ParsedMeasure(state=read_state(words), window=window)


def _busy(words: Words) -> ParsedMeasure:
    address = words.next
    if words.number(0x7F) is None:
        raise BadEvent(f"{words.text!r}: the address of a memory is expected after of; write for instance 0x50")
    return ParsedMeasure(name=address)


def _margin(words: Words) -> ParsedMeasure:
    unit, name = words.name("I2CDXR")
    if name.removeprefix("I2C-A.") != "I2CDXR":
        raise BadEvent(f"{words.text!r}: only I2CDXR has a margin; write margin of I2CDXR")
    return ParsedMeasure(unit=unit)


def _load(words: Words, of_unit: bool) -> ParsedMeasure:
    unit = words.take("a unit") if of_unit and words.took("of") else ""
    return ParsedMeasure(unit=unit, window=_checked_window(words, words.rest()) if words.took("per") else "")


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


def _lost(words: Words) -> ParsedMeasure:
    return _named(words, "a register") if words.next else ParsedMeasure()


def _age(words: Words) -> ParsedMeasure:
    return ParsedMeasure(name=_chip(words))


def _chip(words: Words) -> str:
    return words.one_of(list(known_sensors())) if words.took("of") else ""


def _value(words: Words) -> ParsedMeasure:
    if words.took("of"):
        return _sum(words)
    words.one_of(["error"])
    chip = _chip(words)
    instant = "first bit"
    if words.took("at"):
        instant = words.one_of(["first", "frame"])
        if instant == "first":
            instant = f"first {words.one_of(['bit'])}"
    return ParsedMeasure(instant=instant, name=chip)


def _named(words: Words, expected: str) -> ParsedMeasure:
    unit, name = words.name(expected)
    return ParsedMeasure(unit=unit, name=name)


def _unit(words: Words, before: str = "of") -> ParsedMeasure:
    """Read an optional unit, after the word `before`."""
    return ParsedMeasure(unit=words.take("a unit") if words.took(before) else "")


# _MEASURES maps the first word of a form to the form for messages, the words that must follow the first word, and the
# parser of the remaining words.
_MEASURES: dict[str, tuple[str, str, Callable[[Words], ParsedMeasure]]] = {
    "from": ("from EVENT to EVENT", "", _from),
    "period": ("period of EVENT", "of", _event),
    "jitter": ("jitter of EVENT", "of", _jitter),
    "count": ("count of EVENT", "of", _count),
    "sum": ("sum of EVENT", "of", _sum),
    "level": ("level of MODULE.REGISTER.FIELD", "of", _level),
    "calls": ("calls of FUNCTION", "of", _calls),
    "stack": ("stack high-water", "high-water", _unit),
    "interrupt": ("interrupt latency NAME", "latency", _latency),
    "reaction": ("reaction", "", _unit),
    "busy": ("busy time of ADDRESS", "time of", _busy),
    "gap": ("gap between rounds", "between rounds", lambda words: ParsedMeasure()),
    "margin": ("margin of I2CDXR", "of", _margin),
    "SCL": ("SCL held per transfer", "held per transfer", lambda words: _unit(words, "by")),
    "time": ("time in STATE", "", _time),
    "each": ("each time in STATE", "time", _time),
    "share": ("share of time in STATE", "of", _share),
    "cpu": ("cpu load", "load", lambda words: _load(words, of_unit=True)),
    "bus": ("bus load", "load", lambda words: _load(words, of_unit=False)),
    "slack": ("slack", "", lambda words: ParsedMeasure()),
    "race": ("race MODULE.REGISTER.FIELD", "", lambda words: _named(words, "a field or a register")),
    "lost": ("lost flags", "flags", _lost),
    "cleared": ("cleared along MODULE.REGISTER.FIELD", "along", lambda words: _named(words, "a field")),
    "age": ("age of CHIP", "", _age),
    "model": ("model age of CHIP", "age", _age),
    "value": ("value error of CHIP", "", _value),
}
FORMS = {form: shown for form, (shown, _, _) in _MEASURES.items()}
