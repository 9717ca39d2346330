"""What `--json` prints: a command's answer goes in; one JSON object with its schema and version comes out."""

from __future__ import annotations

import json
from collections.abc import Mapping

import click

from .. import form

VERSION = 2  # goes up when a key goes away or means something else; a new key leaves it


def print_json(command: str, answer: Mapping[str, object]) -> None:
    """One object on standard output; `schema` says whose it is, `schema_version` which edition.

    `form` comes last: which form of the core was at work."""
    told = {"schema": f"periph-sim {command}", "schema_version": VERSION, **answer, "form": form.running}
    click.echo(json.dumps(told, indent=2, ensure_ascii=False))
