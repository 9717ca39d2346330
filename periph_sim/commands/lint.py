"""`periph-sim lint RUN`: faults in what firmware does with its registers."""

from __future__ import annotations

import json
from pathlib import Path

import click

from .inputs import RUN_FILE, SYSCLK, open_run, time_given
from .trouble import told_plainly


@click.command()
@RUN_FILE
@click.option("--bound", metavar="TIME", default="20 ms", show_default=True, help="A wait may take so long.")
@SYSCLK
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def lint(run: Path, bound: str, sysclk: str | None, as_json: bool) -> int:
    """Find faults in what the firmware did in RUN, each with its place and the section that says why.

    RUN is what `run --record x.psr` wrote. Exit status 0: nothing found; 1: something is.
    """
    from ..insight.finding import Options
    from ..insight.lint import lint as lint_of
    from ..insight.show_lint import as_json as as_dict
    from ..insight.show_lint import text

    options = Options(time_given("--bound", bound))
    with told_plainly():
        opened = open_run(run, sysclk)
        findings = lint_of(opened, options)
    click.echo(json.dumps(as_dict(opened, findings)) if as_json else text(opened, findings))
    return 1 if findings else 0
