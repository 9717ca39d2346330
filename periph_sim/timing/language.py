"""Measures of events as text: "from EVENT to EVENT" goes in; what is measured, between which events, comes out.

    text --> words --> Said(form, events or names, rule) ; BadEvent says what was found where what was expected

    measure = "from" event "to" event [ "," rule ]
            | ( "period" | "jitter" | "count" ) "of" event
            | "level" "of" field
            | "interrupt" "latency" vector
            | "time" "in" span
            | "cpu" "load" [ "of" unit ]
            | "bus" "load"
            | "slack"
    rule    = "next" | "same" "transfer" | "same" "round"
    event   = "edge" wire ( "rise" | "fall" | "change" )
            | "flag" field ( "rise" | "fall" | "change" | "=" number )
            | "access" ( "R" | "W" ) register
            | "interrupt" vector ( "enter" | "leave" )
            | "span" span ( "begin" | "end" )
            | "bus" ( "START" | "repeated" "START" | "STOP" | "arbitration" "lost" | "stuck"
                    | "address" [ number ] [ "read" | "write" ] | "byte" [ number ] )
            | "frame" [ number ]
            | "note" ( "duty" | "lost" | "unknown" )
    field, register, vector, span, note's code: [ unit ":" ] name; a name with blanks stands in quotes

Words stand apart by blanks; a span's name may have several words before "begin" or "end".
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

from ..core.nearest import near
from .names import BadEvent

FORMS = {
    "from": "from EVENT to EVENT",
    "period": "period of EVENT",
    "jitter": "jitter of EVENT",
    "count": "count of EVENT",
    "level": "level of MODULE.REGISTER.FIELD",
    "interrupt": "interrupt latency NAME",
    "time": "time in SPAN",
    "cpu": "cpu load",
    "bus": "bus load",
    "slack": "slack",
}
RULES = ("next", "same transfer", "same round")
CHANGES = ("rise", "fall", "change")
NOTES = ("duty", "lost", "unknown")
BUS = ("START", "repeated START", "STOP", "address", "byte", "arbitration lost", "stuck")

WORD = re.compile(r"""\s*("[^"]+"|'[^']+'|["',=]|[^\s,="']+)""")


@dataclass(frozen=True)
class Event:
    """kind: the event's first word. name: what it is about. how: which change or way. number: a value, if given."""

    kind: str
    text: str
    unit: str = ""
    name: str = ""
    how: str = ""
    number: int | None = None


@dataclass(frozen=True)
class Said:
    """form: a key of FORMS. events: those named. unit, name: of a field, vector, span or unit."""

    form: str
    events: tuple[Event, ...] = ()
    rule: str = "next"
    unit: str = ""
    name: str = ""


def is_form(text: str) -> bool:
    """Whether a measure's text is one of this language, right or wrong."""
    return text.split(" ", 1)[0].rstrip(",") in FORMS


def near_form(text: str) -> str:
    """The form whose first word is nearly the text's; empty if none is."""
    close = get_close_matches(text.split(" ", 1)[0], list(FORMS), 1, 0.75)
    return FORMS[close[0]] if close else ""


def measure_of(text: str) -> Said:
    """What a measure's text says. BadEvent otherwise."""
    words = _Words(text)
    said = _MEASURES[words.one_of(list(FORMS))](words)
    words.end()
    return said


def event_of(text: str) -> Event:
    """The event that a text names. BadEvent otherwise."""
    words = _Words(text)
    event = _event(words)
    words.end()
    return event


def name_text(unit: str, name: str) -> str:
    return f"{unit}:{name}" if unit else name


