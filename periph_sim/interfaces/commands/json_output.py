"""Output of `--json`: one JSON object with its schema and version."""

from __future__ import annotations

import json
from collections.abc import Mapping

import click

from ... import form

VERSION = 2  # incremented when a key is removed or changes its meaning, not for a new key


def print_json(command: str, answer: Mapping[str, object]) -> None:
    """Print one object on standard output; `schema` names the command, `schema_version` the edition.

    `form` comes last: the form of the core that was used."""
    answer_object = {"schema": f"periph-sim {command}", "schema_version": VERSION, **answer, "form": form.running}
    click.echo(json.dumps(answer_object, indent=2, ensure_ascii=False))
