"""Loading of a program as a `Firmware`, and checks of the settings that a case gives it."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import is_dataclass
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar, cast

from msgspec import Struct

from ..core.convert import BadTable, convert, keys_of
from ..core.suggest import did_you_mean
from ..processor.error_origin import Misuse, defined_at, flaw_of
from ..processor.user_code import PASSES
from .case.error_text import complaint
from .firmware_files import is_shipped, module_of_file, shipped_module, shipped_names, why_not_loaded

if TYPE_CHECKING:
    from ..processor.dsp import Dsp

T = TypeVar("T")


class Firmware(Struct, frozen=True):
    """A program: its main function, and the dataclass of what a case may set, if it has one.

    replay: the settings that a replay may fill in from a capture, as the module names them in `REPLAY`.
    """

    name: str
    main: Callable[[Dsp, object], None]
    settings: object
    replay: tuple[str, ...] = ()


class BadFirmware(ValueError):
    """Error: a program cannot be loaded; one sentence."""


class BadSetting(ValueError):
    """Error: the firmware does not accept a setting. name: the name of the setting."""

    def __init__(self, what: str, name: str) -> None:
        super().__init__(what)
        self.name = name


def load_firmware(name: str) -> Firmware:
    """Return a program: a shipped one by its name, or a .py file by its path. BadFirmware if there is none."""
    if not name:
        raise BadFirmware("its unit runs no Python firmware, which this needs")
    return _loaded(name) if name.endswith(".py") else _loaded_once(name)


@lru_cache(maxsize=64)
def _loaded_once(name: str) -> Firmware:
    """Return a shipped program, whose module is imported once."""
    return _loaded(name)


def _loaded(name: str) -> Firmware:
    try:
        module = _file_module(Path(name)) if name.endswith(".py") else _shipped_module(name)
    except (*PASSES, BadFirmware):
        raise
    except BaseException as error:
        why = why_not_loaded(error, Path(name).parent)
        raise BadFirmware(f"firmware {name!r} cannot be loaded: {why}") from None
    if not callable(getattr(module, "main", None)):
        raise BadFirmware(f"firmware {name!r} has no function main(dsp, settings)")
    what = flaw_of(module.main, 2)
    if what:
        at = defined_at(module.main)
        raise BadFirmware(f"firmware {name!r}, {at}: main {what}; expected a plain function main(dsp, settings)")
    return Firmware(name, module.main, getattr(module, "Settings", None), _replay_settings(name, module))


def _replay_settings(name: str, module: ModuleType) -> tuple[str, ...]:
    """Return the names in a module's `REPLAY`. BadFirmware if they are no names of its settings."""
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
    """Call main. Misuse if it returns a value, which has no meaning."""
    came = firmware.main(dsp, settings)  # type: ignore[func-returns-value]
    if came is not None:
        raise Misuse(f"main, {defined_at(firmware.main)}, returned {came!r}; firmware returns nothing")


def _file_module(path: Path) -> ModuleType:
    if not path.is_file():
        what = f"{str(path)!r} is not a regular file" if path.exists() else f"there is no firmware file {str(path)!r}"
        raise BadFirmware(f"{what}; its path counts from the folder of the case")
    return module_of_file(path)


def _shipped_module(name: str) -> ModuleType:
    if not is_shipped(name):
        raise BadFirmware(f"there is no firmware {name!r}; {did_you_mean(name, shipped_names())}")
    return shipped_module(name)


def settings_for(firmware: Firmware, given: dict[str, object]) -> object:
    """Return the firmware's Settings, None if it takes none. Raise BadSetting with the name of a wrong setting."""
    kind = firmware.settings
    if not (inspect.isclass(kind) and is_dataclass(kind)):
        for name in given:
            raise BadSetting(f"firmware {firmware.name} takes no settings", name)
        return None
    return filled(kind, given, f"firmware {firmware.name}")


def filled(kind: type[T], given: dict[str, object], who: str) -> T:
    """Return a dataclass with the given values. Raise BadSetting with the name of a wrong one. who: for messages."""
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
    """Return the same as `filled`. A frozen dataclass is made once for all scenes with these values."""
    if not cast(Any, kind).__dataclass_params__.frozen:
        return filled(kind, given, who)
    key = kind, repr(given)
    made = _shared.get(key)
    if made is None:
        if len(_shared) >= KEPT:
            _shared.clear()
        made = _shared[key] = filled(kind, given, who)
    return cast(T, made)
