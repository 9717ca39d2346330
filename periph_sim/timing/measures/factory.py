"""Makers of measures: functions that make the measure named in a budget.

text --registry--> the sentence of that name --.
  '--------------------------------------------+--language--> Said --events, names--> Matchers --> Maker --> Measure
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeAlias

from msgspec.structs import replace

from ...core.records import Kind
from ...core.settings import duration
from ...core.suggest import did_you_mean
from ...devices.sensor_rounds import known_sensors
from ...f28335.pie.register_map import LINES
from ..budget_schema import REPLY, SPAN, WATCH
from ..language.events import ANYTHING, OF_AGENT, Group, Matcher, matcher, name_text, stretch_of
from ..language.language import FORMS, Said, is_form, measure_of, near_form
from ..language.scope import BadEvent, Scope
from .event_pairing import FOR_EACH, GIVEN, MEASURED_AT, UNFINISHED, UNLESS, Clauses, EventMeasure
from .expectations import Reply, WatchedWire
from .margin import Margin
from .measure import Measure
from .pair import Between
from .registry import MEASURES, PHRASES, UNNAMED, Sentence
from .states import StateEvents, TimeIn

OVERFLOWS = "overflows"  # of fixed-point arithmetic
ROLES = {
    "for each": FOR_EACH,
    "measured at": MEASURED_AT,
    "given": GIVEN,
    "unless": UNLESS,
    "unfinished": UNFINISHED,
}
JITTER = "jitter of "
Maker: TypeAlias = Callable[[], Measure]  # shares nothing with a run, so it serves all scenes of a case


def expanded(text: str, sentences: Mapping[str, str]) -> str:
    """Return a measure's text with the user's own names replaced by sentences. BadEvent if one is defined by itself."""
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
    """Raise BadEvent if the sentence of this name says no measure, in whatever scene, or if the name has a meaning."""
    if name in MEASURES or name in PHRASES or is_form(name) or name.startswith((SPAN, REPLY, WATCH)):
        raise BadEvent(f"there is a measure {name!r} already; give this one another name")
    text = expanded(name, sentences)
    if is_form(text):
        said = measure_of(text)
        while said.of is not None:
            said = said.of
        text = said.name if said.form == "jitter" else ""
    if text not in ("", *MEASURES, OVERFLOWS) and not text.startswith((SPAN, REPLY, WATCH)):
        raise _unknown(text, sentences)


def measure_named(text: str, scope: Scope) -> Measure:
    """Return the measure that a text names. Raise BadEvent if it names none, or events that this scene cannot have."""
    return maker_of(text, scope)()


def maker_of(text: str, scope: Scope) -> Maker:
    """Return a function that makes the measure that a text names. BadEvent as for `measure_named`."""
    return _maker_of_events(measure_of(text), scope) if is_form(text) else _called(text, scope)


def _called(name: str, scope: Scope) -> Maker:
    """Return the maker of a measure with a fixed name, or of a span, a reply or a watched wire."""
    if name.startswith(SPAN):
        span = name.removeprefix(SPAN)
        return _of_sentence(PHRASES["span"], scope, name=span, quoted=f"'{span}'" if '"' in span else f'"{span}"')
    for prefix, kind in ((REPLY, Reply), (WATCH, WatchedWire)):
        if name.startswith(prefix):
            return partial(kind, name.removeprefix(prefix))
    if name in MEASURES:
        return _of_sentence(MEASURES[name], scope, of="")
    if name == OVERFLOWS:
        if scope.uncounted:
            what = "overflows are counted by Python firmware that reports them"
            raise BadEvent(f"{name!r}: {what}, and {scope.uncounted} does not run such firmware; leave the budget out")
        return _of_sentence(PHRASES[OVERFLOWS], scope)
    raise _unknown(name, scope.measures)


def _unknown(name: str, sentences: Mapping[str, str]) -> BadEvent:
    form = near_form(name)
    if form:
        return BadEvent(f"there is no measure {name!r}; did you mean {form}?")
    names = [*sentences, *MEASURES, OVERFLOWS, f"{SPAN}NAME", f"{REPLY}NAME", f"{WATCH}NAME"]
    hint = did_you_mean(name, names)
    if not hint.startswith("did you mean"):
        hint = f"it has {', '.join(names)}, and {', '.join(FORMS.values())}"
    return BadEvent(f"there is no measure {name!r}; {hint}")


def _maker_of_events(said: Said, scope: Scope) -> Maker:
    return _MAKERS[said.form](said, scope)


def _of_sentence(sentence: Sentence, scope: Scope, **parameters: str) -> Maker:
    """Return the maker of a named measure."""
    text, nothing = sentence.text.format_map(parameters), sentence.nothing
    cut_off = sentence.cut_off.format_map(parameters)
    filled = replace(sentence, nothing=nothing and nothing.format_map(parameters), cut_off=cut_off)
    return _of_events(measure_of(text), scope, filled)


def _of_events(said: Said, scope: Scope, sentence: Sentence = UNNAMED) -> Maker:
    """Return the maker of a count, a value, a sum or a time from one event to another."""
    first, *others = (matcher(event, scope) for event in said.events)
    clauses = _clauses(said, scope, sentence)
    if not others:
        return partial(EventMeasure, first, form=said.form, clauses=clauses)
    group, by_unit = _group(said, scope), said.group == "unit"
    if said.form == "from":
        return partial(Between, first, others[0], said.pairing, group, clauses, by_unit=by_unit)
    return partial(Between, others[0], others[1], said.pairing, group, clauses, first, by_unit)


def _clauses(said: Said, scope: Scope, sentence: Sentence) -> Clauses:
    asked = [event.text for clause, event in said.clauses if clause == "for each"]
    if said.group not in ("", "unit") and asked:
        what = f"pairs of one {said.group} are counted {said.group} by {said.group}"
        raise BadEvent(f"{said.text!r}: {what}; leave 'for each {asked[0]}' out")
    unknown = [(f"event {event.text!r}", "cannot be judged") for clause, event in said.clauses if clause == "unless"]
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


def _group(said: Said, scope: Scope) -> Group | None:
    if said.group in ("", "unit"):
        return None
    if not (scope.rounds if said.group == "round" else scope.bus):
        needs = "[controller] or [rounds]" if said.group == "round" else "SCL and SDA"
        raise BadEvent(f"'same {said.group}' needs {needs} in the scene, which has none; leave it out")
    return stretch_of(said.group, scope)


def _jitter(said: Said, scope: Scope) -> Maker:
    if said.events:
        make_of = _period(said, scope)
    else:
        make_of = _called(said.name, scope) if said.of is None else _maker_of_events(said.of, scope)
        if not make_of().series:
            raise BadEvent(f"{said.text!r}: that is one number a run, so it has no jitter")
    return partial(_jittering, make_of)


def _jittering(make_of: Maker) -> Measure:
    measure = make_of()
    measure.become_jitter()
    return measure


def _period(said: Said, scope: Scope) -> Maker:
    return _of_sentence(PHRASES["period"], scope, event=said.events[0].text)


def _level(said: Said, scope: Scope) -> Maker:
    change, *at = (matcher(event, scope) for event in said.events)
    if at:
        return partial(EventMeasure, at[0], change, form="level", order=(1, 0))
    return partial(EventMeasure, change, form="value")


def _stack(said: Said, scope: Scope) -> Maker:
    """Return the maker of the stack's high-water mark, which is recorded whenever it grows."""
    text = "stack high-water"
    high = Matcher(text, Kind.FLAG, frozenset((f"{scope.image(said.unit)}.CPU",)), "stack")
    return partial(EventMeasure, high, form="value")


