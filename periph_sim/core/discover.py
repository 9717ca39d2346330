"""What stands in a package's folder: its modules, by the names of their files, so that adding one is adding a file."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from types import ModuleType


def module_with(attribute: str, package: str, path: Iterable[str], name: str) -> ModuleType | None:
    """The module of that name alone, the others not imported; None where there is none that has the attribute."""
    if all(entry.name != name for entry in pkgutil.iter_modules(path)):
        return None
    module = importlib.import_module(f"{package}.{name}")
    return module if hasattr(module, attribute) else None


def modules_with(attribute: str, package: str, path: Iterable[str]) -> dict[str, ModuleType]:
    """The modules that have an attribute, in order of their names. package, path: its `__name__`, `__path__`."""
    names = sorted(entry.name for entry in pkgutil.iter_modules(path))
    found = {name: importlib.import_module(f"{package}.{name}") for name in names}
    return {name: module for name, module in found.items() if hasattr(module, attribute)}
