"""The optimizations of a run, which the key `disable` of a case can switch off, and the obsolete key `fidelity`.

An optimization saves time and changes nothing else: records and verdicts are equal without it. Only figures about the
work of the simulator differ, such as the number of skipped polls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, TypeAlias

from ... import removed
from ...core.convert import Before
from ...core.phrases import did_you_mean

ALL = "all"
BITS = "bits"
POLLS = "polls"
DECODING = "decoding"
OPTIMIZATIONS = {
    BITS: "the first seven bits of an I2C byte pass in one step where only the lines change (`bus.i2c.bit_skip`)",
    POLLS: "passes of a wait that change nothing are not run (`processor.polling`, `processor.image.polls`)",
    DECODING: "an instruction of an image is decoded once, not each time that it is executed (`c28x.execution.engine`)",
}
OBSOLETE_LEVELS = ("edge", "adaptive", "byte", "auto")


def _checked_names(value: object) -> object:
    for name in value if isinstance(value, list | tuple) else [value]:
        if name not in (ALL, *OPTIMIZATIONS):
            raise ValueError(f"there is no optimization {name!r}; {did_you_mean(str(name), [ALL, *OPTIMIZATIONS])}")
    return [value] if isinstance(value, str) else value


def _checked_level(value: object) -> object:
    """Return the value of the obsolete key `fidelity` as a text. Raise ValueError for an unknown level."""
    levels = [*_levels(value)] if isinstance(value, dict) else [value]
    for level in levels:
        if isinstance(level, str) and level in removed.LEVELS:
            raise ValueError(removed.LEVELS[level])
        if level not in OBSOLETE_LEVELS:
            raise ValueError(f"it is obsolete, and {level!r} never was a level of it; leave it out: every run is exact")
    return ", ".join(dict.fromkeys(str(level) for level in levels))


def _levels(table: Mapping[str, object]) -> Sequence[object]:
    found: list[object] = []
    for level in table.values():
        found += _levels(level) if isinstance(level, dict) else [level]
    return found


Disabled: TypeAlias = Annotated[tuple[str, ...], Before(_checked_names)]
Fidelity: TypeAlias = Annotated[str, Before(_checked_level)]


def obsolete_fidelity(level: str) -> str:
    """Return a note for a case with the key `fidelity`: the key is obsolete."""
    return f'fidelity = "{level}" is obsolete and has no effect: every run is exact; leave it out'
