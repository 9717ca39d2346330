"""Discovery of the modules in a package's folder, so that adding a file adds a module."""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

PLUGINS = re.compile(rb"^\s*plugins\s*=", re.MULTILINE)


def has_plugins(folder: Path) -> bool:
    """Return True if a pyproject.toml in this folder or above has a line `plugins =`. The files are not parsed."""
    files = (above / "pyproject.toml" for above in (folder.resolve(), *folder.resolve().parents))
    return any(file.is_file() and PLUGINS.search(file.read_bytes()) for file in files)


def module_with(attribute: str, package: str, path: Iterable[str], name: str) -> ModuleType | None:
    """Import and return only the module of this name; None if there is none or it does not have the attribute."""
    if all(entry.name != name for entry in pkgutil.iter_modules(path)):
        return None
    module = importlib.import_module(f"{package}.{name}")
    return module if hasattr(module, attribute) else None


def modules_with(attribute: str, package: str, path: Iterable[str]) -> dict[str, ModuleType]:
    """Return the modules of a package that have an attribute, as a dictionary from name to module, in order of name.

    package: the `__name__` of the package. path: the `__path__` of the package.
    """
    names = sorted(entry.name for entry in pkgutil.iter_modules(path))
    found = {name: importlib.import_module(f"{package}.{name}") for name in names}
    return {name: module for name, module in found.items() if hasattr(module, attribute)}
