"""The case that `new --live` writes: it repeats a live session, and the log of the session drives the wires.

case file, its changes --+
log --> wires, duration -+--> case with [outside], and with new budgets if the case has none
"""

from __future__ import annotations

from os.path import relpath
from pathlib import Path

import click

from ...processor.user_code import output_muted
from ...scene.case.load import apply, case_of
from ...scene.case.toml_file import read
from ...scene.outside_log import BadLog, LogReader
from ...scene.scene import Scene
from ...timing.verdict import NOT_JUDGED
from ..reports.case_text import Tree, move_files, toml, usable_budgets
from .command_frame import check_file_name

MEASURES = (  # measures that become budgets if a case has no budgets
    *("overruns", "fifo high-water", "missed rounds", "nacked rounds", "nacked", "stretch", "response", "round"),
)


def files_of(log: Path, given: str | None) -> tuple[dict[Path, str], Path]:
    """Return the new files, as a dictionary from paths to texts, and the path of the new case.

    log: the log of the live session.
    given: the name of the new case; None for the name of the session's case followed by `_live`.

    Raise ClickException or BadCase if the log is invalid, if its case was not read from a file, if this file is missing
    or invalid, or if the new name is no name for files.
    """
    try:
        reader = LogReader(log)
        head = reader.head
        if not head.file:
            way_out = "replay it with Python's replay()"
            raise click.ClickException(f"{log}: its case, {head.case}, came from no file; {way_out}")
        for _ in reader.instants():
            pass
    except BadLog as error:
        raise click.ClickException(str(error)) from None
    source = log.parent / head.file
    place = Path(given) if given is not None else source.with_name(f"{source.stem}_live")
    place = place.with_suffix("") if place.suffix == ".toml" else place
    check_file_name(place)
    _, tree = read(source, "case")
    for change in head.changes:
        apply(tree, change)
    case = case_of(tree, source)
    move_files(tree, source.parent, place.parent)
    if reader.unfinished:
        click.echo(reader.unfinished, err=True)
    tree |= {
        "name": place.name,
        "about": f"The live session of {case.name}, driven from outside by {log.name}.",
        "duration": f"{reader.end / head.ticks_per_second:.12f} s",
        "outside": {"wires": list(head.wires), "log": relpath(log, place.parent)},
    }
    target = place.with_name(f"{place.name}.toml")
    # The tree has every [[budget]] of the file, also those that cannot be judged with [outside]. `case.budget` lacks
    # these, but also has the budgets that are made from other tables, such as [watch].
    if not tree.get("budget") and not case.budget:
        tree["budget"] = _as_seen(tree, target)
    return {target: toml(tree)}, target


@output_muted()
def _as_seen(tree: Tree, target: Path) -> list[Tree]:
    """Run the new case. Return a budget for each of the MEASURES that has a value, with this value as its limit."""
    # Each measure is tried with two limits. A duration needs a limit with a unit, and a count needs a limit without a
    # unit, so at most one of the two budgets is usable.
    named = ({"name": measure, "measure": measure, "max": limit} for measure in MEASURES for limit in (0, "0 us"))
    found = usable_budgets(tree, target, named)
    result = Scene(case_of({**tree, "budget": found}, target)).run()
    budgets: list[Tree] = []
    for budget, verdict in zip(found, result.budgets, strict=True):
        if verdict.worst is not None and verdict.verdict != NOT_JUDGED:
            most = f"{verdict.worst} us" if verdict.unit == "us" else verdict.worst
            budgets.append({**budget, "max": most, "why": "the result of the live session"})
    return budgets
