"""The explanation of each budget's worst occurrence: from its Window to a Chain.

case, verdicts, typical ones --> windows --> Evidence --> Chain by its measure, beside the typical one
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from ..core.records import Kind
from ..scene.case.model import Case
from ..scene.firmware_loader import Firmware
from ..scene.scope import scope_of_case
from ..timing.budget_schema import REPLY, SPAN, WATCH
from ..timing.language.events import EVERYTHING, Matcher, matcher
from ..timing.language.language import is_form, measure_of
from ..timing.measures.factory import measure_named
from ..timing.measures.race import Race
from ..timing.verdict import Verdict
from ..traces.capture.capture import Span
from ..traces.drawing.capture_lanes import bit_of
from . import bus_chain, event_chain, host_chain, reply_chain
from .chain import Chain, difference
from .evidence import Evidence
from .window import BIT, LATE, Window, windows

REACH = 70  # bits: maximum extension of a picture towards the evidence, so that bytes remain distinguishable

STORIES: dict[str, Callable[[Evidence], Chain]] = {
    "response": bus_chain.response,
    "stretch": bus_chain.stretch,
    "round": bus_chain.round_time,
    "missed rounds": bus_chain.missed,
    "nacked rounds": bus_chain.nacked,
    "nacked": bus_chain.nacked,
    "wrong bytes": bus_chain.wrong_bytes,
    "age": host_chain.age,
    "model age": host_chain.age,
    "fifo high-water": host_chain.fifo,
    "overruns": host_chain.fifo,
    "stuck": bus_chain.stuck,
    "slack": bus_chain.slack,
}


@dataclass(frozen=True, eq=False)
class Explained:
    """A Chain with its window."""

    window: Window
    chain: Chain


def explain(
    case: Case,
    verdicts: Iterable[Verdict],
    typical: Iterable[Verdict] = (),
    length: Fraction | None = None,
    programs: Mapping[str, Firmware] | None = None,
) -> dict[str, Explained]:
    """Return, by the name of its budget, the explanation of each worst occurrence that has an instant.

    typical: for budgets of these names, the least critical occurrence, for comparison. All data comes from one more run
    of the case; the other arguments are those of `windows`.
    """
    return {one.window.verdict.name: one for one in explain_each(case, verdicts, typical, length, programs)}


def explain_each(
    case: Case,
    verdicts: Iterable[Verdict],
    typical: Iterable[Verdict] = (),
    length: Fraction | None = None,
    programs: Mapping[str, Firmware] | None = None,
) -> list[Explained]:
    """Return explanations in the order of the verdicts, several of which may be of one budget."""
    worst = [verdict for verdict in verdicts if verdict.at_s is not None]
    names = {verdict.name for verdict in worst}
    usual = [verdict for verdict in typical if verdict.at_s is not None and verdict.name in names]
    found = windows(case, [*worst, *usual], length, programs)
    usual_windows = {w.verdict.name: w for w in found[len(worst) :]}
    return [_explained(case, w, usual_windows.get(w.verdict.name)) for w in found[: len(worst)]]


def _explained(case: Case, window: Window, usual: Window | None) -> Explained:
    chain = chain_of(case, window)
    if usual is not None and (usual.begin, usual.end) != (window.begin, window.end):
        there = chain_of(case, usual)
        comparable = chain.parts and (there.parts or not there.length)
        more = difference(chain.parts, there.parts) if comparable else ()
        chain = replace(chain, typical=there.length, typical_holds=usual.verdict.within, more=more)
    return Explained(_reaching(window, chain), chain)


def _reaching(window: Window, chain: Chain) -> Window:
    """Return the window with a picture extended to the evidence of an instant's chain, if that is near."""
    texts = tuple(step.what for step in chain.steps)
    if window.verdict.measure.startswith(REPLY) and chain.steps:
        begin = max(min(window.drawn.begin, window.begin + chain.steps[0].at), window.kept[0].begin)
        return replace(window, chain_texts=texts, drawn=Span(begin, window.drawn.end))
    if window.begin != window.end or window.verdict.measure in LATE or not chain.steps:
        return replace(window, chain_texts=texts)
    bit = bit_of(window.edges, window.timebase.ticks(BIT, "nearest"))
    begin, end = window.drawn
    for step in sorted(chain.steps, key=lambda step: abs(step.at)):
        first, last = (window.begin + step.at + room for room in (-bit, bit))
        if max(end, last) - min(begin, first) <= REACH * bit:
            begin, end = min(begin, first), max(end, last)
    return replace(
        window, chain_texts=texts, drawn=Span(max(begin, window.kept[0].begin), min(end, window.kept[-1].end))
    )


def chain_of(case: Case, window: Window) -> Chain:
    """Return the Chain of a window."""
    measure = window.verdict.measure
    evidence = Evidence(window, case)
    if measure in STORIES:
        return STORIES[measure](evidence)
    if measure.startswith(REPLY):
        return reply_chain.reply(evidence)
    scope = scope_of_case(case)
    if measure.startswith(SPAN):
        name = measure.removeprefix(SPAN)
        begin, end = (Matcher(f"span {name}", Kind.SPAN, None, name, EVERYTHING, value) for value in (1, 0))
        return event_chain.between(evidence, begin, end)
    if measure.startswith(WATCH):
        wire = case.watch[measure.removeprefix(WATCH)].wire
        edges = [matcher(f"edge {wire} {way}", scope) for way in ("rise", "fall")]
        return event_chain.once(evidence, event_chain.one_of(evidence, edges, evidence.window.begin))
    if not is_form(measure):
        raise ValueError(f"there is no explanation of {measure!r}; expected a measure of timing.measures")
    said = measure_of(measure)
    made = measure_named(measure, scope)
    events: list[Matcher] = list(getattr(made, "matchers", ()))
    if said.form == "interrupt":
        return event_chain.latency(evidence, events[0], None if said.access else events[1])
    if said.form in ("from", "reaction", "gap"):
        return event_chain.between(evidence, events[0], events[1])
    if said.form == "period":
        return event_chain.between(evidence, events[0], events[0])
    if said.form == "jitter":
        return (
            event_chain.two_periods(evidence, matcher(said.events[0], scope))
            if said.events
            else event_chain.once(evidence)
        )
    if said.form == "each":
        first, last = (event_chain.one_of(evidence, events, at) for at in (evidence.window.begin, evidence.window.end))
        return event_chain.between(evidence, first, last)
    if said.form in ("level", "time", "count", "sum", "stack", "calls") or (said.form == "value" and said.events):
        return event_chain.once(evidence, events[0])
    if isinstance(made, Race):
        return event_chain.around(evidence, made.watched)
    if said.form in ("age", "model"):
        return host_chain.age(evidence)
    if said.form == "value":
        return host_chain.value(evidence)
    return event_chain.whole(evidence)
