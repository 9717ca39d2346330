"""`periph-sim run CASE`: run a case, print its budgets, set the exit status."""

from __future__ import annotations

import dataclasses
import json
from fractions import Fraction
from pathlib import Path

import click
from rich.console import Console

from ..board.result import Result
from ..board.scene import Scene
from ..case.load import load
from ..case.model import Case
from ..case.settings import duration
from ..recording import recording
from .progress import progress
from .report import show
from .trouble import told_plainly


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--seconds", type=str, help="Simulate this long instead of the case's duration; 10 or '10 s'.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
@click.option("--record", type=click.Path(path_type=Path), help="Write the run to a file; its suffix says the format.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def run(case: Path, seconds: str | None, changes: tuple[str, ...], record: Path | None, as_json: bool) -> int:
    """Run CASE and say whether its budgets hold (exit status 0) or not (1)."""
    with told_plainly():
        loaded = load(case, list(changes))
        length = None if seconds is None else _length(seconds)
        with recording(record, recorded_modules(loaded)) as (subscribe, ended_at):
            scene = Scene(loaded, subscribe)
            with progress(loaded.name) as told:
                result = scene.run(length, told)
            ended_at(scene.kernel.now)
    if as_json:
        click.echo(json.dumps(dataclasses.asdict(result)))
    else:
        show(Console(), result)
    return status(result)


def recorded_modules(case: Case) -> dict[str, tuple[str, ...]]:
    """What a recording lists for each unit: its modules and its named pins."""
    return {name: (*unit.modules, *(f"pin:{pin}" for pin in unit.pins)) for name, unit in case.unit.items()}


def status(result: Result) -> int:
    return 0 if result.verdict == "pass" else 1


def _length(text: str) -> Fraction:
    try:
        return duration(text if text.strip()[-1:].isalpha() else f"{text} s")
    except ValueError as error:
        raise click.ClickException(f"--seconds: {error}") from None
