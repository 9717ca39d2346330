"""Discovery of the modules in a package's folder, so that adding a file adds a module."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from types import ModuleType


def module_with(attribute: str, package: str, path: Iterable[str], name: str) -> ModuleType | None:
    """Import and return only the module of this name; None if there is none or it does not have the attribute."""
    if all(entry.name != name for entry in pkgutil.iter_modules(path)):
        return None
    module = importlib.import_module(f"{package}.{name}")
    return module if hasattr(module, attribute) else None


def modules_with(attribute: str, package: str, path: Iterable[str]) -> dict[str, ModuleType]:
    """Return the modules that have an attribute, in order of name. package, path: its `__name__` and `__path__`."""
    names = sorted(entry.name for entry in pkgutil.iter_modules(path))
    found = {name: importlib.import_module(f"{package}.{name}") for name in names}
    return {name: module for name, module in found.items() if hasattr(module, attribute)}
