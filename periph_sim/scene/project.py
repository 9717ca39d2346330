"""Settings of a repository: `[tool.periph-sim]` of the nearest pyproject.toml.

    [tool.periph-sim]
    cases = ["timing", "bench/line.toml"]   cases that `check` runs without arguments; default: the folder timing, or
                                            the folder of the pyproject.toml if there is no timing
    baselines = "ci/figures"                folder of their baselines; default: baselines/ beside each case
    guaranteed = true                       `run`, `check` and the tests of case files require a saved proof of
                                            each budget
    jobs = 2                                number of processes of `check`
    tolerance = 1                           number of cycles by which times may differ from a baseline
    plugins = ["barometer.py"]              Python files that define chips, sensors and more: see `plugins`

Paths are relative to the folder of the pyproject.toml. A pyproject.toml without this table is ignored, even if the file
is not valid TOML.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Annotated

from msgspec import Meta, Struct

from ..core.convert import BadTable
from ..core.input_files import read_input
from ..core.phrases import did_you_mean
from ..core.table import Table
from .case.discover import is_case, is_searched
from .case.error_text import explain
from .case.model import BadCase
from .case.origin import Source, line_of

FILE = "pyproject.toml"
KEYS = ("tool", "periph-sim")


class Settings(Table, frozen=True, kw_only=True):
    """The table `[tool.periph-sim]` of a pyproject.toml."""

    cases: list[str] = []
    baselines: str | None = None
    guaranteed: bool = False
    jobs: Annotated[int, Meta(ge=1)] | None = None
    tolerance: Annotated[int, Meta(ge=0)] = 0
    plugins: list[str] = []


NOTHING = Settings()


class Project(Struct, frozen=True):
    """A user's project.

    folder: the folder of the project's pyproject.toml; if there is no such file, the folder given to `project_of`.
    """

    folder: Path
    settings: Settings = NOTHING

    def cases(self) -> list[Path]:
        """Return the folders and files whose cases `check` runs. Raise BadCase if any of them does not exist."""
        if not self.settings.cases:
            usual = self.folder / "timing"
            return [_near(usual if usual.is_dir() else self.folder)]
        places = [self.folder / text for text in self.settings.cases]
        for place in places:
            if not place.exists():
                there = did_you_mean(place.name, sorted(entry.name for entry in self.folder.iterdir()))
                raise BadCase(f"{self.where('cases')}: there is no folder or file {str(place)!r}; {there}")
        return [_near(place) for place in places]

    def where(self, key: str) -> str:
        """Return the place of a key in pyproject.toml, such as "pyproject.toml, line 2: cases"."""
        file = self.folder / FILE
        return f"{_near(file)}, line {line_of(file.read_text(encoding='utf-8'), (*KEYS, key))}: {key}"

    def baseline(self, case: Path) -> Path | None:
        """Return the path of a case's baseline; None for the default, baselines/NAME.json beside the case.

        The default applies if the project sets no folder of baselines, or if the case is not among the project's cases.

        The folder of baselines has the same sub-folders as the folder of cases, so that two cases of the same name in
        one of these folders have different baselines. Raise BadCase if the case has the same path inside its folder as
        another case of the project has inside another folder, because both would have the same baseline.
        """
        if self.settings.baselines is None:
            return None
        case = case.resolve()
        places = [place.resolve() for place in self.cases()]
        inside = _inside(case, places)
        if inside is None:
            return None
        baseline = _near(self.folder / self.settings.baselines / inside.with_suffix(".json"))
        for place in places:
            other = place if place.is_file() else place / inside
            if other != case and _inside(other, places) == inside and is_case(other):
                what = f"{_near(case)} and {_near(other)} would both have {baseline}; rename one of them"
                raise BadCase(f"{self.where('baselines')}: {what}, or leave baselines out")
        return baseline


def _inside(case: Path, places: Sequence[Path]) -> Path | None:
    """Return the path of a case relative to the first of these places that contains it; None if there is none.

    places: folders, and files of cases. For a place that is the file of the case itself, return the name of the file.
    """
    for place in places:
        if case.is_relative_to(place):
            return Path(case.name) if place.is_file() else case.relative_to(place)
    return None


def project_of(folder: Path) -> Project:
    """Return the project that a folder belongs to. Raise BadCase if its table is wrong or its file is not TOML."""
    for above in (folder.resolve(), *folder.resolve().parents):
        settings = _settings(above / FILE)
        if settings is not None:
            return Project(above, settings)
        if not is_searched(above):
            break  # files in a virtual environment or a hidden folder do not belong to the project around it
    return Project(folder.resolve())


def baseline_path(case: Path) -> Path:
    """Return the path of a case's baseline, from the project's settings or else baselines/NAME.json beside the case."""
    return project_of(case.parent).baseline(case) or case.parent / "baselines" / f"{case.stem}.json"


def _settings(file: Path) -> Settings | None:
    """Return the settings in a file; None if the file cannot be read or has no table `[tool.periph-sim]`."""
    try:
        data = read_input(file)
    except OSError:
        return None
    if b"periph-sim" not in data:
        return None
    try:
        text = data.decode("utf-8")
        tree = _parsed(text)
    except ValueError as error:
        if b"[tool.periph-sim]" not in data:
            return None
        raise BadCase(f"{_near(file)}: it is not TOML: {error}") from None
    table: object = tree
    for key in KEYS:
        table = table.get(key) if isinstance(table, dict) else None
    if table is None:
        return None
    try:
        return Settings.model_validate(table)
    except BadTable as error:
        raise BadCase(explain(Source(_near(file), text), error, above=KEYS)) from None


@lru_cache(maxsize=16)
def _parsed(text: str) -> dict[str, object]:
    return tomllib.loads(text)


def _near(path: Path) -> Path:
    """Return a path relative to the current folder if it is inside this folder; otherwise, return it unchanged."""
    here = Path.cwd()
    return Path(os.path.relpath(path, here)) if path.is_relative_to(here) else path
