"""Sources and declarations of all compiled modules, read once for all tests of a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from periph_sim.form import PACKAGE
from periph_sim.form.compiled_class import Class
from periph_sim.form.declarations import declarations
from periph_sim.form.sources import Sources


def written(folder: Path, name: str, **modules: str) -> Path:
    """Write a package with these modules into a folder, and return its path. modules: their texts by their names."""
    package = folder / name
    package.mkdir()
    (package / "__init__.py").touch()
    for module, text in modules.items():
        (package / f"{module}.py").write_text(text)
    return package


@cache
def package() -> Sources:
    return Sources(PACKAGE)


@cache
def classes() -> list[Class]:
    return [one for module in package().compiled() for one in package()[module].classes.values()]


@cache
def every_declaration() -> list[str]:
    """Return the text of each module's .pxd file."""
    return [declarations(package()[module]).text for module in package().compiled()]
