"""The explanation of each budget's worst occurrence: from its Window to a Chain.

case, verdicts, typical ones --> windows --> a Chain each, beside that of the typical one
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from ....scene.case.model import Case
from ....scene.firmware_loader import Firmware
from ....timing.budget_schema import REPLY
from ....timing.verdict import Verdict
from ....traces.capture.capture import Span
from ....traces.drawing.capture_lanes import bit_of
from .chain import Chain, difference
from .occurrence import chain_of
from .window import BIT, Window, is_late, windows

REACH = 70  # bits: maximum extension of a picture towards the evidence, so that bytes remain distinguishable


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
    if window.begin != window.end or is_late(window.verdict) or not chain.steps:
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
