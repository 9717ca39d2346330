"""The numbered rules of the manuals, read from the .toml files in this folder."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent
LISTS = ("i2c", "sci", "spi", "system")


class Rule(NamedTuple):
    """One rule.

    text: the rule in our own words.
    source: its place in the manual; the table `sources` of its list explains the abbreviations.
    """

    text: str
    source: str


@cache
def texts() -> dict[str, Rule]:
    """Return all rules by number, in the order of the lists."""
    found = {}
    for name in LISTS:
        tree = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
        found |= {number: Rule(*entry) for number, entry in tree["rules"].items()}
    return found
