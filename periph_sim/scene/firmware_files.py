"""Import of firmware files, by path or by the name of a shipped program.

Each file is a module of a package of its own, under a unique name: a repository's own `firmware/` never
meets ours, nor two folders' files of one name. `from .other import f` finds other.py beside the file, else the shipped
program of that name, so that a copy of a shipped program runs from any folder.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from functools import lru_cache
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from itertools import count
from pathlib import Path
from threading import get_ident
from types import CodeType, ModuleType

from ..core.examples import EXAMPLES
from ..core.input_files import note_input, read_input
from ..processor.error_origin import raised_at
from ..processor.user_code import message_of

SHIPPED = EXAMPLES / "firmware" / "python"

PREFIX = "_firmware_"
SHIPPED_PACKAGE = f"{PREFIX}shipped"
_packages: dict[tuple[Path, int], str] = {}  # by file and thread: threads that load one file do not meet
_numbers = count()


def shipped_names() -> list[str]:
    """Return the names of the shipped programs and of the modules that they share, sorted."""
    return sorted(file.stem for file in SHIPPED.glob("*.py") if file.stem != "__init__")


def is_shipped(name: str) -> bool:
    """Return True if a shipped program, or a module that they share, has that name."""
    if f"{SHIPPED_PACKAGE}.{name}" in sys.modules:  # imported by an earlier scene, so its file was there
        return True
    return name.isidentifier() and name != "__init__" and (SHIPPED / f"{name}.py").is_file()


def shipped_module(name: str) -> ModuleType:
    """Return the module of a shipped program, imported once."""
    if SHIPPED_PACKAGE not in sys.modules:
        _make_package(SHIPPED_PACKAGE, [SHIPPED])
    return importlib.import_module(f"{SHIPPED_PACKAGE}.{name}")


def module_of_file(path: Path) -> ModuleType:
    """Return a firmware file's module, imported anew with all it imports from its folder: edits take effect."""
    path = note_input(path).resolve()
    package = _packages.setdefault((path, get_ident()), f"{PREFIX}{next(_numbers)}")
    for loaded in [name for name in tuple(sys.modules) if name.startswith(f"{package}.")]:  # other threads import, too
        del sys.modules[loaded]
    _make_package(package, [path.parent, SHIPPED])
    spec = _spec(f"{package}.{path.stem.replace('.', '_')}", path)
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up by name
    assert spec.loader is not None
    spec.loader.exec_module(module)
    return module


def why_not_loaded(error: BaseException, folder: Path) -> str:
    """Return the reason why a file of user code cannot be loaded, with the line and the fix. folder: of the file."""
    if isinstance(error, SyntaxError):
        return f"line {error.lineno}: {error.msg}"
    if not isinstance(error, ModuleNotFoundError):
        at = raised_at(error)
        return f"{at}{at and ': '}{type(error).__name__}: {message_of(error)}"
    package, _, name = (error.name or "").rpartition(".")
    if package.startswith(PREFIX):
        return f"it imports .{name}, but there is no {name}.py beside it"
    if (folder / f"{name}.py").is_file():
        return f"{error}; the {name}.py beside it is imported with a dot: from .{name} import ..."
    return str(error)


def _make_package(name: str, folders: list[Path]) -> None:
    spec = ModuleSpec(name, None, is_package=True)
    spec.submodule_search_locations = [str(folder) for folder in folders]
    sys.modules[name] = module_from_spec(spec)


class _Source(SourceFileLoader):
    """Compiles the text at every load: bytecode kept by the second would miss an edit, and litter the user's folder."""

    def get_code(self, fullname: str) -> CodeType:
        return _code_of(read_input(Path(self.path)), self.path)


@lru_cache(maxsize=64)
def _code_of(source: bytes, path: str) -> CodeType:
    """Compiled once for each text that a file has had: many scenes of one file import it anew each."""
    return _Source("", path).source_to_code(source, path)


def _spec(name: str, file: Path) -> ModuleSpec:
    kind = SourceFileLoader if file.parent == SHIPPED else _Source
    spec = spec_from_file_location(name, file, loader=kind(name, str(file)))
    assert spec is not None
    return spec


class _FirmwareFinder:
    """Finds what firmware imports with a dot; Python's own finder would keep bytecode in the user's folder."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if path is None or not fullname.startswith(PREFIX):
            return None
        files = (Path(folder) / f"{fullname.rpartition('.')[2]}.py" for folder in path)
        return next((_spec(fullname, note_input(file)) for file in files if file.is_file()), None)


sys.meta_path.insert(0, _FirmwareFinder())
