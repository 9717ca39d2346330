"""`periph-sim why RUN QUESTION`: why a field, wire, span or interrupt stood as it did at an instant."""

from __future__ import annotations

import json
from pathlib import Path

import click

from .inputs import RUN_FILE, SYSCLK, open_run
from .trouble import told_plainly


@click.command()
@RUN_FILE
@click.argument("question")
@click.option("--depth", type=click.IntRange(0, 1000), default=8, show_default=True, help="Causes walked back.")
@SYSCLK
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def why(run: Path, question: str, depth: int, sysclk: str | None, as_json: bool) -> None:
    """Say why 'I2C-A.I2CSTR.XRDY@12.345ms' was as it was in RUN.

    RUN is what `run --record x.psr` wrote. A question is a field, wire, span or interrupt, and a time: 'SDA@3 us'.
    """
    from ..insight.show_why import as_json as as_dict
    from ..insight.show_why import text
    from ..insight.why import why as answer_to

    with told_plainly():
        answer = answer_to(open_run(run, sysclk), question, depth)
    click.echo(json.dumps(as_dict(answer)) if as_json else text(answer))
