"""Result of `periph-sim prove` as text: a table of the budgets, and the windows of phases in which they break.

The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ...core.phrases import counted
from ...core.text_table import paragraph, together
from ...proof.cover import Window, Worst
from ...timing.verdict import BROKEN, NOT_JUDGED, figure, limit
from ..reports.certain_failure import CertainFailure
from ..reports.coverage import Coverage
from .command_frame import print_table, say

HELD = "held"  # the word for a budget that no run broke
MOST_LISTED = 4  # maximum number of windows of a budget, and of drifting failures, that are listed; --json has all


def words_of(found: Coverage) -> dict[str, str]:
    """Return the word for each covered budget, by its name: BROKEN, NOT_JUDGED or HELD."""
    broken = {window.name for window in found.windows}
    broken |= {name for one in found.found.drifting for name in one.names}
    if found.stopped:  # after a stop, windows can be missing
        broken |= {name for failures in found.found.failed.values() for name in failures}
    words = {}
    for budget in found.case.case.budget:
        worst = found.found.worst.get(budget.name)
        words[budget.name] = NOT_JUDGED if worst is None or not found.found.judged.get(budget.name) else HELD
        if budget.name in broken:
            words[budget.name] = BROKEN
    return words


def show(found: Coverage, certain: Sequence[CertainFailure], files: Sequence[Path]) -> None:
    """Print a coverage. certain: what is certain at the ends of windows. files: the written files."""
    phases = found.case.phases
    words = words_of(found)
    numbers = Counter(words.values())
    counts = ", ".join(f"{numbers[word]} {word}" for word in (BROKEN, NOT_JUDGED, HELD) if numbers[word])
    missing = f"; stopped, {counted(found.missing, 'phase')} not run" if found.stopped else ""
    head = f"{found.case.case.name}: {found.run_count:,} of {phases.count:,} phases run; budgets: {counts}{missing}"
    say(head, style="bold")
    rows = []
    for name, word in words.items():
        worst = found.found.worst.get(name)
        shown = ("-", "-", "-") if worst is None else _cells(found, worst)
        rows.append(((name, *shown, word), "red" if word == BROKEN else ""))
    print_table(("budget", "worst", "limit", "at phase", ""), rows, right=(1, 2, 3), whole=(1, 2, 3, 4))
    for line in _lines(found, certain):
        say(line)
    for file in files:
        say(f"written: {file}")


def _cells(found: Coverage, worst: Worst) -> tuple[str, str, str]:
    verdict, (first, last) = worst.verdict, (worst.phases[0], worst.phases[-1])
    at = found.choice.time(first) if first == last else f"{found.choice.time(first)} ..."
    return figure(verdict.worst, verdict.unit), limit(verdict.limit, verdict.unit, verdict.which), at


def _lines(found: Coverage, certain: Sequence[CertainFailure]) -> list[str]:
    phases, step, lines = found.case.phases, found.choice.step, list[str]()
    said: dict[str, str] = {}  # the name of the first failure with a text, by the text
    moved = phases.moved.removesuffix("s")
    for name in dict.fromkeys(window.name for window in found.windows):
        windows = [window for window in found.windows if window.name == name]
        for window in windows[:MOST_LISTED]:
            lines.append(_window_text(found, window))
            for end in certain:
                if end.name == name and end.phase in (window.first, window.last):
                    text = "\n".join(_certain_text(found, window, end))
                    first = said.setdefault(text, name)  # two failures can have the same cause
                    lines.append(text if first == name else f"  {_end(window, end)} phase: as for {first}")
        widths = [_width(found, window) for window in windows[MOST_LISTED:]]
        if widths:
            lines.append(f"  {counted(len(widths), 'more window')} of {min(widths):,} to {max(widths):,} phases")
    for one in found.found.drifting[:MOST_LISTED]:
        names, rounds = ", ".join(sorted(one.names)), found.choice.rounds
        lines.append(f"{names}: broken at {found.choice.time(one.last)} in a run whose phase increases from")
        lines.append(f"  {found.choice.time(one.first)} on, but not in {rounds} rounds at one phase")
    if len(found.found.drifting) > MOST_LISTED:
        lines.append(f"  {len(found.found.drifting) - MOST_LISTED} more of these")
    lines += [f"{name}: for example, {reason}" for name, reason in found.found.reasons.items()]
    since = "the start of a round" if phases.is_relative else "its time in the case"
    which = f"the time of the first {moved}" if phases.start_up else f"the start of a {moved} after {since}"
    lines.append(f"phase: {which}")
    each = "each cycle" if step == 1 else f"each {step}th cycle"
    near = f"{found.choice.near:,} phases near a write, else " if found.choice.near else ""
    lines.append(f"chosen: {near}{each}; fewer within windows")
    lines.append(f"held: {_held_in(found)}")
    if certain:
        lines.append("certain: all runs that did the same up to then fail, of at most 16 near this end")
    lines += [f"not covered: {name}: {reason}" for name, reason in found.case.left_out.items()]
    return lines


def _held_in(found: Coverage) -> str:
    """Return what "held" means for a phase, such as "in one run of each phase"."""
    phases, rounds = found.case.phases, found.choice.rounds
    if phases.moved == "sends":
        return "in one run of each phase"
    if phases.start_up:
        return f"in at least {rounds} rounds after each start"
    return f"in one round of each phase; at the ends of windows, in {rounds} rounds"


def _width(found: Coverage, window: Window) -> int:
    """Return the number of phases of a window, also of one that continues from the last phase to phase 0."""
    beyond_end = found.case.phases.count if window.first > window.last else 0
    return window.last - window.first + beyond_end + 1


def _window_text(found: Coverage, window: Window) -> str:
    ends = f"{found.choice.time(window.first)} to {found.choice.time(window.last)}"
    sides = "both neighbours held" if window.is_closed else "it reaches an end of the phases"
    if _width(found, window) == found.case.phases.count:
        sides = "all phases of the period"
    return f"{window.name}: broken from {ends}\n  {_width(found, window):,} phases, {window.run:,} of them run; {sides}"


def _certain_text(found: Coverage, window: Window, one: CertainFailure) -> list[str]:
    which = _end(window, one)
    held = f"at {found.choice.time(one.held)}, which held"
    if one.event is not None:
        lines = paragraph(f"{which} phase: certain from {one.event.at} on: {_unbroken(one.event.text)}", "  ", "    ")
    elif one.instead is not None:
        lines = [f"  {which} phase: certain when nothing further happens"]
    else:
        return paragraph(f"{which} phase: the firmware does the same as {held}, only at other times", "  ", "    ")
    instead = "nothing" if one.instead is None else _unbroken(one.instead.text)
    return lines + paragraph(f"{held}: {instead}", "    ", "      ")


def _end(window: Window, one: CertainFailure) -> str:
    return "first" if one.phase == window.first else "last"


def _unbroken(text: str) -> str:
    return text.replace(" = ", together(" = "))
