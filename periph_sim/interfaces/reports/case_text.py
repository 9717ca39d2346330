"""Case files that a command writes: tables as TOML, paths of files relative to the file's folder, usable budgets."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from os.path import relpath
from pathlib import Path
from typing import Any, TypeVarTuple

from ...scene.case.load import case_of
from ...scene.case.model import BadCase, Case
from ...scene.case.origin import texts_in
from ...scene.case.toml_file import copied
from ...scene.scene import Scene

Ts = TypeVarTuple("Ts")
Tree = dict[str, Any]


def move_files(tree: Tree, before: Path, after: Path) -> None:
    """Change the paths in a case that moves to another folder: those of files and of folders of C headers.

    before, after: the folders of the old and of the new case. The new paths are relative to `after`.
    """
    named = (text for text in texts_in(tree) if 0 < len(text) < 200 and (before / text).is_file())
    tree.update(copied(tree, {text: relpath(before / text, after) for text in named}))
    for unit in tree.get("unit", {}).values():
        compile = unit.get("compile", {}) if isinstance(unit, dict) else {}
        if "include" in compile:
            compile["include"] = [relpath(before / folder, after) for folder in compile["include"]]


def usable_budgets(tree: Tree, target: Path, budgets: Iterable[Tree]) -> list[Tree]:
    """Return the budgets with which the case can be built, each alone.

    For example, a case cannot have a budget of the latency of an interrupt that no PIE line requests.

    tree, target: the case without budgets, and the path of its file.
    """
    return [budget for budget in budgets if can_be_built(case_of, {**tree, "budget": [budget]}, target)]


def can_be_built(make: Callable[[*Ts], Case], *arguments: *Ts) -> bool:
    """Return True if a scene can be built from the case that `make` returns for these arguments."""
    try:
        Scene(make(*arguments)).close()
    except BadCase:
        return False
    return True


def toml(tree: Tree) -> str:
    """Format a tree of tables as TOML. In each table, plain values come first."""
    return "\n".join(_tables(tree, ())).strip() + "\n"


def _tables(tree: Tree, path: tuple[str, ...]) -> list[str]:
    lines = [f"{_key(key)} = {_value(value)}" for key, value in tree.items() if not _is_table(value)]
    for key, value in tree.items():
        inner = (*path, _key(key))
        name = ".".join(inner)
        if isinstance(value, dict):
            plain = any(not _is_table(each) for each in value.values()) or not value
            lines += [*(["", f"[{name}]"] if plain else []), *_tables(value, inner)]
        elif _is_table(value):
            for entry in value:
                lines += ["", f"[[{name}]]", *_tables(entry, inner)]
    return lines


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(entry, dict) for entry in value)
    )


def _key(key: str) -> str:
    return key if key.replace("_", "a").replace("-", "a").isalnum() and key.isascii() else _text(key)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_value(inner)}" for key, inner in value.items()) + " }"
    return str(value)
