"""The result of a run as text and tables for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...core.options import Value
from ...core.phrases import counted
from ...scene.case.model import Case
from ...scene.result import SKIPPED, Result
from ...timing.verdict import (
    FAIL,
    NOT_JUDGED,
    PASS,
    Verdict,
    assumes_lines,
    broken,
    figure,
    limit,
    simulated,
    title,
)
from ...timing.verdict import legend as meanings
from .command_frame import print_table, say

A_BUDGET = 'budget = [{ name = "CPU load", measure = "cpu load", max = "50 %" }]'
# A dictionary from names of counts to their singular. Names that are not in it are used for all numbers: `2 missed`.
THINGS = {"rounds": "round", "frames": "frame", "overruns": "overrun", "resets": "reset"}
NOTHING: Mapping[str, Sequence[str]] = {}  # the value of `assumed` if no options are known
MOST_WRONG = 12  # maximum number of places of wrong bytes that are listed
STYLES = {PASS: "", FAIL: "red", NOT_JUDGED: "yellow"}  # styles of a budget's row in a table
HEADLINES = {**STYLES, PASS: "green"}  # styles of the line that states a run's verdict


def show(result: Result, case: Case, verbose: bool = False, assumed: Mapping[str, Sequence[str]] | None = None) -> None:
    """Print the result of a run.

    assumed: a dictionary from broken budgets to the options for undocumented behaviours that were used in their worst
        occurrences; None if it is unknown.
    verbose: True to list the undocumented behaviours that the run assumed, and the counts of skipped polls and bits.
    """
    by_estimate = f"; cycles between accesses of {' and '.join(result.estimated)} are estimated"
    head = f"{result.case}: {title(result.verdict, result.budgets)}{by_estimate if result.estimated else ''}"
    say(head, style=HEADLINES[result.verdict])
    if result.budgets:
        budget_table(result.budgets)
    else:
        say(f"the case has no budget; put one at its top, for instance:\n{A_BUDGET}")
    to_units = counted(result.sci_bytes, "SCI byte")
    sci_bytes = f"{to_units} to units and {result.sci_bytes_sent} from units" if result.sci_bytes_sent else to_units
    traffic = f"{counted(result.wire_bytes, 'I2C byte')}, {sci_bytes}, {counted(result.events, 'event')}"
    say(
        *legend(result.budgets, assumed or NOTHING, verbose),
        f"{simulated(result.simulated_s)} simulated; {traffic}",
        *_counts(result, verbose),
    )
    say(*(f"{each.name}: {each.found}" for each in result.budgets if each.found and not each.broken))
    if result.first_wrong:
        say(f"first wrong: {result.first_wrong}")
    say(*(f"wrong: {place}, {counted(times, 'time')}" for place, times in list(result.wrong.items())[:MOST_WRONG]))
    say(*(f"stuck: {line}" for line in result.stuck), *(f"at the end: {line}" for line in result.ends))
    say(*(f"note: {line}" for line in result.notes))
    say(*assumptions(result.unknowns, case, verbose))


def _counts(result: Result, verbose: bool) -> list[str]:
    shown = [
        counted(count, THINGS[name]) if name in THINGS else f"{count} {name.replace('_', ' ')}"
        for name, count in result.counts.items()
        if count and name != SKIPPED
    ]
    shown += result.reception(zero=verbose)
    lines = [", ".join(shown)] if shown else []
    skipped = ((result.counts.get(SKIPPED), "polls"), (result.bytes_skipped, "times seven bits of an I2C byte"))
    if verbose:
        lines += [f"skipped {rounded(count)} {what}" for count, what in skipped if count]
    return lines


def rounded(count: int) -> str:
    """Format a large count with few digits: `142.7 M`, `28.2 k`, `999`."""
    for size, letter in ((10**6, "M"), (10**3, "k")):
        if count >= size:
            return f"{count / size:.1f} {letter}"
    return str(count)


def budget_table(budgets: Sequence[Verdict]) -> None:
    """Print a table with a row for each budget. Broken budgets are red, and budgets that are not judged are yellow.

    Only the names of budgets are wrapped into several lines if the table is too wide.
    """
    rows = []
    for one in budgets:
        numbers = (figure(one.worst, one.unit), limit(one.limit, one.unit, one.which), figure(one.margin, one.unit))
        rows.append(((one.name, *numbers, one.counted, one.word), STYLES[one.verdict]))
    print_table(("budget", "seen", "limit", "margin", "count", ""), rows, right=range(1, 5), whole=range(1, 6))


def broken_lines(
    budgets: Sequence[Verdict], assumed: Mapping[str, Sequence[str]] = NOTHING, verbose: bool = False
) -> list[str]:
    """Return a line for each broken budget with the reason and, if it is known, the instant.

    assumed: a dictionary from broken budgets to the options for undocumented behaviours that were used in their worst
        occurrences. A further line states the number of these options.
    verbose: True to list these options instead of their number.
    """
    lines = []
    for each in budgets:
        if each.broken:
            names = assumed.get(each.name, ())
            lines.append(f"{each.name}: {broken(each)}")
            if verbose:
                lines += assumes_lines(names)
            elif names:
                lines.append(f"  it assumes {counted(len(names), 'undocumented behaviour')} (worst names them)")
    return lines


def legend(
    budgets: Sequence[Verdict], assumed: Mapping[str, Sequence[str]] = NOTHING, verbose: bool = False
) -> list[str]:
    """Return the lines below a table of budgets: the reason for each broken budget, and the legend."""
    if not budgets:
        return []
    return [*broken_lines(budgets, assumed, verbose), *meanings({each.word for each in budgets})]


def assumptions(names: Sequence[str], case: Case, verbose: bool) -> list[str]:
    """Return lines about the undocumented behaviours that a run assumed; an empty list if it assumed none.

        assumes 23 undocumented behaviours (-v lists them)

        assumes 2 undocumented behaviours; `regs --options` lists the questions:      verbose
          dsp.i2c.bcm_reset = 0; the default is 1
          dsp.i2c.rrdy_point = fall8, the default

    names: the options of these behaviours, as `UNIT.GROUP.OPTION` or `CHIP.OPTION`.
    verbose: True for a line for each behaviour, as in the second example.
    """
    if not names:
        return []
    head = f"assumes {counted(len(names), 'undocumented behaviour')}"
    if not verbose:
        return [f"{head} (-v lists {'them' if len(names) > 1 else 'it'})"]
    return [
        f"{head}; `regs --options` lists the questions:",
        *(f"  {name} {_answer(name, case)}" for name in names),
    ]


def _answer(name: str, case: Case) -> str:
    from ..reports.questions.question import shown
    from .regs import OPTIONS

    owner, _, rest = name.partition(".")
    given: dict[str, Value]
    if owner in case.unit:
        group, _, option = rest.partition(".")
        given = case.unit[owner].options.get(group, {})
    else:
        group, option, given = case.chip[owner].model, rest, case.chip[owner].options
    default = OPTIONS[group]().unrecorded()[option]
    value = given.get(option, default)
    return f"= {shown(value)}{', the default' if value == default else f'; the default is {shown(default)}'}"