def _reaction(said: Said, scope: Scope) -> Maker:
    i2c = f"{scope.owner(said.unit, 'I2C-A')}:I2C-A"
    return _of_sentence(PHRASES["reaction"], scope, i2c=i2c)


def _gap(said: Said, scope: Scope) -> Maker:
    if not scope.rounds:
        raise BadEvent(f"{said.text!r} needs [controller] or [rounds] in the scene, which has none")
    return _of_sentence(PHRASES["gap"], scope)


def _latency(said: Said, scope: Scope) -> Maker:
    """Return the maker of an interrupt's latency, from the rise of its PIEIFR flag to its service routine's begin."""
    unit = scope.vector(said.unit, said.name)
    if said.name not in LINES:
        raise BadEvent(f"{said.name} does not come through the PIE, so nothing records when it was asked for")
    group, line = LINES[said.name]
    whose = said.unit or (unit if len(scope.units) > 1 else "")
    asked, vector = name_text(whose, f"PIE.PIEIFR{group}.INTx{line}"), name_text(whose, said.name)
    if not said.access:
        return _of_sentence(PHRASES["interrupt"], scope, asked=asked, vector=vector)
    return _of_sentence(PHRASES["first access"], scope, asked=asked, unit=unit, vector=vector)


def _time(said: Said, scope: Scope) -> Maker:
    return partial(TimeIn, _state(said, scope), said.form, duration(said.window) if said.window else None)


