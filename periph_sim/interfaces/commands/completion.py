"""Completion of values in a shell: budgets and keys of the case on the command line, registers, fields and rows.

Values are found without running user code. A file that cannot be read, or that is no case, offers no values.

    "I2C-A.I2" --next_parts--> I2C-A.I2COAR, I2C-A.I2CIER, ...: dotted names are completed part by part
"""

from __future__ import annotations

import os
import shlex
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar

import click
from click.shell_completion import BashComplete, CompletionItem, add_completion_class

Schema = dict[str, Any]
Complete = Callable[[click.Context, click.Parameter, str], list[str]]

WIRES = ("SCL", "SDA", "RX", "TX")
MISSING = 2  # levels of keys that are offered below a table of the case although the case does not have these keys
BASH = r"""%(complete_func)s() {
    local completion kind value response
    response=$(env COMP_WORDS="$(printf '%%s\n' "${COMP_WORDS[@]}")" COMP_CWORD="$COMP_CWORD" \
        %(complete_var)s=bash_complete "$1")
    while IFS= read -r completion; do
        kind="${completion%%%%,*}"
        value="${completion#*,}"
        case "$kind" in
            dir) COMPREPLY=(); compopt -o dirnames ;;
            file) COMPREPLY=(); compopt -o default ;;
            plain)
                COMPREPLY+=("$value")
                case "$value" in *[.=@]) compopt -o nospace ;; esac ;;
        esac
    done <<< "$response"
}
complete -o nosort -F %(complete_func)s %(prog_name)s
"""


class QuotingBash(BashComplete):
    """Completion in bash that quotes values with blanks, and adds no blank after a part of a value."""

    source_template: ClassVar[str] = BASH

    def format_completion(self, item: CompletionItem[Any]) -> str:
        words = os.environ.get("COMP_WORDS", "").split("\n")
        number = int(os.environ.get("COMP_CWORD", "0"))
        is_quoted = number < len(words) and words[number][:1] in ("'", '"')
        return f"{item.type},{item.value if is_quoted else shlex.quote(item.value)}"


def register_shells() -> None:
    """Make click use the classes of this module."""
    add_completion_class(QuotingBash)


def silently(offer: Complete) -> Complete:
    """Return a function that offers the values of `offer` and prints nothing. It offers no values if `offer` raises."""

    def offered(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
        with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere), redirect_stderr(nowhere):
            try:
                return offer(context, parameter, begun)
            except Exception:
                return []

    return offered


def next_parts(names: Iterable[str], begun: str) -> list[str]:
    """Return the names that begin with `begun`, each cut after the first dotted part in which they differ.

    The case of letters does not matter. Names that are equal after the cut are returned once.
    """
    found = [name for name in names if name.lower().startswith(begun.lower())]
    length = len(begun)
    while True:
        heads = list(dict.fromkeys(name[: name.find(".", length) + 1 or len(name)] for name in found))
        if len(heads) != 1 or not heads[0].endswith("."):
            return heads
        length = len(heads[0])