class _Words:
    """The words of a text, taken one by one."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._words = WORD.findall(text)
        self._at = 0
        if '"' in self._words or "'" in self._words:
            raise BadEvent(f"{text!r}: a quote is not closed, or nothing is in it; write for instance 'time update'")

    @property
    def next(self) -> str:
        """The word to come; empty at the end."""
        return self._words[self._at] if self._at < len(self._words) else ""

    def take(self, expected: str) -> str:
        word = self.next
        if not word:
            raise BadEvent(f"{self.text!r} ends where {expected} is expected")
        self._at += 1
        return word

    def one_of(self, choices: list[str]) -> str:
        word = self.next
        if word not in choices:
            expected = " or ".join([", ".join(choices[:-1]), choices[-1]] if len(choices) > 1 else choices)
            if not word:
                raise BadEvent(f"{self.text!r} ends where {expected} is expected")
            hint = f"; {near(word, choices)}" if len(choices) > 1 else ""
            raise BadEvent(f"{self.text!r}: {word!r} where {expected} is expected{hint}")
        self._at += 1
        return word

    def took(self, word: str) -> bool:
        if self.next != word:
            return False
        self._at += 1
        return True

    def name(self, expected: str) -> tuple[str, str]:
        """(unit, name); the unit is empty where none is named."""
        word = self.take(expected)
        unit, colon, name = word.partition(":")
        if word[0] in "\"'":
            return "", word[1:-1]
        if not colon:
            return "", word
        if not name:
            name = self.take(expected)  # imu: "a name in quotes"
            name = name[1:-1] if name[0] in "\"'" else name
        return unit, name

    def number(self, top: int) -> int | None:
        """The number that comes next, if one does."""
        word = self.next
        if not word[:1].isdigit():
            return None
        try:
            number = int(word, 0)
        except ValueError:
            raise BadEvent(f"{self.text!r}: {word!r} is no number; write for instance 0x68") from None
        if number > top:
            raise BadEvent(f"{self.text!r}: {word} is more than it can be, {top:#x}")
        self._at += 1
        return number

    def between(self, begin: int) -> str:
        return " ".join(self._words[begin : self._at])

    @property
    def place(self) -> int:
        return self._at

    def end(self) -> None:
        if self.next:
            raise BadEvent(f"{self.text!r}: {self.next!r} is more than a measure or event says; leave it out")


def _event(words: _Words) -> Event:
    begin = words.place
    kind = words.one_of(list(_EVENTS))
    unit, name, how, number = _EVENTS[kind](words)
    return Event(kind, words.between(begin), unit, name, how, number)


Parts = tuple[str, str, str, int | None]


def _edge(words: _Words) -> Parts:
    return "", words.name("a wire")[1], words.one_of(list(CHANGES)), None


def _flag(words: _Words) -> Parts:
    unit, name = words.name("a field")
    how = words.one_of([*CHANGES, "="])
    number = None
    if how == "=":
        number = words.number(0xFFFFFFFF)
        if number is None:
            raise BadEvent(f"{words.text!r}: a number is expected after =")
    return unit, name, how, number


def _access(words: _Words) -> Parts:
    way = words.one_of(["R", "W"])
    unit, name = words.name("a register")
    return unit, name, way, None


def _interrupt(words: _Words) -> Parts:
    unit, name = words.name("an interrupt's name")
    return unit, name, words.one_of(["enter", "leave"]), None


def _span(words: _Words) -> Parts:
    unit, name = words.name("a span's name")
    while words.next and words.next not in ("begin", "end", "to", ","):
        name += f" {words.take('begin or end')}"
    return unit, name, words.one_of(["begin", "end"]), None


def _bus(words: _Words) -> Parts:
    what = words.one_of([name.split()[0] for name in BUS])
    if what == "repeated":
        return "", f"repeated {words.one_of(['START'])}", "", None
    if what == "arbitration":
        return "", f"arbitration {words.one_of(['lost'])}", "", None
    if what == "address":
        number = words.number(0x7F)
        how = words.one_of(["read", "write"]) if words.next in ("read", "write") else ""
        return "", what, how, number
    return "", what, "", words.number(0xFF) if what == "byte" else None


def _frame(words: _Words) -> Parts:
    return "", "byte", "", words.number(0xFF)


def _note(words: _Words) -> Parts:
    unit, name = words.name("a note's code")
    if name not in NOTES:
        raise BadEvent(f"{words.text!r}: there is no note {name!r}; {near(name, NOTES)}")
    return unit, name, "", None


_EVENTS: dict[str, Callable[[_Words], Parts]] = {
    "edge": _edge,
    "flag": _flag,
    "access": _access,
    "interrupt": _interrupt,
    "span": _span,
    "bus": _bus,
    "frame": _frame,
    "note": _note,
}


def _from(words: _Words) -> Said:
    begin = _event(words)
    words.one_of(["to"])
    end = _event(words)
    rule = "next"
    if words.took(",") or words.next in ("next", "same"):
        rule = words.one_of(["next", "same"])
        if rule == "same":
            rule = f"same {words.one_of(['transfer', 'round'])}"
    return Said("from", (begin, end), rule)


def _of_event(form: str) -> Callable[[_Words], Said]:
    def parse(words: _Words) -> Said:
        words.one_of(["of"])
        return Said(form, (_event(words),))

    return parse


def _level(words: _Words) -> Said:
    words.one_of(["of"])
    unit, name = words.name("a field")
    return Said("level", unit=unit, name=name)


def _latency(words: _Words) -> Said:
    words.one_of(["latency"])
    unit, name = words.name("an interrupt's name")
    return Said("interrupt", unit=unit, name=name)


def _time(words: _Words) -> Said:
    words.one_of(["in"])
    unit, name = words.name("a span's name")
    while words.next:
        name += f" {words.take('a span')}"
    return Said("time", unit=unit, name=name)


def _cpu(words: _Words) -> Said:
    words.one_of(["load"])
    return Said("cpu", unit=words.take("a unit") if words.took("of") else "")


def _bus_load(words: _Words) -> Said:
    words.one_of(["load"])
    return Said("bus")


_MEASURES: dict[str, Callable[[_Words], Said]] = {
    "from": _from,
    "period": _of_event("period"),
    "jitter": _of_event("jitter"),
    "count": _of_event("count"),
    "level": _level,
    "interrupt": _latency,
    "time": _time,
    "cpu": _cpu,
    "bus": _bus_load,
    "slack": lambda words: Said("slack"),
}