def _load(said: Said, scope: Scope) -> Maker:
    time = f"any {said.window}" if said.window else "time"
    unit = scope.unit(said.unit) if said.form == "cpu" else ""
    return _maker_of_events(measure_of(PHRASES[said.form].text.format(time=time, unit=unit)), scope)


def _state(said: Said, scope: Scope) -> StateEvents:
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


def _of_a_race(said: Said, scope: Scope) -> Maker:
    """Return the maker of a race, of lost flags, or of flags cleared along."""
    from .watched import clearing, losing, raced

    if said.form == "race":
        from .race import Race  # works on recorded runs, too, which no other measure needs imported

        return partial(Race, raced(said.unit, said.name, scope))
    from .modifies import LostFlags

    watched = clearing if said.form == "cleared" else losing
    return partial(LostFlags, watched(said.unit, said.name, scope))


def _value(said: Said, scope: Scope) -> Maker:
    if said.events:
        return _of_events(said, scope)
    chips = said.name or " or ".join(known_sensors())
    at = " at frame" if said.instant == "frame" else ""
    return _of_sentence(PHRASES["value"], scope, at=at, of=_of(said.name), chips=chips)


def _of(chip: str) -> str:
    return chip and f" of {chip}"


_MAKERS: dict[str, Callable[[Said, Scope], Maker]] = {
    "from": _of_events,
    "period": _period,
    "jitter": _jitter,
    "count": _of_events,
    "sum": _of_events,
    "level": _level,
    "calls": lambda said, scope: partial(EventMeasure, matcher(said.events[0], scope), form="count"),
    "stack": _stack,
    "interrupt": _latency,
    "reaction": _reaction,
    "gap": _gap,
    "margin": lambda said, scope: partial(Margin, scope.owner(said.unit, "I2C-A")),
    "SCL": lambda said, scope: _of_sentence(PHRASES["SCL"], scope, unit=scope.owner(said.unit, "I2C-A")),
    "time": _time,
    "each": _time,
    "share": _time,
    "cpu": _load,
    "bus": _load,
    "slack": lambda said, scope: _of_sentence(PHRASES["slack"], scope),
    "race": _of_a_race,
    "cleared": _of_a_race,
    "age": lambda said, scope: _of_sentence(MEASURES["age"], scope, of=_of(said.name)),
    "model": lambda said, scope: _of_sentence(MEASURES["model age"], scope, of=_of(said.name)),
    "value": _value,
    "lost": _of_a_race,
}
