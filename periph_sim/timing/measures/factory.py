"""Makers of measures: functions that make the measure named in a budget.

text --registry--> the measure of that name ---------------------------.
  '---language--> Said --events, names--> Matchers --> measure of events -+--> Maker --> Measure, one for each run
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

from ...core.records import Kind
from ...core.suggest import did_you_mean
from ...devices.sensor_rounds import known_sensors
from ...f28335.cpu.pie_map import LINES
from ..budget_schema import REPLY, SPAN, WATCH
from ..language.events import OF_AGENT, Event, Group, Matcher, matcher, stretch_of
from ..language.language import FORMS, Said, is_form, measure_of, name_text, near_form
from ..language.scope import BadEvent, Scope
from .event import EventCount, Jitter, Level, LevelAt, Period, ToFirstAccess
from .load import BusLoad, CpuLoad
from .margin import HeldPerTransfer, Margin
from .measure import Measure
from .pair import Between, CountBetween
from .registry import MEASURES, SLACK, make, value_error
from .states import EachTimeIn, State, TimeIn

OVERFLOWS = "overflows"  # of fixed-point arithmetic
Maker: TypeAlias = Callable[[], Measure]  # shares nothing with a run, so it serves all scenes of a case


def measure_named(text: str, scope: Scope) -> Measure:
    """Return the measure that a text names. Raise BadEvent if it names none, or events that this scene cannot have."""
    return maker_of(text, scope)()


def maker_of(text: str, scope: Scope) -> Maker:
    """Return a function that makes the measure that a text names. BadEvent as for `measure_named`."""
    return _maker_of_events(measure_of(text), scope) if is_form(text) else _called(text, scope)


def _called(name: str, scope: Scope) -> Maker:
    """Return the maker of a measure with a fixed name, or of a span, a reply or a watched wire."""
    if name.startswith(SPAN) and len(scope.units) == 1:
        scope.span("", name.removeprefix(SPAN))
    if name.startswith((SPAN, REPLY, WATCH)) or name in MEASURES:
        return partial(make, name)
    if name == OVERFLOWS:
        if scope.uncounted:
            what = "overflows are counted by Python firmware that reports them"
            raise BadEvent(f"{name!r}: {what}, and {scope.uncounted} does not run such firmware; leave the budget out")
        return maker_of("count of note overflow", scope)
    form = near_form(name)
    if form:
        raise BadEvent(f"there is no measure {name!r}; did you mean {form}?")
    names = [*MEASURES, OVERFLOWS, f"{SPAN}NAME", f"{REPLY}NAME", f"{WATCH}NAME"]
    hint = did_you_mean(name, names)
    if not hint.startswith("did you mean"):
        hint = f"it has {', '.join(names)}, and {', '.join(FORMS.values())}"
    raise BadEvent(f"there is no measure {name!r}; {hint}")


def make_of_events(text: str, scope: Scope) -> Measure:
    """Return the measure of events that a text names. BadEvent as for `measure_named`."""
    return _maker_of_events(measure_of(text), scope)()


def _maker_of_events(said: Said, scope: Scope) -> Maker:
    return _MAKERS[said.form](said, scope)


def _between(said: Said, scope: Scope) -> Maker:
    begin, end = (matcher(event, scope) for event in said.events)
    return partial(Between, begin, end, said.pairing, _group(said, scope))


def _group(said: Said, scope: Scope) -> Group | None:
    if not said.group:
        return None
    if not (scope.rounds if said.group == "round" else scope.bus):
        needs = "[controller] or [rounds]" if said.group == "round" else "SCL and SDA"
        raise BadEvent(f"'same {said.group}' needs {needs} in the scene, which has none; leave it out")
    return stretch_of(said.group, scope)


def _count(said: Said, scope: Scope) -> Maker:
    counted, *pair = (matcher(event, scope) for event in said.events)
    if not pair:
        return partial(EventCount, counted)
    return partial(CountBetween, counted, pair[0], pair[1], said.pairing, _group(said, scope))


def _jitter(said: Said, scope: Scope) -> Maker:
    make_of: Maker
    if said.events:
        make_of = partial(Period, matcher(said.events[0], scope))
    else:
        make_of = _called(said.name, scope) if said.of is None else _maker_of_events(said.of, scope)
        if not make_of().series:
            raise BadEvent(f"{said.text!r}: that is one number a run, so it has no jitter")
    return lambda: Jitter(make_of())


def _level(said: Said, scope: Scope) -> Maker:
    change, *at = (matcher(event, scope) for event in said.events)
    return partial(LevelAt, at[0], change) if at else partial(Level, change)


def _stack(said: Said, scope: Scope) -> Maker:
    """Return the maker of the stack's high-water mark, which is recorded whenever it grows."""
    text = "stack high-water"
    return partial(Level, Matcher(text, Kind.FLAG, frozenset((f"{scope.image(said.unit)}.CPU",)), "stack"))


