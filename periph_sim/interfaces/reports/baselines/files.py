"""Baseline files: the exact figures of a case as sorted JSON with one figure per line.

    a run's measures --> Baseline <--> timing/baselines/NAME.json

Figures are integers, so two runs can be compared for equality. Times are ticks; `ticks_per_cycle` ticks are one cycle
of SYSCLKOUT of the case's first unit. Instants are counted from the beginning of the run.

A file is written completely or not at all. If several files are written, all of them are replaced, or none.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import Literal

import msgspec

from ....core.convert import BadTable
from ....core.input_files import read_regular
from ....core.table import Table
from ....scene.case.error_text import complaint
from ....traces.capture.capture import BadCapture
from ....traces.formats import atomic_write

SCHEMA: Literal[1] = 1  # version of the file format; other versions are refused


class Figures(Table, frozen=True, kw_only=True):
    """The figures of one budget.

    unit: "time" for ticks, "%" and "LSB" for millionths of a whole and of an LSB, or the name of what is counted.
    count: the number of occurrences.
    worst, least: the largest and the smallest value; None if nothing was measured.
    worst_at, least_at: the instants of these values in ticks; None if a value has no instant.
    chain_of: "worst" or "least": the value whose occurrence `chain` describes.
    chain: the events around this occurrence as lines "TICKS EVENT" (see `event_chain`). TICKS are counted from the
        beginning of the occurrence.
    """

    measure: str
    unit: str
    count: int
    worst: int | None
    worst_at: int | None
    least: int | None
    least_at: int | None
    chain_of: Literal["worst", "least"]
    chain: list[str]


class Baseline(Table, frozen=True, kw_only=True):
    """The baseline of one case.

    simulated: the length of the run in ticks.
    events: the number of simulated events.
    counts: the counts of a run that are not figures of a budget.
    digest: the digest of all events and their times (see `EventDigests`); "" in files of an earlier version.
    bus_bytes: the digests of the bytes on the I2C bus (see `EventDigests`); empty without such bytes, and in files of
        an earlier version.
    """

    schema_version: Literal[1] = SCHEMA
    case: str
    simulated: int
    ticks_per_second: int
    ticks_per_cycle: int
    events: int
    counts: dict[str, int]
    budgets: dict[str, Figures]
    digest: str = ""
    bus_bytes: list[str] = []

    def with_chains(self, lines: Mapping[str, list[str]]) -> Baseline:
        """Return the baseline with other chains. lines: a dictionary from budgets to the lines of their chains."""
        budgets = {n: f.model_copy(update={"chain": lines.get(n, f.chain)}) for n, f in self.budgets.items()}
        return self.model_copy(update={"budgets": budgets})

    def chains_of(self, other: Baseline) -> dict[str, list[str]] | None:
        """Return the chains of another baseline if the run of this baseline certainly has the same chains; else None.

        It has the same chains if the figures and the digest of events of both baselines are equal. Otherwise, the case
        must be run again to find the chains.
        """
        chains = {name: one.chain for name, one in other.budgets.items()}
        same = self.digest and self.digest == other.digest and self.with_chains(chains).budgets == other.budgets
        return chains if same else None

    def cycles(self, ticks: int) -> str:
        """Format ticks as cycles: exactly if they are whole cycles, else rounded to hundredths."""
        value = Fraction(ticks, self.ticks_per_cycle)
        return f"{value.numerator}" if value.denominator == 1 else f"{float(value):.2f}"


class BadCheck(ValueError):
    """Error for cases or baselines that cannot be checked. The message has one sentence per line."""


def text_of(baseline: Baseline) -> str:
    """Format a baseline as JSON with sorted keys, one figure per line."""
    return json.dumps(msgspec.to_builtins(baseline), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def read(path: Path) -> Baseline | None:
    """Read a baseline. Return None if the file does not exist.

    Raise BadCheck if the file cannot be read or is not a baseline of this schema version.
    """
    try:
        data = read_regular(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise BadCheck(f"{path}: cannot be read ({error.strerror}); expected a baseline") from None
    return parse(str(path), data)


def parse(path: str, data: bytes) -> Baseline:
    """Return the baseline that the bytes of a file contain. path: the name of the file, for messages.

    Raise BadCheck if the bytes are not a baseline of this schema version.
    """
    try:
        tree = json.loads(data)
    except ValueError as error:
        raise BadCheck(f"{path}: it is not JSON ({error}); {RENEW}") from None
    if not isinstance(tree, dict) or "schema_version" not in tree:
        raise BadCheck(f"{path}: it has no schema_version, expected {SCHEMA}; {RENEW}")
    if tree["schema_version"] != SCHEMA:
        raise BadCheck(
            f"{path}: schema_version is {tree['schema_version']!r}, expected {SCHEMA}: another version of periph-sim "
            f"wrote it; compare with that version, or {RENEW}"
        )
    try:
        return Baseline.model_validate(tree)
    except BadTable as error:
        key = ".".join(str(part) for part in error.first.place)
        raise BadCheck(f"{path}: {key}: {complaint(error.first)}; {RENEW}") from None


RENEW = "write it again with --update-baseline"


def write_all(texts: Mapping[Path, str]) -> None:
    """Write each text to its path. If a text cannot be written, write none of them and raise BadCheck."""
    try:
        for folder in {path.parent for path in texts}:
            folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadCheck(f"{error.filename}: the folder cannot be created ({error.strerror})") from None
    try:
        with ExitStack() as together:
            for path, text in texts.items():
                together.enter_context(atomic_write(path)).write_text(text, encoding="utf-8", newline="\n")
    except BadCapture as error:
        raise BadCheck(str(error)) from None
