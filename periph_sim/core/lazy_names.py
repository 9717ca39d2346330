"""Names of a package that are imported when they are first used: what needs one file of it need not load the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType


def lazy_names(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """The `__getattr__` of a package. homes: by module of it, the names that stand there."""
    places = {name: home for home, names in homes.items() for name in names}

    homes_of: dict[str, ModuleType] = {}  # those that were imported, by name

    def found(name: str) -> object:
        home = homes_of.get(name)
        if home is None:
            if name not in places:
                raise AttributeError(f"module {package!r} has no attribute {name!r}")
            home = homes_of[name] = import_module(f"{package}.{places[name]}")
        return getattr(home, name)

    return found
