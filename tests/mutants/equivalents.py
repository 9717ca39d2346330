"""Equivalent mutants, which change nothing that a test can observe, each with an argument.

An entry of equivalents.toml names the file, the line before and after the change, and the reason why no test can
detect it. Entries are found by these texts and not by line numbers, so that edits elsewhere do not invalidate them.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

from .sample import Mutant

LIST = Path(__file__).with_name("equivalents.toml")


@cache
def arguments() -> dict[tuple[str, str, str], str]:
    """Return a dictionary from (file, line before, line after) to the argument."""
    entries = tomllib.loads(LIST.read_text(encoding="utf-8")).get("equivalent", [])
    return {(one["file"], one["before"], one["after"]): one["why"] for one in entries}


def why_equivalent(mutant: Mutant) -> str | None:
    """Return the argument, or None for a mutant that some test should kill."""
    return arguments().get((mutant.path, mutant.before, mutant.after))
