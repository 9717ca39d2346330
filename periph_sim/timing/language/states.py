"""States of a run in the text of a measure, such as "flag I2C-A.I2CSTR.BB = 1", and the events that bound them."""

from __future__ import annotations

from msgspec import Struct

from ...core.phrases import nearest
from .events import Event, event_of
from .scope import VECTORS, BadEvent
from .tokens import Words

LEVELS, BUS_STATES, CPU_STATES = ("high", "low"), ("busy", "free"), ("busy", "idle")


class During(Struct, frozen=True):
    """A state of the run.

    enters: the events that begin the state; empty for the state of a CPU.
    leaves: the events that end the state. An event that is also in `enters` does not end the state.
    cpu: for the state of a CPU, "busy" or "idle"; "" for other states.
    unit: for the state of a CPU, the unit that the text names; "" if it names none, and for other states.
    """

    text: str
    enters: tuple[Event, ...] = ()
    leaves: tuple[Event, ...] = ()
    cpu: str = ""
    unit: str = ""


def read_state(words: Words) -> During:
    """Read the word "in" and the text of a state after this word, and return the state."""
    words.one_of(["in"])
    begin = words.place
    if words.next == "cpu" and nearest(words.following, CPU_STATES):
        words.take("cpu")
        cpu = words.one_of(list(CPU_STATES))
        unit = words.take("a unit") if words.took("of") else ""
        return During(words.between(begin), cpu=cpu, unit=unit)
    enters, leaves = _events(words)
    return During(words.between(begin), enters, leaves)


def read_span(words: Words) -> tuple[Event, Event]:
    """Read an optional word "span" and the name of a span. Return the events "begin" and "end" of the span.

    All remaining words are the name. If they were read as an event, a name such as "wait to send" would end at "to".
    """
    words.took("span")
    begin = words.place
    unit, name = words.name("a span's name")
    name = " ".join(filter(None, (name, words.rest())))
    text = f"span {words.between(begin)}"
    return Event("span", f"{text} begin", unit, name, "begin"), Event("span", f"{text} end", unit, name, "end")


def _events(words: Words) -> tuple[tuple[Event, ...], tuple[Event, ...]]:
    """Return the events that begin the state, and the events that end it."""
    kind = words.next
    if words.took("bus"):
        begins, ends = (event_of("bus START"),), (event_of("bus STOP"), event_of("bus arbitration lost"))
        return (begins, ends) if words.one_of(list(BUS_STATES)) == "busy" else (ends, begins)
    if kind not in STATES:
        _check_spelling(words)
        entered, left = read_span(words)
        return (entered,), (left,)
    expected, enter, leave = STATES[words.take("a state")]
    begin = words.place
    words.name(expected)
    place = words.between(begin)
    if kind == "wire":
        kind = "edge"
        if words.one_of(list(LEVELS)) == "low":
            enter, leave = leave, enter
    elif not enter:
        begin = words.place
        words.one_of(["="])
        words.value()
        enter = words.between(begin)
    return (event_of(f"{kind} {place} {enter}"),), (event_of(f"{kind} {place} {leave}"),)


def _check_spelling(words: Words) -> None:
    """Raise BadEvent if the next word seems to be a misspelled first word of a state.

    This is so if the word resembles one in ENDS and a later word fits this state. Without this check, the misspelled
    word would be read as the name of a span.
    """
    for state in nearest(words.next, ENDS):
        if not ENDS[state].isdisjoint(words.coming):
            raise BadEvent(f"{words.text!r}: {words.next!r} where {state} is expected; a span's name is quoted")


# ENDS maps the first word of a state to a set of words. One of them must come later in the text of the state.
ENDS: dict[str, frozenset[str]] = {
    "flag": frozenset("="),
    "variable": frozenset("="),
    "wire": frozenset(LEVELS),
    "interrupt": frozenset(vector for vectors in VECTORS.values() for vector in vectors),
    "bus": frozenset(BUS_STATES),
    "cpu": frozenset(CPU_STATES),
}
# STATES maps the first word of a state to a description of the name after it, the last word of the event that begins
# the state, and the last word of the event that ends it. "" means the value in the state's text, such as "= 1".
STATES = {
    "flag": ("a field", "", "change"),
    "variable": ("a variable of an image", "", "change"),
    "wire": ("a wire", "rise", "fall"),
    "interrupt": ("an interrupt's name", "enter", "leave"),
}
