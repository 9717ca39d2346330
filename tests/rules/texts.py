"""The numbered rules of the manuals: number -> text, read from the lists beside this file."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent
LISTS = ("i2c", "sci", "spi", "system")


class Rule(NamedTuple):
    """text: the rule in a sentence of ours. source: where the manual has it; `sources` of the list says which one."""

    text: str
    source: str


@cache
def texts() -> dict[str, Rule]:
    """Every rule, in the order of the lists."""
    found = {}
    for name in LISTS:
        tree = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
        found |= {number: Rule(*entry) for number, entry in tree["rules"].items()}
    return found
