"""Choice of the modules that a run imports: the compiled core or its Python sources. Both give the same records.

The core is the part of the package that Cython compiles to C. It is compiled because its code runs at every event.

    the build matches the sources --> the compiled modules are imported
    it does not                   --> the Python sources are imported, and `note` contains the reason

A build stores one digest of all sources from which it was made. A build is ignored in two cases:

- A source, or the version of Python, has changed since the build. Compiled code therefore always matches the sources.
- The library of the build is missing or has another size than it had when it was built, or the manifest is missing or
  invalid. Loading a truncated library would end the process without a message.

The digest is calculated only if the size or the modification time of a source differs from the value in the build.

The environment variable PERIPH_SIM_FORM selects the build:

    not set, or `compiled`                 the build of `make core`; if there is none, the Python sources are imported
    `interpreted`                          no build; the Python sources are imported
    `hard`                                 the test build of `make core HARD=1`
    a path with a slash: `build/mine/`     the build in that folder

Any other value ends the process with a message, and so does a missing folder for `hard` or for a path.

Terms of this package:
.pxd file: declares to Cython the C types of the classes and functions of one module.
cimport: Cython's import of a C type or C function from the .pxd file of another module.
directive: a setting of Cython, for a whole module or for one class or function.
mark: a comment `# core: ...` at a class or function; the module `sources` lists these comments.
greenlet: a coroutine with its own C stack, of the Python package `greenlet`; firmware runs in greenlets.
"""

from __future__ import annotations

import json
import os
import stat
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    SOURCE_SUFFIXES,
    ExtensionFileLoader,
    FileFinder,
    ModuleSpec,
    SourceFileLoader,
)
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import NoReturn

PACKAGE = Path(__file__).resolve().parents[1]
BUILT = PACKAGE / "compiled"  # folder of the build, which `make core` creates
HARD_BUILT = PACKAGE.parent / "build" / "hard"  # folder of the test build, which `make core HARD=1` creates
MANIFEST = "manifest.json"
VARIABLE = "PERIPH_SIM_FORM"
COMPILED, INTERPRETED, HARD = "compiled", "interpreted", "hard"
SUFFIX = EXTENSION_SUFFIXES[0]
LIBRARY = f"core{SUFFIX}"  # one library for all compiled modules, so that it is loaded only once

running = INTERPRETED
note = ""  # the reason why the selected build is ignored; "" if it is used or missing, or if none is selected


def stamps(package: Path, modules: Sequence[str]) -> list[list[int]]:
    """Return [size, modification time in ns] for each source of these modules and each file of `periph_sim.form`."""
    sources = [f"{package}{os.sep}{module.replace('.', os.sep)}.py" for module in modules]
    own = Path(__file__).parent
    found = [os.stat(path) for path in (*sources, *(f"{own}{os.sep}{name}" for name in sorted(os.listdir(own))))]
    return [[one.st_size, one.st_mtime_ns] for one in found if stat.S_ISREG(one.st_mode)]


