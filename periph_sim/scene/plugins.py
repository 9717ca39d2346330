"""Plugins: Python modules of users that define chips, devices and more. Cases can name them like shipped definitions.

    [tool.periph-sim] plugins = ["barometer.py"] --.
    entry points of the group `periph_sim` ---------+--> modules --by what they define--> chips, sensors, devices, ...

The attributes of a module decide what it defines (see `DEFINES`). A file is imported like a firmware file: in a package
of its own, with the files of the same folder that it imports. Entry points are searched only for a name that neither
periph_sim nor the project defines, and for all capture formats, because the search takes longer than many runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, lru_cache, partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from msgspec import Struct

from ..core.input_files import note_input
from ..devices.sensor_rounds import ChipData, known_sensors
from ..processor.user_code import UserCode
from .case.model import BadCase, Case
from .firmware_loader import imported, module_of_file
from .project import project_of

if TYPE_CHECKING:
    from ..devices.chips.register_chip import RegisterChip

T = TypeVar("T")
GROUP = "periph_sim"  # name of the group of entry points that are plugins
STALL_LIMIT = 10.0  # maximum CPU time of the import of a plugin, in seconds


class DefinitionKind(Struct, frozen=True):
    """A kind of definition in a plugin, such as a chip.

    what: a noun for the kind, for messages.
    named: a function that returns the definitions of this kind in a plugin, by name.
    """

    what: str
    named: Callable[[Plugin], Mapping[str, Any]]


class Plugin(Struct, frozen=True):
    """A module of a user. name: the name of its file without suffix, or of its entry point."""

    name: str
    module: ModuleType

    def place(self, attribute: str) -> str:
        """Return the place at which the module defines an attribute, such as "line 7 of barometer.py".

        If the line cannot be found, return the name of the file.
        """
        import ast

        file = Path(self.module.__file__ or self.name)
        for node in ast.parse(file.read_bytes()).body if file.suffix == ".py" else ():
            targets = getattr(node, "targets", [getattr(node, "target", node)])
            if attribute in {getattr(target, "id", getattr(target, "name", "")) for target in targets}:
                return f"line {node.lineno} of {file.name}"
        return file.name


# DEFINES maps an attribute of a plugin's module to the kind of definitions that a module with this attribute has.
DEFINES = {
    "CHIP": DefinitionKind("chip", lambda plugin: {plugin.name: _chip(plugin)}),
    "KIND": DefinitionKind("kind of watcher", lambda plugin: {plugin.module.KIND: plugin.module}),
    "MODELS": DefinitionKind("device", lambda plugin: dict.fromkeys(plugin.module.MODELS, plugin.module)),
    "NAME": DefinitionKind(
        "capture format", lambda plugin: {plugin.name: plugin.module} if hasattr(plugin.module, "SUFFIXES") else {}
    ),
    "SENSORS": DefinitionKind("sensor", lambda plugin: _sensors(plugin)),
    "attach": DefinitionKind("kind of fault", lambda plugin: {plugin.name: plugin.module}),
}


def known(folder: Path, attribute: str, shipped: Mapping[str, T], names: Iterable[str] = ()) -> Mapping[str, T]:
    """Return a dictionary from names to the definitions of one kind: shipped definitions and those of plugins.

    folder: the folder whose project names the plugins.
    attribute: the kind of definition, as a key of `DEFINES`.
    shipped: the definitions of periph_sim itself, by name.
    names: the names that a case uses. If any of them is unknown, the plugins of entry points are included.

    Raise BadCase if a plugin cannot be loaded, has a wrong definition, or defines a name that periph_sim or another
    plugin defines.
    """
    found: dict[str, Any] = dict(shipped)
    owners: dict[str, Plugin] = {}
    _add(found, owners, attribute, _project_plugins(folder))
    if any(name not in found for name in names):
        _add(found, owners, attribute, _installed_plugins())
    return found


def sensors_of(case: Case, names: Iterable[str] = ()) -> Mapping[str, ChipData]:
    """Return the sensors that the requests of a case can name, by name. names: the sensors that the requests name."""
    return known(case.folder, "SENSORS", known_sensors(), names)


def known_formats(shipped: Mapping[str, T], installed: bool) -> Mapping[str, T]:
    """Return a dictionary from names to capture formats: shipped formats and those of the current folder's project.

    installed: True to include the plugins of entry points.
    """
    return known(Path(), "NAME", shipped, [""] if installed else ())


def _add(found: dict[str, Any], owners: dict[str, Plugin], attribute: str, plugins: Iterable[Plugin]) -> None:
    """Add the definitions of plugins to `found`. owners: for each name added so far, the plugin that defines it."""
    kind = DEFINES[attribute]
    for plugin in plugins:
        for name, one in kind.named(plugin).items() if hasattr(plugin.module, attribute) else ():
            if name in found:
                there = owners[name].place(attribute) if name in owners else "periph_sim"
                what = f"there is a {kind.what} {name!r} already, in {there}"
                raise BadCase(f"{plugin.place(attribute)}: {what}; give one of them another name")
            found[name], owners[name] = one, plugin


def _chip(plugin: Plugin) -> type[RegisterChip]:
    from ..devices.chips.register_chip import RegisterChip

    found: object = plugin.module.CHIP
    if not (isinstance(found, type) and issubclass(found, RegisterChip)):
        raise BadCase(f"{plugin.place('CHIP')}: CHIP is {found!r}; expected a class derived from RegisterChip")
    lacking = [name for name in ("MAP", "SECTION", "ADDRESSES", "OPTIONS") if not hasattr(found, name)]
    if lacking:
        raise BadCase(f"{plugin.place('CHIP')}: class {found.__name__} has no {lacking[0]}; give it one")
    return found


def _sensors(plugin: Plugin) -> Mapping[str, ChipData]:
    found: object = plugin.module.SENSORS
    if isinstance(found, dict) and all(isinstance(one, ChipData) for one in found.values()):
        return found
    raise BadCase(
        f"{plugin.place('SENSORS')}: SENSORS is {found!r}; expected a dict of names and their ChipData "
        "(periph_sim.devices.sensor_rounds)"
    )


def _project_plugins(folder: Path) -> list[Plugin]:
    """Return the plugins in `[tool.periph-sim]` of the folder's project. Raise BadCase if a plugin cannot be loaded."""
    project = project_of(folder)
    found = []

    def mistake(what: str) -> BadCase:
        return BadCase(f"{project.where('plugins')}: {what}")

    for text in project.settings.plugins:
        path = project.folder / text
        if not path.is_file():
            raise mistake(f"there is no file {text!r}; its path counts from this file")
        stat = note_input(path).stat()
        load = partial(_module, path, stat.st_mtime_ns, stat.st_size)
        module = imported(text, load, path.parent, mistake)
        found.append(Plugin(path.stem, module))
    return found


@lru_cache(maxsize=64)
def _module(path: Path, changed: int, size: int) -> ModuleType:
    """Return the module of a file, from a cache.

    changed, size: modification time and size of the file. If they have changed, the file is imported again.
    """
    return UserCode(f"plugin {path.name}", STALL_LIMIT).in_time(module_of_file, path)


@cache
def _installed_plugins() -> tuple[Plugin, ...]:
    """Return the plugins that installed packages declare as entry points. Raise BadCase if one cannot be loaded."""
    from importlib.metadata import entry_points

    found = []
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        place = f"entry point {entry.name!r} of {GROUP}, {entry.value}"
        load = partial(UserCode(f"plugin {entry.name}", STALL_LIMIT).in_time, entry.load)
        module = imported(f"{place}: it", load, Path(), BadCase)
        found.append(Plugin(entry.name, module))
    return tuple(found)
