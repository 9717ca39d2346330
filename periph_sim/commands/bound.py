"""`periph-sim bound CASE`: the calculated worst case of request and response, beside the largest value seen."""

from __future__ import annotations

from pathlib import Path

import click

from .input_options import time_given
from .json_output import print_json
from .progress import progress
from .usage_error import running_user_code

SECTION = "understand"
EXAMPLE = "periph-sim bound timing/imu_hil.toml --seconds 1"


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--seconds", type=str, help="Simulate this long instead of the case's duration; 10 or '10 s'.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def bound(case: Path, seconds: str | None, changes: tuple[str, ...], as_json: bool) -> int:
    """Calculate the worst case of CASE in closed form, term by term, beside the worst value of a run.

    It assumes rates as received, no frame left out, no other interrupt and no dependence on data; nothing is proven.
    Calculated are response, stretch, margin, reaction, round, slack, age, spans, service latency, own address and the
    receive FIFO. Exit status 0: no value of the run is beyond the calculated one, and none of these beyond a limit of
    the case; 1: one is, or one could not be calculated or compared; 2: the case has no closed form.
    """
    from ..explain.bound import report
    from ..explain.bound.text_report import as_json as as_dict
    from ..explain.bound.text_report import text
    from ..scene.case.load import load

    length = None if seconds is None else time_given("--seconds", seconds if seconds[-1:].isalpha() else f"{seconds} s")
    with running_user_code():
        loaded = load(case, list(changes))
        with progress(loaded.name) as told:
            found = report(loaded, length, told)
    if as_json:
        print_json("bound", as_dict(found))
    else:
        click.echo(text(found))
    return 0 if found.passed else 1
