"""The runs of a sweep. Their values become `key=value` texts, with which worker processes execute the runs.

{"seed": (1, 2), "host.jitter": ("0 us", "50 us")}  --> a run for each combination; the last key changes fastest
[{"seed": 1}, {"seed": 2, "start": "1 ms"}]         --> two runs with these values
["seed=1", ["seed=2", "start=1 ms"]]                --> the same two runs, in the form of `--set`
Job, values of some runs                            --> a Row for each run; Jobs and Rows can be sent between processes

`--vary` has the values of a key in one text: "1, 2, 5" or "0 ms to 20 ms step 10 us". A range includes its last
value if this is a whole number of steps from the first value. The values of a range are exact, and in the unit of the
step.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import TypeAlias

from ....core.table import HERTZ
from ....core.time import UNITS
from ....scene.case.model import BadCase
from ....scene.case.toml_file import text_of
from ....scene.firmware_loader import Firmware
from ....scene.prepared import PreparedScene
from ....scene.result import Result
from .. import REFUSED

Value: TypeAlias = object  # a number, a boolean, a text as after "=" in `--set`, or a list of these
Run: TypeAlias = Mapping[str, Value]
Changes: TypeAlias = Mapping[str, Iterable[Value]] | Iterable[Run | str | Sequence[str]]


def runs_of(changes: Changes) -> list[dict[str, Value]]:
    """Return a dictionary from keys to values for each run. Raise BadCase if a change is invalid or there is no run."""
    if isinstance(changes, str):
        raise BadCase(f"changes={changes!r}: give a list of runs, or a table of keys and their values")
    if isinstance(changes, Mapping):
        for key, values in changes.items():
            if isinstance(values, str | bytes) or not isinstance(values, Iterable):
                raise BadCase(f"changes: {key!r} has {values!r}; give a list of its values")
        combinations = product(*changes.values()) if changes else ()
        runs = [dict(zip(changes, values, strict=True)) for values in combinations]
    else:
        runs = [_one(run, number) for number, run in enumerate(changes)]
    if not runs:
        raise BadCase("changes: they contain no run; give each key at least one value")
    return runs


def texts_of(run: Run) -> list[str]:
    """Return the changes of a run as texts for `--set`. Raise BadCase for a value that a case cannot have."""
    return [f"{key}={_text(key, value)}" for key, value in run.items()]


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
    """Format a value as TOML. A text is returned unchanged."""
    if isinstance(value, str):
        return value
    plain = value.item() if hasattr(value, "item") else value  # converts a number of numpy to a number of Python
    if isinstance(plain, bool | int | float | str | list | tuple):
        try:
            return json.dumps(plain)
        except TypeError:
            pass
    if isinstance(plain, Fraction):
        raise BadCase(f"changes: {key!r} has {value!r}, which has no unit; write a text, for instance '10 ms'")
    raise BadCase(f"changes: {key!r} has {value!r}; expected a number, true or false, a text or a list of them")


RANGE = re.compile(r"(?P<first>.+?)\s+to\s+(?P<last>.+?)\s+step\s+(?P<step>.+)")
NUMBER = re.compile(r"(-?\d+(?:\.\d+)?)\s*([a-zA-Z%]*)")
MOST = 1_000_000  # maximum number of values of a range; a larger number suggests a step in the wrong unit


def values_of(key: str, text: str) -> list[str]:
    """Return the values of a key from a text, which is a list or a range. Raise BadCase if the text is invalid."""
    found = RANGE.fullmatch(text.strip())
    if found is not None:
        return _range(key, *found.group("first", "last", "step"))
    values = _apart(text)
    if not all(values):
        raise BadCase(f"--vary {key}={text}: a value is missing; write for instance {key}=1, 2, 5 or 0 to 10 step 2")
    return values


def _range(key: str, *texts: str) -> list[str]:
    shown = "{} to {} step {}".format(*texts)
    (first, of_first), (last, of_last), (step, unit) = (_number(key, text, shown) for text in texts)
    families = ({name: UNITS[name] for name in ("ns", "us", "ms", "s")}, HERTZ)  # units that differ by powers of ten
    family = next((units for units in families if unit in units), {unit: 1})
    scales = {name: Fraction(size) for name, size in family.items()}
    if not {of_first, of_last} <= scales.keys():
        what = f"its units {of_first or 'none'}, {of_last or 'none'} and {unit or 'none'} do not match"
        raise BadCase(f"--vary {key}={shown}: {what}")
    first, last = first * scales[of_first] / scales[unit], last * scales[of_last] / scales[unit]
    if step <= 0 or last < first:
        raise BadCase(f"--vary {key}={shown}: it has no values; the step must be above 0, the last above the first")
    count = int((last - first) / step) + 1
    if count > MOST:
        raise BadCase(f"--vary {key}={shown}: it has {count} values; give a larger step")
    digits = Context(prec=100)  # precise enough for exact results, since numbers and units are decimal
    values = (first + place * step for place in range(count))
    exact = (digits.divide(Decimal(value.numerator), Decimal(value.denominator)).normalize(digits) for value in values)
    return [f"{value:f} {unit}".strip() for value in exact]


def _number(key: str, text: str, shown: str) -> tuple[Fraction, str]:
    found = NUMBER.fullmatch(text.strip())
    if found is None:
        raise BadCase(
            f"--vary {key}={shown}: {text!r} is not a number with a unit; write for instance 0 ms to 1 ms step 5 us"
        )
    return Fraction(found[1]), found[2]


def _apart(text: str) -> list[str]:
    """Split a text at commas outside brackets, braces and quotes."""
    parts, depth, quote = [""], 0, ""
    for sign in text:
        if quote:
            quote = "" if sign == quote else quote
        elif sign in "\"'":
            quote = sign
        else:
            depth += (sign in "[{") - (sign in "]}")
        if sign == "," and not depth and not quote:
            parts.append("")
        else:
            parts[-1] += sign
    return [part.strip() for part in parts]


Row = Result | str  # the result of a run, or the reason why the run could not be made


@dataclass(frozen=True)
class Job:
    """The data that all runs of a sweep share.

    file: the absolute path of the case file.
    shown: the path of the case file as the caller wrote it, for messages.
    length: the duration of each run in seconds; None for the duration that the case states.
    programs: a dictionary from units to firmware that is given as functions.
    make: a function that returns the row of a file and its changes; None to run the case once.
    """

    file: str
    shown: str
    length: Fraction | None
    programs: Mapping[str, Firmware]
    make: Callable[[str, Sequence[str]], Row] | None = None


def rows_of(job: Job, runs: Sequence[Sequence[str]]) -> list[Row]:
    """Execute some runs one after the other. Return their rows. runs: the changes of each run, as for `--set`."""
    return [_row(job, changes) for changes in runs]


@lru_cache(maxsize=4)
def _prepared(file: str, text: str) -> PreparedScene:
    """Return the prepared scene of a case file. Later runs in the same process use it until the file's text changes."""
    return PreparedScene(file)


def _row(job: Job, changes: Sequence[str]) -> Row:
    if job.make is not None:
        row = job.make(job.file, changes)
        return _as_named(job, row) if isinstance(row, str) else row
    try:
        prepared = _prepared(job.file, text_of(Path(job.file), "case"))
        return prepared.scene(changes, None, job.programs).run(job.length)
    except REFUSED as error:
        return _as_named(job, str(error))


def _as_named(job: Job, text: str) -> str:
    """Return a message with the path of the case as the caller wrote it."""
    folder, shown = (str(Path(path).parent) for path in (job.file, job.shown))
    return text.replace(job.file, job.shown).replace(f"{folder}{os.sep}", "" if shown == "." else f"{shown}{os.sep}")
