"""Makers of measures. A maker is a function that returns a new measure. It is derived from the text of the measure.

text --registry--> the sentence of that name --.
  '--------------------------------------------+--language--> ParsedMeasure --> Matchers of its events --> Maker
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeAlias

from msgspec.structs import replace

from ...core.phrases import did_you_mean, nearest
from ...core.records import Kind
from ...core.table import duration
from ...devices.sensor_rounds import known_sensors
from ...f28335.pie.register_map import LINES
from ..budget_schema import REPLY, SILENCE, SPAN, WATCH
from ..language.events import OF_AGENT, matcher, stretch_of
from ..language.language import FORMS, ParsedMeasure, is_form, measure_of, near_form
from ..language.matcher import ANYTHING, Group, Matcher
from ..language.scope import BadEvent, Scope
from ..language.tokens import name_text
from .event import FOR_EACH, GIVEN, MEASURED_AT, UNFINISHED, UNLESS, Clauses, EventMeasure
from .expectations import Reply, Unsolicited, WatchedWire
from .margin import Margin
from .measure import Measure
from .pair import Between
from .registry import MEASURES, PHRASES, UNNAMED, Sentence
from .states import StateEvents, TimeIn

OVERFLOWS = "overflows"  # the name of the measure that counts overflows of fixed-point arithmetic
UNSOLICITED = "unsolicited replies"
NOT_SENTENCES = (OVERFLOWS, UNSOLICITED)  # fixed names of measures that MEASURES does not define by a sentence
PREFIXES: dict[str, Callable[[str], Measure]] = {REPLY: Reply, SILENCE: Unsolicited, WATCH: WatchedWire}
ROLES = {
    "for each": FOR_EACH,
    "measured at": MEASURED_AT,
    "given": GIVEN,
    "unless": UNLESS,
    "unfinished": UNFINISHED,
}
JITTER = "jitter of "
NO_PARAMETERS = ParsedMeasure()
# A `Maker` is a function that returns a new measure. It has no state, so all scenes of a case use the same function.
Maker: TypeAlias = Callable[[], Measure]


def expanded(text: str, sentences: Mapping[str, str]) -> str:
    """Return a measure's text, in which a name that the user has defined is replaced by the text of the definition.

    sentences: the texts of the user's measures by name. Raise BadEvent if the definition of a name refers to this name,
    directly or through other names.
    """
    before, names = "", [text]
    while text in sentences or text.startswith(JITTER):
        if text in sentences:
            text = sentences[text]
        else:
            before, text = before + JITTER, text.removeprefix(JITTER)
        if text in names:
            raise BadEvent(f"measure {text!r} is defined by itself; write it in events")
        names.append(text)
    return before + text


def check_measure(name: str, sentences: Mapping[str, str]) -> None:
    """Raise BadEvent if a name that the user defines is that of a shipped measure or begins as its text, or if the text
    of the definition is no measure.

    The text is checked as far as this is possible without a scene.
    """
    if name in (*MEASURES, *PHRASES, UNSOLICITED):
        raise BadEvent(f"there is a measure {name!r} already; give this one another name")
    begins = [prefix for prefix in (SPAN, *PREFIXES) if name.startswith(prefix)]
    begins += [name.partition(" ")[0]] * is_form(name)
    if begins:
        raise BadEvent(f"{begins[0]!r} begins the text of other measures; give this one another name")
    text = expanded(name, sentences)
    if is_form(text):
        said = measure_of(text)
        while said.of is not None:
            said = said.of
        text = said.name if said.form == "jitter" else ""
    if text not in ("", *MEASURES, *NOT_SENTENCES) and not text.startswith((SPAN, *PREFIXES)):
        raise _unknown(text, sentences)


def measure_named(text: str, scope: Scope) -> Measure:
    """Return the measure that a text names.

    Raise BadEvent if the text names no measure, or an event that this scene cannot have.
    """
    return maker_of(text, scope)()


def maker_of(text: str, scope: Scope) -> Maker:
    """Return the maker of the measure that a text names. Raise BadEvent as `measure_named` does."""
    if not is_form(text):
        return _called(text, scope)
    said = measure_of(text)
    return _MAKERS[said.form](said, scope)


def _called(name: str, scope: Scope) -> Maker:
    """Return the maker of a measure with a fixed name, or with a prefix such as "span:" and a name after it."""
    if name.startswith(SPAN):
        span = name.removeprefix(SPAN)
        quoted = f"'{span}'" if '"' in span else f'"{span}"'
        return _of_sentence(PHRASES["span"], NO_PARAMETERS, scope, name=span, quoted=quoted)
    if name == UNSOLICITED:
        return partial(Unsolicited, "")
    for prefix, kind in PREFIXES.items():
        if name.startswith(prefix):
            return partial(kind, name.removeprefix(prefix))
    if name in MEASURES:
        return _of_sentence(MEASURES[name], NO_PARAMETERS, scope)
    if name == OVERFLOWS:
        if scope.uncounted:
            what = "overflows are counted by Python firmware that reports them"
            raise BadEvent(f"{name!r}: {what}, and {scope.uncounted} does not run such firmware; leave the budget out")
        return _of_sentence(PHRASES[OVERFLOWS], NO_PARAMETERS, scope)
    raise _unknown(name, scope.measures)


def _unknown(name: str, sentences: Mapping[str, str]) -> BadEvent:
    form = near_form(name)
    if form:
        return BadEvent(f"there is no measure {name!r}; did you mean {form}?")
    prefix, colon, rest = name.partition(":")
    near = nearest(f"{prefix}:", (SPAN, *PREFIXES)) if colon else []
    if near:
        return BadEvent(f"there is no measure {name!r}; did you mean {near[0]}{rest}?")
    names = [*sentences, *MEASURES, *NOT_SENTENCES, *(f"{prefix}NAME" for prefix in (SPAN, *PREFIXES))]
    hint = did_you_mean(name, names)
    if not hint.startswith("did you mean"):
        hint = f"it has {', '.join(names)}, and {', '.join(FORMS.values())}"
    return BadEvent(f"there is no measure {name!r}; {hint}")


# WORDS maps each parameter in the texts of named measures to a function that returns the words that replace it.
WORDS: dict[str, Callable[[ParsedMeasure, Scope], str]] = {
    "event": lambda said, scope: said.events[0].text,
    "cpu": lambda said, scope: scope.unit(said.unit),
    "i2c": lambda said, scope: scope.owner(said.unit, "I2C-A"),
    "address": lambda said, scope: said.name,
    "time": lambda said, scope: f"any {said.window}" if said.window else "time",
    "of": lambda said, scope: said.name and f" of {said.name}",
    "chips": lambda said, scope: said.name or " or ".join(known_sensors()),
    "at": lambda said, scope: " at frame" if said.instant == "frame" else "",
}


def _of_sentence(sentence: Sentence, said: ParsedMeasure, scope: Scope, **given: str) -> Maker:
    """Return the maker of a named measure.

    sentence: the named measure, whose `text` contains parameters in braces.
    said: the parsed text of the budget, from which the words for the parameters in WORDS are taken.
    given: the words for all other parameters.
    """
    named = f"{sentence.text} {sentence.nothing} {sentence.cut_off}"
    words = given | {name: word(said, scope) for name, word in WORDS.items() if f"{{{name}}}" in named}
    meant = measure_of(sentence.text.format_map(words))
    if meant.state is not None:
        return _time(meant, scope)
    nothing = sentence.nothing and sentence.nothing.format_map(words)
    return _of_events(meant, scope, replace(sentence, nothing=nothing, cut_off=sentence.cut_off.format_map(words)))


def _phrase(said: ParsedMeasure, scope: Scope) -> Maker:
    """Return the maker of a measure whose form is a key of PHRASES."""
    return _of_sentence(PHRASES[said.form], said, scope)


def _of_events(said: ParsedMeasure, scope: Scope, sentence: Sentence = UNNAMED) -> Maker:
    """Return the maker of a count, value or sum of one event, or of a time or a count between two events."""
    if said.form in ("value", "sum"):
        event = said.events[0]
        for one in (event, *event.others):
            if one.kind != "record":
                what = f"{said.form} of takes a record event, not {one.text!r}"
                raise BadEvent(f"{said.text!r}: {what}; write count of the event, or level of a field or a variable")
    first, *others = (matcher(event, scope) for event in said.events)
    clauses = _clauses(said, scope, sentence)
    if not others:
        return partial(EventMeasure, first, form=said.form, clauses=clauses)
    group, by_unit = _group(said, scope), said.group == "unit"
    if said.form == "from":
        return partial(Between, first, others[0], said.pairing, group, clauses, by_unit=by_unit)
    return partial(Between, others[0], others[1], said.pairing, group, clauses, first, by_unit)


def _clauses(said: ParsedMeasure, scope: Scope, sentence: Sentence) -> Clauses:
    asked = [event.text for clause, event in said.clauses if clause == "for each"]
    if said.group not in ("", "unit") and asked:
        what = f"pairs of one {said.group} are counted {said.group} by {said.group}"
        raise BadEvent(f"{said.text!r}: {what}; leave 'for each {asked[0]}' out")
    unless = [event.text for clause, event in said.clauses if clause == "unless"]
    unknown = [("event", f"matched {text!r}, which 'unless' excludes") for text in unless]
    unfinished = [event.text for clause, event in said.clauses if clause == "unfinished"]
    return Clauses(
        tuple(matcher(event, scope) for _, event in said.clauses),
        tuple(ROLES[clause] for clause, _ in said.clauses),
        replace(
            sentence,
            asked=sentence.asked or ", ".join(map(repr, asked)),
            cut_off=sentence.cut_off or ", ".join(map(repr, unfinished)),
            unknown=sentence.unknown or tuple(unknown),
        ),
    )


def _group(said: ParsedMeasure, scope: Scope) -> Group | None:
    if said.group in ("", "unit"):
        return None
    return stretch_of(said.group, scope, f"'same {said.group}'", "; leave it out")


def _jitter(said: ParsedMeasure, scope: Scope) -> Maker:
    if said.events:
        make_of = _of_sentence(PHRASES["period"], said, scope)
    else:
        make_of = _called(said.name, scope) if said.of is None else _MAKERS[said.of.form](said.of, scope)
        made = make_of()
        if not made.series:
            raise BadEvent(f"{said.text!r}: that is one number a run, so it has no jitter")
        if made.is_jitter:
            raise BadEvent(f"{said.text!r}: a jitter has no jitter; name the measure itself")
    return partial(_jittering, make_of)


def _jittering(make_of: Maker) -> Measure:
    measure = make_of()
    measure.become_jitter()
    return measure


def _level(said: ParsedMeasure, scope: Scope) -> Maker:
    change, *at = (matcher(event, scope) for event in said.events)
    if at:
        return partial(EventMeasure, at[0], change, form="level", order=(1, 0))
    return partial(EventMeasure, change, form="value")


def _stack(said: ParsedMeasure, scope: Scope) -> Maker:
    """Return the maker of the measure of the largest stack depth.

    The measured records are made each time the depth exceeds all earlier depths.
    """
    text = "stack high-water"
    high = Matcher(text, Kind.FLAG, frozenset((f"{scope.image(said.unit)}.CPU",)), "stack")
    return partial(EventMeasure, high, form="value")


def _gap(said: ParsedMeasure, scope: Scope) -> Maker:
    if not scope.rounds:
        raise BadEvent(f"{said.text!r} needs [controller] or [rounds] in the scene, which has none")
    return _phrase(said, scope)


def _latency(said: ParsedMeasure, scope: Scope) -> Maker:
    """Return the maker of the measure of an interrupt's latency.

    The latency is the time from the rise of the interrupt's PIEIFR flag to the entry of its service routine, or to the
    first register access in this routine. Raise BadEvent for an interrupt that does not come through the PIE.
    """
    unit = scope.vector(said.unit, said.name)
    if said.name not in LINES:
        raise BadEvent(f"{said.name} does not come through the PIE, so nothing records when it was asked for")
    group, line = LINES[said.name]
    whose = said.unit or (unit if len(scope.units) > 1 else "")
    asked, vector = name_text(whose, f"PIE.PIEIFR{group}.INTx{line}"), name_text(whose, said.name)
    sentence = PHRASES["first access" if said.access else "interrupt"]
    return _of_sentence(sentence, said, scope, asked=asked, vector=vector, unit=unit)


def _time(said: ParsedMeasure, scope: Scope) -> Maker:
    return partial(TimeIn, _state(said, scope), said.form, duration(said.window) if said.window else None)


def _state(said: ParsedMeasure, scope: Scope) -> StateEvents:
    assert said.state is not None
    if said.state.cpu:
        unit = frozenset((scope.unit(said.state.unit),))
        nests = (Matcher("wait", Kind.WAIT, unit, ANYTHING), Matcher("interrupt", Kind.IRQ, unit, ANYTHING))
        return StateEvents(said.state.text, nests=nests, is_idle=said.state.cpu == "idle")
    both = [
        [event for event in events if scope.controller or event.name not in OF_AGENT]
        for events in (said.state.enters, said.state.leaves)
    ]
    enters, leaves = ([matcher(event, scope) for event in events] for events in both)
    return StateEvents(said.state.text, tuple(enters), tuple(leaves))


def _of_a_race(said: ParsedMeasure, scope: Scope) -> Maker:
    """Return the maker of the measure of a race, of lost flags, or of one flag that is cleared along with others."""
    from .modifies import LostFlags
    from .watched_register import clearing, losing, raced

    if said.form == "race":
        from .over_table import Race

        return partial(Race, raced(said.unit, said.name, scope))
    watched = clearing if said.form == "cleared" else losing
    return partial(LostFlags, watched(said.unit, said.name, scope))


def _value(said: ParsedMeasure, scope: Scope) -> Maker:
    return _of_events(said, scope) if said.events else _phrase(said, scope)


_MAKERS: dict[str, Callable[[ParsedMeasure, Scope], Maker]] = {
    "from": _of_events,
    "period": _phrase,
    "jitter": _jitter,
    "count": _of_events,
    "sum": _of_events,
    "level": _level,
    "calls": lambda said, scope: partial(EventMeasure, matcher(said.events[0], scope), form="count"),
    "stack": _stack,
    "interrupt": _latency,
    "reaction": _phrase,
    "busy": _phrase,
    "gap": _gap,
    "margin": lambda said, scope: partial(Margin, scope.owner(said.unit, "I2C-A")),
    "SCL": _phrase,
    "time": _time,
    "each": _time,
    "share": _time,
    "cpu": _phrase,
    "bus": _phrase,
    "slack": _phrase,
    "race": _of_a_race,
    "cleared": _of_a_race,
    "age": lambda said, scope: _of_sentence(MEASURES["age"], said, scope),
    "model": lambda said, scope: _of_sentence(MEASURES["model age"], said, scope),
    "value": _value,
    "lost": _of_a_race,
}
