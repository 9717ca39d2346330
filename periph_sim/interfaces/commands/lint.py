"""`periph-sim lint RUN`: find faults in firmware's use of its registers."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command, open_run, print_answer, time_given
from .shared_options import RUN_FILE, SYSCLK


@command("understand", "periph-sim lint run.psr", "periph-sim lint run.psr --bound '5 ms'")
@RUN_FILE
@click.option("--bound", metavar="TIME", default="20 ms", show_default=True, help="Maximum length of a wait.")
@SYSCLK
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def lint(run: Path, bound: str, sysclk: str | None, as_json: bool) -> int:
    """Find faults in the firmware's actions in RUN, each with its place and the manual's section.

    RUN is the output of `run --record x.psr`. Exit status 0: nothing found; 1: something found.
    """
    from ...records import lint as lints

    options = lints.Options(time_given("--bound", bound))
    opened = open_run(run, sysclk)
    findings = lints.lint(opened, options)
    print_answer("lint", lints.as_json(opened, findings) if as_json else lints.text(opened, findings))
    return 1 if findings else 0