def _reaction(said: Said, scope: Scope) -> Maker:
    i2c = f"{scope.owner(said.unit, 'I2C-A')}:I2C-A"
    ready = f"flag {i2c}.I2CSTR.SDIR rise or flag {i2c}.I2CSTR.XRDY rise"
    return maker_of(f"from {ready} to access W {i2c}.I2CDXR, last, same transfer", scope)


def _gap(said: Said, scope: Scope) -> Maker:
    if not scope.rounds:
        raise BadEvent(f"{said.text!r} needs [controller] or [rounds] in the scene, which has none")
    return maker_of("from last bus STOP of round to first bus START of round", scope)


def _latency(said: Said, scope: Scope) -> Maker:
    """Return the maker of an interrupt's latency, from the rise of its PIEIFR flag to its service routine's begin."""
    unit = scope.vector(said.unit, said.name)
    if said.name not in LINES:
        raise BadEvent(f"{said.name} does not come through the PIE, so nothing records when it was asked for")
    group, line = LINES[said.name]
    asked = f"PIE.PIEIFR{group}.INTx{line}"
    begin = Event("flag", f"flag {name_text(said.unit, asked)} rise", unit, asked, "rise")
    end = Event("interrupt", f"interrupt {name_text(said.unit, said.name)} enter", unit, said.name, "enter")
    asked_for, entered = matcher(begin, scope), matcher(end, scope)
    return partial(ToFirstAccess, asked_for, entered) if said.access else partial(Between, asked_for, entered, "last")


def _state(said: Said, scope: Scope) -> State:
    assert said.state is not None
    both = [
        [event for event in events if scope.controller or event.name not in OF_AGENT]
        for events in (said.state.enters, said.state.leaves)
    ]
    enters, leaves = ([matcher(event, scope) for event in events] for events in both)
    return State(said.state.text, tuple(enters), tuple(leaves))


def _of_a_race(said: Said, scope: Scope) -> Maker:
    """Return the maker of a race, of lost flags, or of flags cleared along."""
    from .watched import clearing, losing, raced

    if said.form == "race":
        from .race import Race  # works on recorded runs, too, which no other measure needs imported

        return partial(Race, raced(said.unit, said.name, scope))
    from .lost_flags import ClearedAlong, LostFlags

    if said.form == "cleared":
        return partial(ClearedAlong, clearing(said.unit, said.name, scope))
    return partial(LostFlags, losing(said.unit, said.name, scope))


def _value(said: Said, scope: Scope) -> Maker:
    row = value_error(said.name or " or ".join(known_sensors()), said.instant == "frame")
    return partial(row.make, said.name)


_MAKERS: dict[str, Callable[[Said, Scope], Maker]] = {
    "from": _between,
    "period": lambda said, scope: partial(Period, matcher(said.events[0], scope)),
    "jitter": _jitter,
    "count": _count,
    "level": _level,
    "calls": lambda said, scope: partial(EventCount, matcher(said.events[0], scope)),
    "stack": _stack,
    "interrupt": _latency,
    "reaction": _reaction,
    "gap": _gap,
    "margin": lambda said, scope: partial(Margin, scope.owner(said.unit, "I2C-A")),
    "SCL": lambda said, scope: partial(HeldPerTransfer, scope.owner(said.unit, "I2C-A")),
    "time": lambda said, scope: partial(TimeIn, _state(said, scope)),
    "each": lambda said, scope: partial(EachTimeIn, _state(said, scope)),
    "cpu": lambda said, scope: partial(CpuLoad, scope.unit(said.unit), said.window),
    "bus": lambda said, scope: partial(BusLoad, said.window),
    "slack": lambda said, scope: SLACK.make,
    "race": _of_a_race,
    "cleared": _of_a_race,
    "age": lambda said, scope: partial(MEASURES["age"].make, said.name),
    "model": lambda said, scope: partial(MEASURES["model age"].make, said.name),
    "value": _value,
    "lost": _of_a_race,
}
