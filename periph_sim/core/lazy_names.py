"""Names of a package that are imported at their first use, so that using one module does not load the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType


def lazy_names(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """Return the `__getattr__` of a package. homes: for each module, the names that it defines."""
    places = {name: module for module, names in homes.items() for name in names}

    imported: dict[str, ModuleType] = {}  # imported modules, indexed by attribute name

    def found(name: str) -> object:
        module = imported.get(name)
        if module is None:
            if name not in places:
                raise AttributeError(f"module {package!r} has no attribute {name!r}")
            module = imported[name] = import_module(f"{package}.{places[name]}")
        return getattr(module, name)

    return found
