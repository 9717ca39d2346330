"""Checks of the tests of open questions: each option has a test `test_open_NAME`, which runs with every value."""

from __future__ import annotations

import dataclasses
import sys
from typing import TypeVar

from periph_sim.core.options import Value

from .module_rig import ModuleRig

T = TypeVar("T", bound=ModuleRig)

kept: dict[str, list[ModuleRig]] = {}  # option -> the rigs that the current test has kept for it


def keep(option: str, rig: T) -> T:
    """Keep a rig until the end of the test, where at least one rig kept for an option must list it in `touched`."""
    kept.setdefault(option, []).append(rig)
    return rig


def check_tests_of(options: type, module: str) -> None:
    """Fail if an option has no test in this module, if the test omits a value, or if the default is not the first."""
    for option in dataclasses.fields(options):
        test = getattr(sys.modules[module], f"test_open_{option.name}", None)
        assert test is not None, option.name
        values = _values_tried(test.pytestmark)
        if "values" in option.metadata:
            assert set(values) == set(option.metadata["values"]), option.name
            assert option.default == option.metadata["values"][0]
        else:
            assert {option.default, option.metadata["least"], option.metadata["most"]} <= set(values), option.name


def _values_tried(marks: list) -> list[Value]:
    """Return the values with which a test parametrises its argument `value`."""
    for mark in marks:
        if mark.name == "parametrize" and "value" in (mark.args[0], mark.args[0][0]):
            return [row[0] if isinstance(row, tuple) else row for row in mark.args[1]]
    return []
