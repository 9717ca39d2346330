"""A measure of its text: what a budget says and what a scene has go in, a Measure comes out.

text --registry--> the measure of that name ---------------------------.
  '---language--> Said --events, names--> Matchers --> measure of events -+--> Measure
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.records import Kind
from ...core.suggest import did_you_mean
from ...f28335.cpu.pie_map import LINES
from ..budget_schema import REPLY, SPAN, WATCH
from ..language.events import OF_AGENT, Event, Group, Matcher, matcher, stretch_of
from ..language.language import FORMS, Said, is_form, measure_of, name_text, near_form
from ..language.scope import BadEvent, Scope
from .age import Age, ModelAge
from .event import EventCount, Jitter, Level, LevelAt, Period, ToFirstAccess
from .load import BusLoad, CpuLoad
from .margin import HeldPerTransfer, Margin
from .measure import Measure
from .pair import Between, CountBetween
from .registry import MEASURES, make
from .round import Slack
from .states import EachTimeIn, State, TimeIn


def measure_named(text: str, scope: Scope) -> Measure:
    """The measure that a text names. BadEvent, a sentence, if it names none, or events that this scene cannot have."""
    return make_of_events(text, scope) if is_form(text) else _called(text)


def _called(name: str) -> Measure:
    """The measure of a fixed name, of a span, a reply, or a watched wire."""
    if name.startswith((SPAN, REPLY, WATCH)) or name in MEASURES:
        return make(name)
    form = near_form(name)
    if form:
        raise BadEvent(f"there is no measure {name!r}; did you mean {form}?")
    names = [*MEASURES, f"{SPAN}NAME", f"{REPLY}NAME", f"{WATCH}NAME"]
    hint = did_you_mean(name, names)
    if not hint.startswith("did you mean"):
        hint = f"it has {', '.join(names)}, and {', '.join(FORMS.values())}"
    raise BadEvent(f"there is no measure {name!r}; {hint}")


def make_of_events(text: str, scope: Scope) -> Measure:
    """The measure that a text names. BadEvent if it names none, or events that this scene cannot have."""
    return make_of(measure_of(text), scope)


def make_of(said: Said, scope: Scope) -> Measure:
    """The measure that is said. BadEvent as for `make_of_events`."""
    return _MADE[said.form](said, scope)


def _between(said: Said, scope: Scope) -> Measure:
    begin, end = (matcher(event, scope) for event in said.events)
    return Between(begin, end, said.pairing, _group(said, scope))


def _group(said: Said, scope: Scope) -> Group | None:
    if not said.group:
        return None
    if not (scope.rounds if said.group == "round" else scope.bus):
        needs = "[controller] or [rounds]" if said.group == "round" else "SCL and SDA"
        raise BadEvent(f"'same {said.group}' needs {needs} in the scene, which has none; leave it out")
    return stretch_of(said.group, scope)


def _count(said: Said, scope: Scope) -> Measure:
    counted, *pair = (matcher(event, scope) for event in said.events)
    if not pair:
        return EventCount(counted)
    return CountBetween(counted, pair[0], pair[1], said.pairing, _group(said, scope))


def _jitter(said: Said, scope: Scope) -> Measure:
    if said.events:
        return Jitter(Period(matcher(said.events[0], scope)))
    of = _called(said.name) if said.of is None else make_of(said.of, scope)
    if not of.series:
        raise BadEvent(f"{said.text!r}: that is one number a run, so it has no jitter")
    return Jitter(of)


def _level(said: Said, scope: Scope) -> Measure:
    change, *at = (matcher(event, scope) for event in said.events)
    return LevelAt(at[0], change) if at else Level(change)


def _stack(said: Said, scope: Scope) -> Measure:
    """Each new most of words on the stack."""
    text = "stack high-water"
    return Level(Matcher(text, Kind.FLAG, frozenset((f"{scope.image(said.unit)}.CPU",)), "stack"))


def _reaction(said: Said, scope: Scope) -> Measure:
    i2c = f"{scope.owner(said.unit, 'I2C-A')}:I2C-A"
    ready = f"flag {i2c}.I2CSTR.SDIR rise or flag {i2c}.I2CSTR.XRDY rise"
    return make_of_events(f"from {ready} to access W {i2c}.I2CDXR, last, same transfer", scope)


def _gap(said: Said, scope: Scope) -> Measure:
    if not scope.rounds:
        raise BadEvent(f"{said.text!r} needs [controller] or [rounds] in the scene, which has none")
    return make_of_events("from last bus STOP of round to first bus START of round", scope)


def _latency(said: Said, scope: Scope) -> Measure:
    """From the rise of its flag in PIEIFR, when the module asks, to the first instruction of its service routine."""
    unit = scope.vector(said.unit, said.name)
    if said.name not in LINES:
        raise BadEvent(f"{said.name} does not come through the PIE, so nothing records when it was asked for")
    group, line = LINES[said.name]
    asked = f"PIE.PIEIFR{group}.INTx{line}"
    begin = Event("flag", f"flag {name_text(said.unit, asked)} rise", unit, asked, "rise")
    end = Event("interrupt", f"interrupt {name_text(said.unit, said.name)} enter", unit, said.name, "enter")
    asked_for, entered = matcher(begin, scope), matcher(end, scope)
    return ToFirstAccess(asked_for, entered) if said.access else Between(asked_for, entered, "last")


def _state(said: Said, scope: Scope) -> State:
    assert said.state is not None
    both = [
        [event for event in events if scope.controller or event.name not in OF_AGENT]
        for events in (said.state.enters, said.state.leaves)
    ]
    enters, leaves = ([matcher(event, scope) for event in events] for events in both)
    return State(said.state.text, tuple(enters), tuple(leaves))


def _of_a_race(said: Said, scope: Scope) -> Measure:
    """Of flags around writes."""
    from .watched import clearing, losing, raced

    if said.form == "race":
        from .race import Race  # works on recorded runs, too, which no other measure needs imported

        return Race(raced(said.unit, said.name, scope))
    from .lost_flags import ClearedAlong, LostFlags

    if said.form == "cleared":
        return ClearedAlong(clearing(said.unit, said.name, scope))
    return LostFlags(losing(said.unit, said.name, scope))


def _value(said: Said, scope: Scope) -> Measure:
    from .value import ValueDeviation  # and with it the sensor models

    return ValueDeviation(said.name, said.instant == "frame")


_MADE: dict[str, Callable[[Said, Scope], Measure]] = {
    "from": _between,
    "period": lambda said, scope: Period(matcher(said.events[0], scope)),
    "jitter": _jitter,
    "count": _count,
    "level": _level,
    "calls": lambda said, scope: EventCount(matcher(said.events[0], scope)),
    "stack": _stack,
    "interrupt": _latency,
    "reaction": _reaction,
    "gap": _gap,
    "margin": lambda said, scope: Margin(scope.owner(said.unit, "I2C-A")),
    "SCL": lambda said, scope: HeldPerTransfer(scope.owner(said.unit, "I2C-A")),
    "time": lambda said, scope: TimeIn(_state(said, scope)),
    "each": lambda said, scope: EachTimeIn(_state(said, scope)),
    "cpu": lambda said, scope: CpuLoad(scope.unit(said.unit), said.window),
    "bus": lambda said, scope: BusLoad(said.window),
    "slack": lambda said, scope: Slack(),
    "race": _of_a_race,
    "cleared": _of_a_race,
    "age": lambda said, scope: Age(said.name),
    "model": lambda said, scope: ModelAge(said.name),
    "value": _value,
    "lost": _of_a_race,
}