def digest(package: Path, modules: Sequence[str]) -> str:
    """Return a digest of Python's minor version and platform, these modules' sources, and those of `periph_sim.form`.

    modules: the names of modules within the package, for example "core.kernel".
    """
    import hashlib  # imported here because few runs need it

    found = hashlib.sha256(SUFFIX.encode())
    for path in (*(source_of(package, module) for module in modules), *sorted(Path(__file__).parent.glob("*.py"))):
        found.update(path.name.encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def source_of(package: Path, module: str) -> Path:
    """Return the path of a module's source file."""
    return package.joinpath(*module.split(".")).with_suffix(".py")


def symbol(module: str) -> str:
    """Return the name of a module in the C library, made from its whole path, because file names are not unique."""
    return module.replace(".", "__")


class DoesNotLoad(ImportError):
    """The compiled core cannot be loaded here, for example because it was built with a newer C library."""


class _Loader(ExtensionFileLoader):
    def create_module(self, spec: ModuleSpec) -> ModuleType:
        try:
            module = super().create_module(ModuleSpec(symbol(spec.name), self, origin=spec.origin))
        except ImportError as error:
            said = f"the compiled core does not load here: {error}; `{way()}` builds it anew"
            raise DoesNotLoad(f"{said}, {VARIABLE}={INTERPRETED} leaves it alone") from None
        module.__name__, module.__package__ = spec.name, spec.parent
        return module


def finders(package: Path, built: Path, modules: Sequence[str]) -> Callable[[str], FileFinder]:
    """Return an entry of `sys.path_hooks` that finds the compiled modules in folders of the package.

    A finder in `sys.meta_path` would not work under pytest and cocotb. Their own finder, which rewrites assertions, is
    first in `sys.meta_path`, and it uses path hooks to find modules.
    """
    names = {f"{package.name}.{module}" for module in modules}
    library = built / LIBRARY

    class Finder(FileFinder):
        def find_spec(self, fullname: str, target: ModuleType | None = None) -> ModuleSpec | None:
            if fullname not in names:
                return super().find_spec(fullname, target)
            return spec_from_file_location(fullname, library, loader=_Loader(fullname, str(library)))

    def finder(folder: str) -> FileFinder:
        if not _is_inside(folder, package):
            raise ImportError(f"{folder} is not of {package.name}")
        return Finder(folder, (ExtensionFileLoader, EXTENSION_SUFFIXES), (SourceFileLoader, SOURCE_SUFFIXES))

    return finder


def _is_inside(folder: str, package: Path) -> bool:
    return f"{folder}{os.sep}".startswith(f"{package}{os.sep}") or Path(folder).resolve().is_relative_to(package)


def usable(package: Path, built: Path) -> tuple[list[str], str]:
    """Return (the modules of the build, "") if the build matches the sources; otherwise ([], the reason)."""
    try:
        manifest = json.loads((built / MANIFEST).read_text("utf-8"))
        modules, made_of = list(manifest["modules"]), str(manifest["digest"])
        whole = (built / LIBRARY).stat().st_size == manifest["size"]
    except (OSError, ValueError, KeyError, TypeError):
        whole = False
    if not whole:
        return [], "the compiled core is not whole"
    try:
        same = stamps(package, modules) == manifest.get("stamps") or digest(package, modules) == made_of
    except OSError:
        same = False
    return (modules, "") if same else ([], "the compiled core was built of other sources or for another Python")


def way() -> str:
    """Return the command that compiles the core. It differs between a clone and an installed package."""
    return "make core" if (PACKAGE.parent / "Makefile").is_file() else "python -m periph_sim.form.build"


def _refuse(said: str, what: str) -> NoReturn:
    known = f"{INTERPRETED}, {COMPILED}, {HARD} (after `make core HARD=1`) or the folder of a build, as in build/mine/"
    sys.stderr.write(
        f"Error: the environment variable {VARIABLE} is {said!r}, but there is no such {what}; expected {known}\n"
    )
    raise SystemExit(2)


def choose() -> None:
    """Make later imports use the compiled modules, if a build exists and matches the sources."""
    global running, note
    said = os.environ.get(VARIABLE, "")
    built = HARD_BUILT if said == HARD else Path(said) if os.sep in said else BUILT
    if os.sep not in said and said not in ("", COMPILED, INTERPRETED, HARD):
        _refuse(said, "form")
    if built != BUILT and not built.is_dir():
        _refuse(said, "build")
    if said == INTERPRETED or not built.is_dir():
        return
    modules, why = usable(PACKAGE, built)
    if why:
        note = f"{why}, so it is left alone and this run is interpreted; `{way()}` builds it anew"
        return
    sys.path_hooks.insert(0, finders(PACKAGE, built, modules))
    for folder in [folder for folder in sys.path_importer_cache if _is_inside(folder, PACKAGE)]:
        del sys.path_importer_cache[folder]
    running = COMPILED
