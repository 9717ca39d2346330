"""Options that several commands have, each with the same meaning in all of them."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import length_given, usage_errors_in_one_sentence
from .completion import complete_key

RATE = click.option("--rate", metavar="RATE", help="Sample rate, if the file has none: '4 MHz'.")
SALVAGE = click.option(
    "--salvage", is_flag=True, help="Read a damaged file up to the damage, and say what was dropped."
)
GUARANTEED = click.option(
    "--guaranteed/--no-guaranteed",
    default=None,
    expose_value=False,
    callback=lambda context, option, asked: _refuse_guaranteed(asked),
    help="Require proven budgets; an error, since nothing is proven yet.",
)
CHANGES = click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    shell_complete=complete_key,
    help="Change one key of the case.",
)
SECONDS = click.option(
    "--seconds",
    "length",
    type=str,
    callback=lambda context, option, text: None if text is None else length_given(text),
    help="Simulate this long instead of the case's duration; 10 or '10 s'.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
RUN_FILE = click.argument("run", type=click.Path(path_type=Path))
SYSCLK = click.option("--sysclk", metavar="RATE", help="SYSCLKOUT, if RUN does not contain it: '150 MHz'.")


def _refuse_guaranteed(asked: bool | None) -> None:
    """Raise ClickException if --guaranteed is given, or if the project's settings contain `guaranteed = true`.

    asked: True for --guaranteed, False for --no-guaranteed, None if neither option is given.
    """
    from ...scene.project import project_of
    from ...timing.verdict import NOTHING_PROVEN

    if asked:
        raise click.ClickException(f"--guaranteed: {NOTHING_PROVEN}; remove the option")
    with usage_errors_in_one_sentence():
        project = project_of(Path())
    if asked is None and project.settings.guaranteed:
        raise click.ClickException(f"{project.where('guaranteed')}: {NOTHING_PROVEN}; remove it or use --no-guaranteed")
