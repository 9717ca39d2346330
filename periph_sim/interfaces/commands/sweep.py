"""`periph-sim sweep CASE --vary KEY=VALUES`: run a case with many values of its keys, and print the worst results."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...scene.case.model import BadCase
from ...timing.verdict import figure, limit
from ..reports.sweep.runs import values_of
from .command_frame import command, print_json, print_table, progress, running_user_code, say
from .completion import complete_key
from .shared_options import CHANGES, CLUSTER, JOBS, JSON, SECONDS, cluster_given
from .watch import note_inputs

if TYPE_CHECKING:
    from ..reports.sweep.sweep import Sweep

FIGURES = ("worst", "limit", "margin", "at_s", "count", "verdict")
MAX_LISTED = 10  # maximum number of runs that do not pass and are listed one by one


@command(
    "run",
    "periph-sim sweep timing/imu_hil.toml --vary 'seed=1, 2, 3' --seconds 0.1",
    "periph-sim sweep case.toml --vary 'controller.first=1 ms, 2 ms' --csv a.csv",
)
@click.argument("case", type=click.Path(path_type=Path))
@click.option(
    "--vary",
    multiple=True,
    required=True,
    metavar="KEY=VALUES",
    shell_complete=complete_key,
    help="Values of a key: '1, 2, 5' or '0 ms to 20 ms step 10 us'. With several keys, every combination.",
)
@CHANGES
@SECONDS
@JOBS
@CLUSTER
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="Write a line for each run to this file.")
@JSON
def sweep(
    case: Path,
    vary: tuple[str, ...],
    changes: tuple[str, ...],
    length: Fraction | None,
    jobs: int | None,
    cluster: str | None,
    csv_file: Path | None,
    as_json: bool,
) -> int:
    """Run CASE once for each combination of values, and show for each budget the run nearest to its limit.

    Exit status 0: every run passes; 1: otherwise; 2: a run could not be made (the others were), or
    Ctrl-C, SIGTERM or the loss of the cluster stopped the sweep (the finished runs are shown).
    """
    from ...traces.formats import atomic_write
    from ..reports.sweep.sweep import SweepStopped
    from ..reports.sweep.sweep import sweep as swept

    with running_user_code(), ExitStack() as outputs:
        workers = cluster_given(cluster, jobs)
        varied = _varied(vary)
        fixed = {key.strip(): [value.strip()] for key, value in (_parts("--set", change) for change in changes)}
        for key in fixed.keys() & varied.keys():
            raise click.ClickException(f"--set and --vary both name {key}; remove one of them")
        note_inputs([case], [f"{key}={value}" for key, values in (fixed | varied).items() for value in values])
        unfinished = None if csv_file is None else outputs.enter_context(atomic_write(csv_file))
        stopped = ""
        with workers as executor, progress(case.stem) as on_progress:
            try:
                came = swept(
                    case, fixed | varied, seconds=length, jobs=jobs, executor=executor, on_progress=on_progress
                )
            except SweepStopped as error:
                came, stopped = error.finished, str(error)
            except BadCase as error:
                raise click.ClickException(_as_varied(str(error), varied)) from None
        if unfinished is not None:
            _write_csv(came, unfinished)
    if as_json:
        print_json("sweep", _object(came, stopped))
    else:
        _show(came, list(varied), stopped)
    if stopped:
        click.echo(f"Error: {stopped}", err=True)
        return 2
    verdicts = set(came.verdict.tolist())
    return 2 if "error" in verdicts else int(verdicts != {"pass"})


def _parts(option: str, change: str) -> tuple[str, str]:
    key, equals, value = change.partition("=")
    if not equals or not key.strip() or not value.strip():
        raise click.ClickException(f"{option} {change!r}: expected KEY=VALUE, for instance controller.period=10 ms")
    return key.strip(), value


def _varied(vary: tuple[str, ...]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for text in vary:
        key, values = _parts("--vary", text)
        if key in found:
            raise click.ClickException(f"--vary {key} is given twice; give all its values at once")
        found[key] = values_of(key, values)
    return found


def _as_varied(sentence: str, varied: Mapping[str, list[str]]) -> str:
    """Return an error message with --vary in place of --set, because the user gave the option --vary.

    If a value looks like a range without a step, the message explains how to write a range.

    varied: a dictionary from the keys of --vary to their values.
    """
    for key, values in varied.items():
        if f"--set '{key}=" in sentence:
            sentence = sentence.replace(f"--set '{key}=", f"--vary '{key}=")
            if len(values) == 1 and " to " in values[0]:
                sentence += "; a range needs a step: 'FIRST to LAST step STEP'"
    return sentence


def _write_csv(came: Sweep, file: Path) -> None:
    """Write a CSV file with a line for each run. Missing values are empty."""
    columns = came.columns()
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["run", *columns])
        for row, values in enumerate(zip(*(column.tolist() for column in columns.values()), strict=True)):
            writer.writerow([row, *("" if value != value else value for value in values)])


def _object(came: Sweep, stopped: str) -> dict[str, object]:
    """Return the answer for JSON, with an object for each run. The figures in this object are as in `run --json`.

    stopped: the reason why runs are missing; "" if all runs were made.
    """
    return {
        "case": came.case,
        "runs": [
            {
                "set": {key: str(column[row]) for key, column in came.changes.items()},
                "verdict": str(came.verdict[row]),
                "error": str(came.error[row]),
                "budgets": {
                    name: {figure: _plain(getattr(budget, figure)[row]) for figure in FIGURES}
                    for name, budget in came.budgets.items()
                    if budget.verdict[row]
                },
            }
            for row in range(len(came))
        ],
        "stopped": stopped,
        "units": {name: budget.unit for name, budget in came.budgets.items()},
    }


def _plain(value: Any) -> object:
    plain = value.item()
    return None if plain != plain else plain


def _show(came: Sweep, varied: list[str], stopped: str) -> None:
    verdicts = came.verdict.tolist()
    counts = ", ".join(f"{verdicts.count(word)} {word}" for word in dict.fromkeys(sorted(verdicts, reverse=True)))
    say("; ".join(filter(None, (f"{came.case}: {len(came)} runs", counts, stopped))), style="bold")
    rows, shown = _rows(came)
    if shown:
        titles = ("budget", "nearest", "limit", "run", "broken", "not\njudged")
        print_table(titles, rows, right=range(1, 6), whole=range(1, 6))
        say("nearest: in the run with the least margin, whose number is in `run`")
    failed = [row for row, verdict in enumerate(verdicts) if verdict != "pass"]
    listed = {*shown, *failed[:MAX_LISTED]}
    for row in sorted(listed):
        say(f"run {row}: {', '.join(f'{key}={came.changes[key][row]}' for key in varied)}{_why(came, row)}")
    more = len(set(failed) - listed)
    if more:
        say(f"{more} more do not pass; --csv or --json has all")


def _why(came: Sweep, row: int) -> str:
    """Return the reason why a run does not pass, as the end of a sentence; "" if it passes."""
    error = str(came.error[row])
    if came.verdict[row] == "error":
        return f": error: {error}"
    words = {name: str(budget.verdict[row]) for name, budget in came.budgets.items()}
    return f": {error}" * bool(error) + "".join(
        f"; {name} {word}" for name, word in words.items() if word in ("broken", "not judged")
    )


def _rows(came: Sweep) -> tuple[list[tuple[tuple[str, ...], str]], list[int]]:
    """Return the cells and the style of each budget's row, and the numbers of the runs that these rows name."""
    import numpy as np

    rows: list[tuple[tuple[str, ...], str]] = []
    shown: dict[int, None] = {}
    for name, budget in came.budgets.items():
        words = budget.verdict.tolist()
        numbers = (str(words.count("broken")), str(words.count("not judged")))
        style = "red" if "broken" in words else ""
        if np.isnan(budget.margin).all():
            rows.append(((name, "-", "-", "-", *numbers), style))
            continue
        row = int(np.nanargmin(budget.margin))
        shown[row] = None
        worst, most = (_of_unit(column[row], budget.unit) for column in (budget.worst, budget.limit))
        cells = (figure(worst, budget.unit), limit(most, budget.unit, ""), str(row))
        rows.append(((name, *cells, *numbers), style))
    return rows, list(shown)


def _of_unit(value: Any, unit: str) -> float | int:
    """Return a figure as a float if its unit is us, % or LSB, and as an integer if it has another unit."""
    return float(value) if unit in ("us", "%", "LSB") else int(value)
