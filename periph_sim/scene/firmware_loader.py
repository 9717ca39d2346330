"""Loading of firmware: files are imported by path or by the name of a shipped program, with checked settings.

The shipped programs are the files in the folder `SHIPPED`, and the modules of one package. Each file of a user is a
module in a package of its own with a unique name. So a user's file can have the same name as a file in another folder,
or as a shipped program. `from .other import f` finds other.py in the folder of the file, or else the shipped program
`other`. So a copy of a shipped program runs from any folder.
"""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import is_dataclass
from functools import lru_cache, partial
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from itertools import count
from pathlib import Path
from threading import get_ident
from types import CodeType, ModuleType
from typing import TYPE_CHECKING, Any, TypeVar, cast

from msgspec import Struct

from ..core.convert import BadTable, convert, keys_of
from ..core.examples import EXAMPLES
from ..core.input_files import note_input, read_input
from ..core.phrases import did_you_mean
from ..processor.user_code import PASSES, Misuse, defined_at, flaw_of, message_of, raised_at
from .case.error_text import complaint

if TYPE_CHECKING:
    from ..processor.dsp import Dsp


T = TypeVar("T")

SHIPPED = EXAMPLES / "firmware" / "python"

PREFIX = "_firmware_"
SHIPPED_PACKAGE = f"{PREFIX}shipped"
# `_packages` maps a file and a thread to the name of a package, because several threads may load the same file.
_packages: dict[tuple[Path, int], str] = {}
_numbers = count()


def is_shipped(name: str) -> bool:
    """Return True if a shipped program, or a module that shipped programs share, has this name."""
    if f"{SHIPPED_PACKAGE}.{name}" in sys.modules:  # an earlier scene has imported it, so it exists
        return True
    return name.isidentifier() and name != "__init__" and (SHIPPED / f"{name}.py").is_file()


def shipped_module(name: str) -> ModuleType:
    """Return the module of a shipped program, imported once."""
    if SHIPPED_PACKAGE not in sys.modules:
        _make_package(SHIPPED_PACKAGE, [SHIPPED])
    return importlib.import_module(f"{SHIPPED_PACKAGE}.{name}")


def module_of_file(path: Path) -> ModuleType:
    """Import a firmware file and return its module.

    The files that this file imports with a leading dot are imported again, so that edits of these files take effect.
    """
    path = note_input(path).resolve()
    package = _packages.setdefault((path, get_ident()), f"{PREFIX}{next(_numbers)}")
    # `sys.modules` is copied first, because other threads may import at the same time.
    for loaded in [name for name in tuple(sys.modules) if name.startswith(f"{package}.")]:
        del sys.modules[loaded]
    _make_package(package, [path.parent, SHIPPED])
    spec = _spec(f"{package}.{path.stem.replace('.', '_')}", path)
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # `dataclass` finds the module of a class by its name in `sys.modules`
    assert spec.loader is not None
    spec.loader.exec_module(module)
    return module


def imported(
    what: str,
    load: Callable[[], T],
    folder: Path,
    refused: Callable[[str], Exception],
    passes: tuple[type[BaseException], ...] = PASSES,
) -> T:
    """Return the result of `load`, which imports user code. Raise `refused(sentence)` if the import fails.

    refused: a class of exceptions, or a function that returns an exception.
    what: the subject of the sentence, such as "firmware 'a.py'".
    folder: the folder of the imported file.
    passes: classes of exceptions that are raised unchanged.
    """
    try:
        return load()
    except passes:
        raise
    except BaseException as error:
        raise refused(f"{what} cannot be loaded: {why_not_loaded(error, folder)}") from None


def existing(path: Path, what: str, refused: Callable[[str], Exception]) -> Path:
    """Return `path` unchanged. Raise the exception `refused(why)` if it is not a regular file.

    what: the kind of file, for messages.
    """
    if path.is_file():
        return path
    missing = f"{str(path)!r} is not a regular file" if path.exists() else f"there is no {what} {str(path)!r}"
    raise refused(f"{missing}; its path counts from the folder of the case")


def why_not_loaded(error: BaseException, folder: Path) -> str:
    """Return why a file of user code cannot be loaded, as a phrase, with the line or the fix if one is known.

    error: the exception that the import raised. folder: the folder of the file.
    """
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
    """Loader of a user's Python files that reads and writes no bytecode files.

    A bytecode file would hide edits that are made within one second, and would be written to the user's folder.
    """

    def get_code(self, fullname: str) -> CodeType:
        return _code_of(read_input(Path(self.path)), self.path)


@lru_cache(maxsize=64)
def _code_of(source: bytes, path: str) -> CodeType:
    """Return the compiled code of a file, from a cache, because each scene imports the file again."""
    return _Source("", path).source_to_code(source, path)


def _spec(name: str, file: Path) -> ModuleSpec:
    kind = SourceFileLoader if file.parent == SHIPPED else _Source
    spec = spec_from_file_location(name, file, loader=kind(name, str(file)))
    assert spec is not None
    return spec


