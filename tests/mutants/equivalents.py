"""Mutants that change nothing anybody could see, argued one by one: a mutant goes in, the argument comes out.

An entry of equivalents.toml names the file, the line before and after the change, and why no test can tell. It is
found by these texts and not by its number, so that it outlives edits elsewhere in the file.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

from .sample import Mutant

LIST = Path(__file__).with_name("equivalents.toml")


@cache
def arguments() -> dict[tuple[str, str, str], str]:
    """(file, line before, line after) -> why."""
    entries = tomllib.loads(LIST.read_text(encoding="utf-8")).get("equivalent", [])
    return {(one["file"], one["before"], one["after"]): one["why"] for one in entries}


def why_equivalent(mutant: Mutant) -> str | None:
    """The argument; None for a mutant that some test should kill."""
    return arguments().get((mutant.path, mutant.before, mutant.after))
