"""The page docs/commands.md, written from the commands of `periph-sim` and their options."""

from __future__ import annotations

from collections.abc import Iterator

import click

from periph_sim.cli import SECTIONS, _about, _file, cli
from tests.docs.pages import ROOT

PAGE = ROOT / "docs" / "commands.md"
HEAD = """# Commands

This page is generated from the sources. `periph-sim COMMAND --help` says more about each command. With
`eval "$(_PERIPH_SIM_COMPLETE=bash_source periph-sim)"` in `~/.bashrc` (zsh: `zsh_source`), the tab key completes
commands, options, budgets, keys, registers and fields.
"""


def page() -> str:
    """Return the text of docs/commands.md."""
    return "\n".join([HEAD, *_sections()])


def _sections() -> Iterator[str]:
    context = click.Context(cli, info_name="periph-sim")
    for section, title in SECTIONS.items():
        yield f"## {title}\n"
        for name in cli.list_commands(context):
            of, summary = _about(_file(name))
            if of == section:
                command = cli.get_command(context, name)
                assert command is not None
                yield _command(click.Context(command, context, name), summary)


def _command(context: click.Context, summary: str) -> str:
    usage = " ".join(context.command.collect_usage_pieces(context)).replace("[OPTIONS] ", "").replace("[OPTIONS]", "")
    lines = [f"### {context.info_name}\n", f"`{context.command_path} {usage}`".replace(" `", "`"), "", f"{summary}\n"]
    rows = [one.get_help_record(context) for one in context.command.params if isinstance(one, click.Option)]
    shown = [row for row in rows if row is not None]
    if shown:
        lines += ["| option | meaning |", "|---|---|"]
        lines += [f"| {_code(names)} | {_cell(what)} |" for names, what in shown]
        lines.append("")
    return "\n".join(lines)


def _code(names: str) -> str:
    return f"`{names}`".replace("|", "\\|")


def _cell(text: str) -> str:
    """Return the text of an option as a cell: on one line, with the characters of tables, tags and links escaped."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;").replace("[", "\\[")
