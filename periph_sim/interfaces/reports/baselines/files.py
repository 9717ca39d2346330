"""Baseline files: sorted JSON with one figure per line.

A file is written completely or not at all; several files are written together once all are complete.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

import msgspec

from ....core.convert import BadTable
from ....core.input_files import read_regular
from ....scene.case.error_text import complaint
from ....scene.project import project_of
from ....traces.capture.capture import BadCapture
from ....traces.formats.atomic_write import atomic_write
from .errors import BadCheck
from .figures import SCHEMA, Baseline

FOLDER = "baselines"


def path_for(case: Path) -> Path:
    """Return the baseline's path: from the project's settings, else baselines/NAME.json beside the case."""
    return project_of(case.parent).baseline(case) or case.parent / FOLDER / f"{case.stem}.json"


def text_of(baseline: Baseline) -> str:
    """Format a baseline as JSON with sorted keys, one figure per line."""
    return json.dumps(msgspec.to_builtins(baseline), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def read(path: Path) -> Baseline | None:
    """Read a baseline; None if there is no such file. Raise BadCheck if it is not of this schema version."""
    try:
        data = read_regular(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise BadCheck(f"{path}: cannot be read ({error.strerror}); expected a baseline") from None
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
    """Write each text to its path, all or none. Raise BadCheck if that fails."""
    try:
        for folder in {path.parent for path in texts}:
            folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadCheck(f"{error.filename}: the folder cannot be created ({error.strerror})") from None
    try:
        with ExitStack() as together:
            for path, text in texts.items():
                together.enter_context(atomic_write(path)).write_text(text, encoding="utf-8")
    except BadCapture as error:
        raise BadCheck(str(error)) from None
