"""Comparison of a baseline with a run: one change per figure that differs.

The comparison is exact unless a tolerance is given. With a tolerance, times may differ by up to this tolerance, and
instants are not compared, because they move with the times. Counts of simulated events and of skipped polls describe
the simulation and not the firmware, so their changes are only notes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ....core.table import Table
from .event_chain import PART, EventLine, first_divergence, first_moved
from .files import Baseline, Figures

NOTES = ("events", "polls_skipped")
EARLIER = ("byte_level", "sci_frames", "sci_frames_passed")  # counts that only earlier versions wrote to baselines
NOT_EARLIER = ("SCI bytes from units",)  # counts that these earlier versions did not write
CHAIN = "chain"
BUS_BYTES = "bus bytes"
MOST_MOVED = 3  # maximum number of moved accesses that are shown for a case
SAME = Fraction(1, 1000)  # in seconds; an occurrence that moved by less than this is regarded as the same occurrence
VALUES = ("worst", "least")
INSTANTS = ("worst_at", "least_at")


@dataclass
class Change:
    """A figure that changed.

    budget: the name of the budget; None for a figure of the whole case.
    figure: the name of the figure.
    before, now: the value of the figure in the baseline and in the run; None if there is no value.
    text: a description of the change.
    why: the reason for the change; "" if it is unknown.
    note: True if the change is only shown and does not make the check fail.
    """

    budget: str | None
    figure: str
    before: int | str | None
    now: int | str | None
    text: str
    why: str = ""
    note: bool = False

    def __str__(self) -> str:
        return f"{self.text}: {self.why}" if self.why else self.text


def compare(before: Baseline, now: Baseline, tolerance: Fraction | int = 0) -> list[Change]:
    """Return the differences of a run from its baseline, in the order of the case's budgets. Chains are not compared.

    tolerance: the number of cycles by which times may differ.
    """
    changes = _settings("", None, before, now, ("case", "simulated", "ticks_per_second", "ticks_per_cycle"))
    for name in [*now.budgets, *(name for name in before.budgets if name not in now.budgets)]:
        old_one, new_one = before.budgets.get(name), now.budgets.get(name)
        if old_one is None:
            changes.append(Change(name, "budget", None, name, f"{name}: a new budget, not in the baseline"))
        elif new_one is None:
            changes.append(Change(name, "budget", name, None, f"{name}: in the baseline, but not a budget of the case"))
        else:
            changes += _budget(name, before, old_one, now, new_one, tolerance)
    notes = NOTES + EARLIER + (() if before.counts.keys().isdisjoint(EARLIER) else NOT_EARLIER)
    old_counts, new_counts = ({"events": of.events} | of.counts for of in (before, now))
    for key in ["events", *sorted({*before.counts, *now.counts})]:
        was, came = old_counts.get(key, 0), new_counts.get(key, 0)
        if was != came:
            shown = key.replace("_", " ")
            changes.append(Change(None, key, was, came, f"{shown} {was} -> {came}", note=key in notes))
    return changes + _bus_bytes(before.bus_bytes, now.bus_bytes)


def _settings(prefix: str, budget: str | None, before: Table, now: Table, keys: Sequence[str]) -> list[Change]:
    """Return a change for each of these keys whose values in the two tables differ."""
    values = [(key, getattr(before, key), getattr(now, key)) for key in keys]
    return [Change(budget, key, old, new, f"{prefix}{key} {old} -> {new}") for key, old, new in values if old != new]


def _bus_bytes(before: list[str], now: list[str]) -> list[Change]:
    """Compare the bytes on the bus. Return a change for the first digest that differs from the baseline.

    If the baseline has no digests, return a note instead.

    before, now: the digests in the baseline and of the run. There is one digest for every PART bytes.
    """
    if before == now:
        return []
    if not before:
        text = "the baseline has no bus bytes, so their values are not compared; --update-baseline adds them"
        return [Change(None, BUS_BYTES, None, now[0], text, note=True)]
    part = next((n for n, (was, came) in enumerate(zip(before, now, strict=False)) if was != came), None)
    if part is None:
        part = min(len(before), len(now))
    was, came = (digests[part] if part < len(digests) else "none" for digests in (before, now))
    where = f"first among bytes {part * PART + 1} to {(part + 1) * PART} of the run"
    return [Change(None, BUS_BYTES, was, came, f"bytes on the bus differ from the baseline, {where}")]


def _budget(
    name: str, before: Baseline, old: Figures, now: Baseline, new: Figures, tolerance: Fraction | int
) -> list[Change]:
    changes = _settings(f"{name} ", name, old, new, ("measure", "unit"))
    for figure in _figures(old, new):
        was, came = getattr(old, figure), getattr(new, figure)
        timed = figure in INSTANTS or (figure in VALUES and new.unit == "time" == old.unit)
        if was == came or (tolerance and figure in INSTANTS):
            continue
        if timed and None not in (was, came) and abs(came - was) <= tolerance * now.ticks_per_cycle:
            continue
        shown = figure.replace("_", " ")
        if timed:
            nothing = "never" if figure in INSTANTS else "nothing measured"
            text = f"{name} {shown} {_cycles(before, was, nothing)} -> {_cycles(now, came, nothing)}"
            if None not in (was, came):
                text = text.replace(" cycles ->", " ->")
        else:
            of = new.unit if figure in VALUES else "count"
            counted = "" if of == "count" else f" {of}"
            text = f"{name} {shown} {number_text(was, of)} -> {number_text(came, of)}{counted}"
        changes.append(Change(name, figure, was, came, text))
    return changes


def _figures(old: Figures, new: Figures) -> tuple[str, ...]:
    """Return the names of the figures to compare, without figures that only repeat the worst value.

    The figures of the least value are left out if the value is not a time, and if the worst and the least value of each
    run are equal and have the same instant. In this case, `count` is left out, too, if it is equal to the worst value
    of each run, as for a measure that counts something.
    """
    one = [f.unit != "time" and (f.worst, f.worst_at) == (f.least, f.least_at) for f in (old, new)]
    if not all(one):
        return (*VALUES, *INSTANTS, "count")
    if old.count == old.worst and new.count == new.worst:
        return ("worst", "worst_at")
    return ("worst", "worst_at", "count")


def explain(changes: list[Change], before: Baseline, now: Baseline, first_wrong: str) -> None:
    """Set the reason of each changed value that has a chain of events: the worst or the least value of a budget.

    The reason is the difference between the chain in the baseline and the chain in the run. If the baseline has no
    chain, it is the instant of the value. If wrong bytes are new, it is the first wrong byte.

    first_wrong: the description of the first wrong byte of the run; "" if there is none.
    """
    for change in changes:
        if change.budget is None or change.budget not in before.budgets or change.budget not in now.budgets:
            continue
        old, new = before.budgets[change.budget], now.budgets[change.budget]
        if change.figure != new.chain_of:
            continue
        at = new.worst_at if new.chain_of == "worst" else new.least_at
        if new.measure == "wrong bytes" and first_wrong and not old.worst:
            change.why = first_wrong
        elif old.chain and new.chain and old.chain_of == new.chain_of:
            change.why = first_divergence(old.chain, new.chain, now.cycles) or "no event of its chain moved"
        elif at is not None and not old.chain:
            change.why = f"first at {at * 1000 / now.ticks_per_second:.6f} ms; in the baseline there was none"


def moved_accesses(
    before: Baseline, now: Baseline, chains: Mapping[str, EventLine], tolerance: Fraction | int = 0
) -> list[Change]:
    """Return a change for each access that moved in the chain of a budget, up to MOST_MOVED changes.

    chains: a dictionary from budgets to their chains in the run.
    tolerance: the number of cycles by which times may differ.
    """
    found: dict[str, Change] = {}
    for name, chain in chains.items():
        old, new = before.budgets.get(name), now.budgets.get(name)
        if old is None or new is None or not old.chain or (old.measure, old.chain_of) != (new.measure, new.chain_of):
            continue
        then_at, now_at = (f.worst_at if f.chain_of == "worst" else f.least_at for f in (old, new))
        if then_at is None or now_at is None or abs(now_at - then_at) >= SAME * now.ticks_per_second:
            continue  # the chains in the run and in the baseline belong to different occurrences
        moved = first_moved(old.chain, chain, now.cycles, tolerance * now.ticks_per_cycle)
        if moved and moved not in found:
            found[moved] = Change(name, CHAIN, None, None, f"{name} holds, but an access moved: {moved}")
    return [*found.values()][:MOST_MOVED]


def _cycles(of: Baseline, ticks: int | None, nothing: str) -> str:
    return nothing if ticks is None else f"{of.cycles(ticks)} cycles"


def number_text(value: int | None, unit: str) -> str:
    """Format a figure that is not a time, without its unit. Return "none" for None.

    value: a number of millionths of a whole if `unit` is "%", of millionths of an LSB if it is "LSB"; else the figure.
    """
    if value is None:
        return "none"
    if unit == "%":
        return f"{value / 10_000:.4f}"
    return f"{value / 1_000_000:.6f}" if unit == "LSB" else str(value)
