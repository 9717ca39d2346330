"""The values of each run of a sweep, as `key=value` texts.

{"seed": (1, 2), "host.jitter": ("0 us", "50 us")}  --> every combination, the last key changing first
[{"seed": 1}, {"seed": 2, "start": "1 ms"}]         --> unchanged
["seed=1", ["seed=2", "start=1 ms"]]                --> as for `--set`
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from typing import TypeAlias

from ....scene.case.model import BadCase

Value: TypeAlias = object  # a number, a truth value, a text as for `--set` after "=", a list or a table of those
Run: TypeAlias = Mapping[str, Value]
Changes: TypeAlias = Mapping[str, Iterable[Value]] | Iterable[Run | str | Sequence[str]]


def runs_of(changes: Changes) -> list[dict[str, Value]]:
    """Return the values of each run, by key. Raise BadCase if a change is invalid or there is no run."""
    if isinstance(changes, str):
        raise BadCase(f"changes={changes!r}: give a list of runs, or a table of keys and their values")
    if isinstance(changes, Mapping):
        runs = _combinations(changes)
    else:
        runs = [_one(run, number) for number, run in enumerate(changes)]
    if not runs:
        raise BadCase("changes: they contain no run; give each key at least one value")
    return runs


def texts_of(run: Run) -> list[str]:
    """Return a run's changes as for `--set`. Raise BadCase for a value that a case cannot have."""
    return [f"{key}={_text(key, value)}" for key, value in run.items()]


def _combinations(changes: Mapping[str, Iterable[Value]]) -> list[dict[str, Value]]:
    for key, values in changes.items():
        if isinstance(values, str | bytes) or not isinstance(values, Iterable):
            raise BadCase(f"changes: {key!r} has {values!r}; give a list of its values")
    return [dict(zip(changes, values, strict=True)) for values in product(*changes.values())] if changes else []


def _one(run: Run | str | Sequence[str], number: int) -> dict[str, Value]:
    if isinstance(run, Mapping):
        return dict(run)
    found: dict[str, Value] = {}
    for change in [run] if isinstance(run, str) else run:
        key, equals, value = str(change).partition("=")
        if not equals or not key.strip():
            raise BadCase(
                f"changes, run {number}: {change!r}: expected key=value, for instance controller.period=10 ms"
            )
        found[key.strip()] = value.strip()
    return found


def _text(key: str, value: Value) -> str:
    """Format a value as TOML, or return its text."""
    if isinstance(value, str):
        return value
    plain = value.item() if hasattr(value, "item") else value  # for numpy's numbers
    if isinstance(plain, bool | int | float | str | list | tuple):
        try:
            return json.dumps(plain)
        except TypeError:
            pass
    if isinstance(plain, Fraction):
        raise BadCase(f"changes: {key!r} has {value!r}, which has no unit; write a text, for instance '10 ms'")
    raise BadCase(f"changes: {key!r} has {value!r}; expected a number, true or false, a text or a list of them")
