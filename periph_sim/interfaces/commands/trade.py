"""`periph-sim trade CASE`: the CPU time and the error of each choice between speed and accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .command_frame import command, print_answer, progress, running_user_code, time_given
from .completion import complete_row
from .shared_options import CHANGES, SECONDS

if TYPE_CHECKING:
    from ...scene.case.model import Case


@command(
    "understand",
    "periph-sim trade timing/imu_hil.toml --seconds 1",
    "periph-sim trade case.toml --row 'record .vcd' --max-error '1 us'",
)
@click.argument("case", type=click.Path(path_type=Path))
@SECONDS
@CHANGES
@click.option(
    "--firmware",
    "others",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="CASE",
    help="Add the units of CASE.",
)
@click.option(
    "--row",
    "--level",
    "names",
    multiple=True,
    metavar="ROW",
    shell_complete=complete_row,
    help="Run only these rows, the reference and the case.",
)
@click.option("--max-error", metavar="TIME", help="Recommend a row within this error of times, such as '1 us'.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
def trade(
    case: Path,
    length: Fraction | None,
    changes: tuple[str, ...],
    others: tuple[Path, ...],
    names: tuple[str, ...],
    max_error: str | None,
    as_json: bool,
) -> int:
    """Run CASE with each available choice between speed and accuracy, and compare errors and CPU time.

    Each choice is a row: the units of another case (--firmware), for example with an image or C sources; another
    arithmetic of the sensor models; or a recording. Each row is compared with the most accurate row: the number of
    budgets with the same verdict, and the largest differences of times and of samples in the chips' answers. The n-th
    value of a row is compared with the n-th value of the most accurate row. This row and the case as given are always
    run. The row `table` has the closed table of the case, if it has one: values of budgets for many seeds, without
    runs (docs/proof.md).
    """
    from ...scene.case.load import load
    from ..reports import REFUSED
    from ..reports.trade import trade as report
    from ..reports.trade.rows import HAS_TABLE, chosen, rows_of
    from ..reports.trade.table_row import tabulated

    with running_user_code():
        bound = inf if max_error is None else float(time_given("--max-error", max_error))
        loaded = load(case, list(changes))
        length = loaded.duration if length is None else length

        def make(more: Sequence[str]) -> Case:
            return load(case, [*changes, *more])

        rows = chosen(rows_of(make, [load(other) for other in others]), names)
        table = None
        with progress(loaded.name) as on_progress:
            found = report.trade(make, [row for row in rows if row != HAS_TABLE], length, bound, on_progress)
            if HAS_TABLE in rows:
                try:
                    table = tabulated(case, changes, loaded, on_progress)
                except REFUSED as error:
                    found.refused[HAS_TABLE.name] = str(error)
    print_answer("trade", report.as_json(found, table) if as_json else "\n".join(report.text(found, table)))
    return 0
