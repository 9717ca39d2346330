"""`periph-sim races RUN`: the times between reads and changes of flags, and flags lost to read-modify-writes."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command, open_run, print_answer
from .completion import complete_field
from .shared_options import JSON, RUN_FILE, SYSCLK


@command(
    "understand", "periph-sim races run.psr --register I2C-A.I2CSTR", "periph-sim races run.psr --least 10 --no-lost"
)
@RUN_FILE
@click.option(
    "--register",
    metavar="NAME",
    shell_complete=complete_field,
    help="One register, or one field of it: I2C-A.I2CSTR, I2C-A.I2CSTR.RRDY.",
)
@click.option("--least", type=click.IntRange(0), metavar="CYCLES", help="Exit status 1 if a read was nearer.")
@click.option("--no-lost", is_flag=True, help="Exit status 1 if a flag was lost to a read-modify-write.")
@SYSCLK
@JSON
def races(run: Path, register: str | None, least: int | None, no_lost: bool, sysclk: str | None, as_json: bool) -> int:
    """Show how near reads of status registers in RUN were to changes of their flags.

    RUN is the output of `run --record x.psr`. Flags that a read-modify-write cleared unintentionally are listed too.
    """
    from ...records import races_text_report as report
    from ...records.races import races as races_of

    found = races_of(open_run(run, sysclk), register)
    print_answer("races", report.as_json(found) if as_json else report.text(found))
    too_near = least is not None and found.closest is not None and found.closest < least
    return int(too_near or (no_lost and found.lost > 0))