class _FirmwareFinder:
    """Finder of relative imports in firmware. Python's own finder would write bytecode files to the user's folder."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if path is None or not fullname.startswith(PREFIX):
            return None
        files = (Path(folder) / f"{fullname.rpartition('.')[2]}.py" for folder in path)
        return next((_spec(fullname, note_input(file)) for file in files if file.is_file()), None)


sys.meta_path.insert(0, _FirmwareFinder())


class Firmware(Struct, frozen=True):
    """A program: its main function, and the dataclass of its settings if the program has settings.

    main: the function that runs the program, called with the unit and its settings.
    settings: the object `Settings` of the program; None if there is none. Only a dataclass counts.
    replay: the names in the module's list `REPLAY`: settings that a replay may set to values from a capture.
    """

    name: str
    main: Callable[[Dsp, object], None]
    settings: object
    replay: tuple[str, ...] = ()


class BadFirmware(ValueError):
    """Error: a program cannot be loaded. The message is one sentence."""


class BadSetting(ValueError):
    """Error: a setting of firmware, a device or a fault is wrong.

    name: the name of the setting; "" if several settings do not fit together.
    """

    def __init__(self, what: str, name: str) -> None:
        super().__init__(what)
        self.name = name


def load_firmware(name: str) -> Firmware:
    """Return a Python program. name: the name of a shipped program, or the path of a .py file.

    Raise BadFirmware if the program cannot be loaded.
    """
    if not name:
        raise BadFirmware("its unit runs no Python firmware, which this needs")
    return _loaded(name) if name.endswith(".py") else _loaded_once(name)


def _loaded(name: str) -> Firmware:
    load = partial(_module_of, name)
    module = imported(f"firmware {name!r}", load, Path(name).parent, BadFirmware, (*PASSES, BadFirmware))
    if not callable(getattr(module, "main", None)):
        raise BadFirmware(f"firmware {name!r} has no function main(dsp, settings)")
    what = flaw_of(module.main, 2)
    if what:
        at = defined_at(module.main)
        raise BadFirmware(f"firmware {name!r}, {at}: main {what}; expected a plain function main(dsp, settings)")
    return Firmware(name, module.main, getattr(module, "Settings", None), _replay_settings(name, module))


def _module_of(name: str) -> ModuleType:
    if name.endswith(".py"):
        return module_of_file(existing(Path(name), "firmware file", BadFirmware))
    if is_shipped(name):
        return shipped_module(name)
    names = sorted(file.stem for file in SHIPPED.glob("*.py") if file.stem != "__init__")
    raise BadFirmware(f"there is no firmware {name!r}; {did_you_mean(name, names)}")


_loaded_once = lru_cache(maxsize=64)(_loaded)  # used for shipped programs, which do not change during a process


def _replay_settings(name: str, module: ModuleType) -> tuple[str, ...]:
    """Return the names in a module's `REPLAY`; () if it has none.

    Raise BadFirmware for a name that is not a setting, or if `REPLAY` is not a tuple or list of texts.
    """
    given: object = getattr(module, "REPLAY", ())
    kind = getattr(module, "Settings", None)
    known = [*keys_of(kind)] if inspect.isclass(kind) and is_dataclass(kind) else []
    if not isinstance(given, tuple | list) or not all(isinstance(one, str) for one in given):
        raise BadFirmware(f"firmware {name!r}: REPLAY is {given!r}; expected a tuple of names of settings")
    for one in given:
        if one not in known:
            raise BadFirmware(
                f"firmware {name!r}: REPLAY names {one!r}, which is no setting; {did_you_mean(one, known)}"
            )
    return tuple(given)


def run_main(firmware: Firmware, dsp: Dsp, settings: object) -> None:
    """Call the main function. Raise Misuse if the function returns a value, because nothing would use this value."""
    came = firmware.main(dsp, settings)  # type: ignore[func-returns-value]
    if came is not None:
        raise Misuse(f"main, {defined_at(firmware.main)}, returned {came!r}; firmware returns nothing")


def settings_for(firmware: Firmware, given: dict[str, object]) -> object:
    """Return the firmware's Settings with the given values; None if the firmware has no settings.

    Raise BadSetting as `filled` does, or if values are given but the firmware has no settings.
    """
    kind = firmware.settings
    if not (inspect.isclass(kind) and is_dataclass(kind)):
        for name in given:
            raise BadSetting(f"firmware {firmware.name} takes no settings", name)
        return None
    return filled(kind, given, f"firmware {firmware.name}")


def filled(kind: type[T], given: dict[str, object], who: str) -> T:
    """Return an object of the class `kind` with the given values.

    Raise BadSetting for a wrong name or value, or if a setting without a default is missing.

    who: the owner of the settings, such as "firmware imu_hil", for messages.
    """
    try:
        return convert(kind, given)
    except BadTable as error:
        first = error.first
        name, *inside = map(str, first.place) if first.place else [""]
        if first.known is not None and not inside:
            raise BadSetting(f"{who} has no setting {name!r}; {did_you_mean(name, first.known)}", name) from None
        place = ".".join(inside) + ": " if any(not part.isdecimal() for part in inside) else ""
        raise BadSetting(f"{place}{complaint(first)}", name) from None


KEPT = 64
_shared: dict[tuple[type, str], object] = {}


def shared(kind: type[T], given: dict[str, object], who: str) -> T:
    """Return an object with the given values, and raise errors, as `filled` does.

    If `kind` is a frozen dataclass, the objects are cached: equal values return the same object again.
    """
    if not cast(Any, kind).__dataclass_params__.frozen:
        return filled(kind, given, who)
    key = kind, repr(given)
    made = _shared.get(key)
    if made is None:
        if len(_shared) >= KEPT:
            _shared.clear()
        made = _shared[key] = filled(kind, given, who)
    return cast(T, made)
