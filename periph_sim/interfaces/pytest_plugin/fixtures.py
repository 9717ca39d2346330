"""The value of the fixture `scene`: a function that runs a case file or a firmware function with changes.

scene("timing/mine.toml", "controller.period=10 ms", seconds=2)  --> Run
scene(firmware, modules=["I2C-A"], controller={...}, budget=[...], seconds=2)  --> Run
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from ...core.phrases import did_you_mean
from ...core.table import duration
from ...scene.case.load import case_of_tables, load
from ...scene.case.model import BadCase
from ...scene.firmware_loader import Firmware
from ...timing.verdict import Verdict
from .figures import properties
from .keys import current
from .runs import Plan, Run, run_plan

Program = Callable[[Any, Any], None]
Length = float | str | Fraction | None
UNIT = "dsp"  # name of the unit that runs a firmware function


class SceneFactory:
    """A callable object that builds and runs cases for tests (see `__call__`)."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config

    def __repr__(self) -> str:
        return "<scene(file or firmware function, *changes, seconds=None, record=False, ...)>"

    def __call__(
        self,
        what: str | Path | Program,
        *changes: str,
        seconds: Length = None,
        record: bool = False,
        modules: Sequence[str] = (),
        settings: object = None,
        unit: dict[str, Any] | None = None,
        **tables: Any,
    ) -> Run:
        """Run a case and return its Run.

        what: a case file, relative to the test's file or pytest's rootdir; or firmware as a function (dsp, settings).
        changes: KEY=VALUE texts, as for `periph-sim run --set`.
        seconds: the simulated duration as a number of seconds or a text with a unit ("500 ms"); None for the duration
            that the case states.
        record: True to keep all records and edges.

        These arguments are only for a function:

        modules: the names of the unit's modules.
        settings: any object, which the function receives as its second argument.
        unit: a dictionary from further keys of a unit, such as pins, to their values.
        tables: the other tables of a case (controller, host, budget, ...).

        Raise BadCase, with one sentence, if the case cannot be built, and the errors of a run.
        """
        __tracebackhide__ = True
        try:
            if callable(what):
                plan = _of_function(
                    what, changes, seconds, settings, {"modules": list(modules), **(unit or {})}, tables
                )
            else:
                given = {"settings": settings, "modules": modules, "unit": unit, **tables}
                for name in (name for name in given if given[name]):
                    raise BadCase(f"{what}: {name}= is for firmware given as a function; change a file by 'key=value'")
                plan = Plan(load(self._found(Path(what)), list(changes)), _length(seconds))
            return run_plan(plan, self._add_properties, keep_edges=callable(what), record=record)
        except BadCase as error:
            raise error.with_traceback(None) from None  # the message is sufficient, and the traceback is internal

    def _found(self, path: Path) -> Path:
        """Find a case file in the folder of the running test or in rootdir. Raise BadCase if there is none."""
        root = self._config.rootpath
        item = self._config.stash.get(current, None)
        folders = [root] if item is None else [item.path.parent, root]
        for folder in folders:
            if (folder / path).is_file():
                return folder / path
        there = {
            file.relative_to(folder).as_posix(): 0
            for folder in folders
            for file in sorted((folder / path).parent.glob("*.toml"))
        }
        raise BadCase(
            f"{path}: there is no such case file beside the test or in {root}; {did_you_mean(path.as_posix(), there)}"
        )

    def _add_properties(self, run: Run, verdicts: Sequence[Verdict]) -> None:
        """Add figures to the test that is running, which is not necessarily the test that made the run."""
        item = self._config.stash.get(current, None)
        if item is not None:
            for verdict in verdicts:
                item.user_properties.extend(properties(run.result.case, verdict))


def _length(given: Length) -> Fraction | None:
    """Return a duration in seconds, or None for None. Raise BadCase if it is no duration above 0."""
    if given is None:
        return None
    try:
        length = duration(given) if isinstance(given, str) else Fraction(str(given))
    except ValueError as error:
        raise BadCase(f"seconds={given!r}: {error}") from None
    if length <= 0:
        raise BadCase(f"seconds={given!r}: expected more than 0")
    return length


def _of_function(
    program: Program,
    changes: Sequence[str],
    seconds: Length,
    settings: object,
    unit: dict[str, Any],
    tables: dict[str, Any],
) -> Plan:
    length = _length(seconds)
    name = getattr(program, "__name__", type(program).__name__)
    if length is None and "duration" not in tables:
        raise BadCase(f"scene({name}): its duration is missing; give seconds=")
    tree: dict[str, Any] = {"name": name, "unit": {UNIT: {"firmware": name, **unit}}, **tables}
    if length is not None:
        tree["duration"] = length
    case = case_of_tables(tree, f"scene({name})", changes)
    return Plan(case, length, {UNIT: Firmware(name, lambda dsp, _: program(dsp, settings), None)})
