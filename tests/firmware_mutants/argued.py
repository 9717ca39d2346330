"""Mutants without effect on this chip, argued: a mutant goes in; the argument comes out, or nothing."""

from __future__ import annotations

from typing import NamedTuple

from .changes import Mutant


class Argument(NamedTuple):
    """why: nothing can tell. mutants: their texts; "N cycles late" stands for either delay.

    rules: of the manuals, by their numbers. lint: that says the same of the unchanged statement.
    """

    why: str
    mutants: tuple[str, ...]
    rules: tuple[str, ...] = ()
    lint: str = ""


ARGUMENTS: tuple[Argument, ...] = ()


def argument_of(mutant: Mutant) -> Argument | None:
    """None for a mutant that some budget should catch."""
    return next((one for one in ARGUMENTS if any(_means(text, mutant) for text in one.mutants)), None)


def _means(text: str, mutant: Mutant) -> bool:
    return mutant.text in (text, *(text.replace("N cycles", f"{cycles} cycles") for cycles in (20, 300)))