@silently
def complete_budget(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer the names of the case's budgets, without those that are already on the command line."""
    given = context.params.get(parameter.name or "") or ()
    return [name for name in _budgets(_tree(context)) if name.startswith(begun) and name not in given]


@silently
def complete_key(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer keys that --set can change in the case, each followed by "=" (see `_case_schema` and `_keys`)."""
    schema, definitions = _case_schema()
    return next_parts((f"{key}=" for key in _keys(_tree(context), schema, definitions)), begun)


@silently
def complete_register(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer the names of modules, and of registers with and without the name of their module."""
    from ...f28335.parts.f28335 import PART

    known = [(module.name, register.name) for module in PART.modules for register in module.registers]
    modules, registers = (dict.fromkeys(names) for names in zip(*known, strict=True))
    return next_parts([*modules, *map(".".join, known), *registers], begun)


@silently
def complete_field(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer the names of registers and fields, each with the name of its module."""
    return next_parts(_fields(), begun)


@silently
def complete_question(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer wires, registers and fields, each followed by "@"."""
    return next_parts((f"{name}@" for name in (*WIRES, *_fields())), begun)


@silently
def complete_optimization(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer the optimizations that can be switched off, and "all"."""
    from ...scene.case.optimizations import ALL, OPTIMIZATIONS

    return [name for name in (*OPTIMIZATIONS, ALL) if name.startswith(begun)]


@silently
def complete_row(context: click.Context, parameter: click.Parameter, begun: str) -> list[str]:
    """Offer the names that rows in the table of `trade` can have, except rows that are made from other cases."""
    from ..reports.trade.rows import ARITHMETICS, AS_GIVEN, RECORDINGS, TABLE

    names = [AS_GIVEN, *(f"arithmetic={name}" for name in ARITHMETICS), *(f"record {name}" for name in RECORDINGS)]
    names.append(TABLE)
    return [name for name in names if name.startswith(begun)]


def _fields() -> Iterator[str]:
    """Yield each register with its module, and then each of its fields."""
    from ...f28335.parts.f28335 import PART

    for module in PART.modules:
        for register in module.registers:
            yield f"{module.name}.{register.name}"
            yield from (f"{module.name}.{register.name}.{field.name}" for field in register.fields)


def _tree(context: click.Context) -> dict[str, Any]:
    """Return the content of the case file on the command line, parsed from TOML.

    Raise StopIteration if the line names no case, and OSError or ValueError if the case cannot be read.
    """
    named = [context.params.get(name) for name in ("case", "case_file")]
    # `args` are the arguments on the command line that click has not yet assigned to parameters.
    given = [*named, *(context.params.get("paths") or ()), *context.args]
    path = next(Path(one) for one in given if one is not None and str(one).endswith(".toml"))
    return tomllib.loads(path.read_text(encoding="utf-8-sig"))


def _budgets(tree: dict[str, Any]) -> Iterator[str]:
    """Yield the names of a case's budgets: in [[budget]], [[serial.send]] with `expect`, [[serial.expect]], [watch]."""
    serial = tree.get("serial", {})
    named = [*tree.get("budget", ()), *(one for one in serial.get("send", ()) if "expect" in one)]
    yield from dict.fromkeys(one["name"] for one in [*named, *serial.get("expect", ())] if "name" in one)
    yield from tree.get("watch", {})


def _case_schema() -> tuple[Schema, Schema]:
    """Return the schema of a case and its definitions, without the keys that plugins and kinds of faults add."""
    from ...f28335.parts.f28335 import PART
    from ...scene.case.json_schema import schema_of_table
    from ...scene.case.model import Case

    definitions: Schema = {}
    schema = schema_of_table(Case, definitions)
    options: Schema = {
        name: {"properties": {field.name: {} for field in fields(kind)}}  # type: ignore[arg-type]
        for name, kind in PART.options_classes().items()
    }
    definitions["Unit"]["properties"]["options"] = {"properties": options}
    return schema, definitions


def _keys(value: object, schema: Schema, definitions: Schema, missing: int = 0) -> Iterator[str]:
    """Yield keys that a table has or can have. Keys of inner tables have a path, such as controller.period.

    Obsolete keys that the file does not have are left out.

    value: the table, or a list of tables.
    schema: the schema of the table. definitions: the schemas that it refers to.
    missing: the number of levels of inner tables whose keys are included although the file does not have them.
    """
    table = _entries(value) if isinstance(value, list) else value
    assert isinstance(table, dict)
    known = schema.get("properties", {})
    for name in dict.fromkeys([*table, *known]):
        if set(".=") & set(name):
            continue  # --set cannot name a key that contains "." or "="
        inner = _resolved(known.get(name) or schema.get("items") or schema.get("additionalProperties"), definitions)
        one = table.get(name)
        is_table = isinstance(one, dict) or (isinstance(one, list) and bool(_entries(one)))
        if is_table or (one is None and missing and "properties" in inner):
            deeper = _keys(one or {}, inner, definitions, MISSING if is_table else missing - 1)
            yield from (f"{name}.{key}" for key in deeper)
        elif one is not None or (inner.get("type") != "object" and not _is_obsolete(known[name])):
            yield name


def _is_obsolete(schema: Schema) -> bool:
    return str(schema.get("description", "")).startswith("obsolete")


def _entries(tables: list[Any]) -> dict[str, Any]:
    """Return a dictionary from names to the tables in a list. A table without a name has its index, from 0, as name."""
    return {str(one.get("name", n)): one for n, one in enumerate(tables) if isinstance(one, dict)}


def _resolved(schema: object, definitions: Schema) -> Schema:
    """Return the schema that `schema` refers to, or `schema` itself if it is no reference; {} if any value is valid."""
    found: Schema = schema if isinstance(schema, dict) else {}
    for inner in (found, *found.get("allOf", ())):
        if "$ref" in inner:
            found = definitions[inner["$ref"].rpartition("/")[2]]
    return found
