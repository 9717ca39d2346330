"""`periph-sim schema`: the JSON schema of case files, with which editors complete and check such files."""

from __future__ import annotations

import json

import click

from ...core.output_encoding import writes_utf8
from .command_frame import command


@command("run", "periph-sim schema > periph-sim.schema.json", "periph-sim schema | grep -A5 'stall_limit'")
def schema() -> None:
    """Print the JSON schema of case files, for editors.

    A case whose first line is `#:schema ./periph-sim.schema.json` is completed and checked
    while it is typed, by Even Better TOML in VS Code and by taplo everywhere else.
    """
    from ...scene.case.json_schema import case_schema

    click.echo(json.dumps(case_schema(), indent=2, ensure_ascii=not writes_utf8()))
