"""`periph-sim why RUN QUESTION`: why a field, wire, span, interrupt or variable had its state at a given time."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command, open_run, print_answer
from .completion import complete_question
from .shared_options import RUN_FILE, SYSCLK


@command(
    "understand",
    "periph-sim why run.psr 'I2C-A.I2CSTR.XRDY@12.345 ms'",
    "periph-sim why run.psr 'SDA@12.345 ms' --depth 20",
)
@RUN_FILE
@click.argument("question", shell_complete=complete_question)
@click.option(
    "--depth", type=click.IntRange(0, 1000), default=8, show_default=True, help="Number of causes to trace back."
)
@SYSCLK
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def why(run: Path, question: str, depth: int, sysclk: str | None, as_json: bool) -> None:
    """Explain why 'I2C-A.I2CSTR.XRDY@12.345ms' had its value in RUN.

    RUN is the output of `run --record x.psr`. A question consists of a field, wire, span, interrupt or variable, and of
    a time: 'SDA@3 us'. Variables of an image are recorded if a budget names them.
    """
    from ...records.cause_trace import why as answers

    answer = answers.why(open_run(run, sysclk), question, depth)
    print_answer("why", answers.as_json(answer) if as_json else answers.text(answer))
