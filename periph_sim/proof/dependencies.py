"""Everything on which a saved coverage or proof depends: files, versions, and periph_sim itself.

    runs of a case --files_read--> the files that were opened --dependencies--> their digests
    their digests, later --differences--> phrases about what has changed, such as "slave.out has changed"

The files are those that this process opens, those that a C compiler includes, the source files of imported modules, and
the files that the case names. The compiler itself is not among the dependencies.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import source_from_cache
from pathlib import Path
from platform import python_version
from tempfile import gettempdir

from msgspec import Struct
from msgspec.structs import replace

from ..core.input_files import NOTED, TEMPORARY, read_regular

PACKAGE = Path(__file__).parents[1]
DIGEST = 16  # length of a digest, in bytes
PROJECT = "pyproject.toml"
SOURCES = (".asm", ".inc", ".h", ".c", ".out", ".toml")  # suffixes of files that a case names or sources include
_read: set[str] | None = None  # the files that were opened for reading; None while they are not collected
_hooks: list[object] = []  # the audit hook, which Python never removes
_installed = lru_cache(maxsize=1)(packages_distributions)  # cached, because a call takes about half a second


class Dependencies(Struct, frozen=True):
    """The dependencies of a result.

    python: the version of Python.
    periph_sim: one digest of all source files and data files of periph_sim.
    packages: the version of each other imported package, by its name.
    files: the digest of each file that was read, by its path relative to the folder of the case.
    shipped: the names of the source files that were read from periph_sim or libraries. A file of the same name beside
        the case would be read instead (`unread`).
    not_read: the files that `unread` returned when the result was saved.
    project: the path of the pyproject.toml that applies to the case; "" if there is none.
    """

    python: str
    periph_sim: str
    packages: dict[str, str]
    files: dict[str, str]
    shipped: tuple[str, ...] = ()
    not_read: tuple[str, ...] = ()
    project: str = ""

    def differences(self, folder: Path) -> list[str]:
        """Return a phrase for each dependency that has changed since. folder: the folder of the case."""
        found = [
            f"{path} has changed"
            for path, digest in self.files.items()
            if _digest_of(_in_folder(folder, path)) != digest
        ]
        found += [f"{path} is new" for path in self.unread(folder) if path not in self.not_read]
        project = project_file(folder)
        if project != self.project:
            found.append(
                f"{project} is now the project of the case" if project else "the case now has no pyproject.toml"
            )
        if self.periph_sim != package_digest():
            found.append("periph_sim itself has changed")
        now = {"Python": python_version()} | {name: _version(name) for name in self.packages}
        for name, there in ({"Python": self.python} | self.packages).items():
            if now[name] != there:
                found.append(f"it was made with {name} {there}, and this is {now[name] or 'not installed'}")
        return found

    def unread(self, folder: Path) -> list[str]:
        """Return the files that exist now, were not read, but could be read by a new run.

        Such a file has the name of a source that was read, and is in the folder of the case or of another source. For
        example, a new file `common.inc` beside the case would be included instead of that of periph_sim.
        """
        sources = [path for path in self.files if path.endswith(SOURCES)]
        names = {*self.shipped, *map(os.path.basename, sources)}
        paths = {os.path.join(one, name) for one in {"", *map(os.path.dirname, sources)} for name in names}
        return sorted(path for path in paths - self.files.keys() if _in_folder(folder, path).is_file())


def _in_folder(folder: Path, path: str) -> Path:
    """Return the path of a file, given its path relative to a folder.

    A `..` in `path` removes the name before it, also if this is the name of a symbolic link. The operating system would
    go to the parent folder of the link's target instead.
    """
    return Path(os.path.normpath(folder.absolute() / path))


def project_file(folder: Path) -> str:
    """Return the path of the nearest pyproject.toml, in a folder or above it, relative to the folder; "" for none."""
    for one in (folder.absolute(), *folder.absolute().parents):
        if (one / PROJECT).is_file():
            return Path(os.path.relpath(one / PROJECT, folder.absolute())).as_posix()
    return ""


@contextmanager
def files_read() -> Iterator[set[str]]:
    """Yield a set, to which the path of each file is added that this process opens for reading within the block.

    The files that a C compiler includes are added, too.
    """
    global _read
    if not _hooks:
        _hooks.append(_note)
        sys.addaudithook(_note)
    _read = set()
    try:
        yield _read
    finally:
        _read = None


def _note(event: str, arguments: tuple[object, ...]) -> None:
    """Add the file of an event to `_read`, if the event is about opening a file for reading. Python calls this."""
    if event == NOTED and _read is not None:
        _read.add(os.path.join(os.getcwd(), str(arguments[0])))
    elif event == "open" and _read is not None and isinstance(arguments[0], str | bytes):
        mode = arguments[1]
        if mode is None or (isinstance(mode, str) and "r" in mode):
            _read.add(os.path.join(os.getcwd(), os.fsdecode(arguments[0])))


def dependencies(folder: Path, paths: Iterable[str | Path]) -> Dependencies:
    """Return the dependencies of a result. Raise ValueError, with a sentence, for a file that cannot be read now.

    For Python and installed packages, the result has versions, not files. For periph_sim, it has one digest.

    folder: the folder of the case.
    paths: the files that the runs have read. The files of imported modules are added.
    """
    scripts = ("__main__", "__mp_main__")  # names of the module of the command periph-sim, which is no dependency
    modules = [module for name, module in tuple(sys.modules.items()) if name not in scripts]
    imported = (getattr(module, "__file__", None) for module in modules)
    files: dict[str, str] = {}
    shipped: set[str] = set()
    for path in sorted({_source(_path_of(one)) for one in [*paths, *imported] if isinstance(one, str | Path)}):
        if not os.path.isfile(path):
            continue
        if path.startswith(_libraries()):
            shipped.update({os.path.basename(path)} if path.endswith(SOURCES) else ())
            continue
        digest = _digest_of(Path(path))
        if not digest:
            raise ValueError(f"{path}: cannot be read again, so a change of it would not be noticed")
        files[Path(os.path.relpath(path, folder)).as_posix()] = digest
    names = {name for module in tuple(sys.modules) if "." not in module for name in _installed().get(module, ())}
    packages = {name: _version(name) for name in sorted(names) if name != "periph_sim" and name != "periph-sim"}
    versions = python_version(), package_digest(), packages
    found = Dependencies(*versions, files, tuple(sorted(shipped)), project=project_file(folder))
    return replace(found, not_read=tuple(found.unread(folder)))


def _path_of(path: str | Path) -> str:
    """Return the absolute path of a file, without `..` in it.

    A name and the `..` after it are removed together. If the name is that of a symbolic link, this can be the path of
    no file. In this case, all links are resolved instead.
    """
    text = os.path.abspath(path)
    return text if os.path.exists(text) or not os.path.exists(path) else os.path.realpath(path)


def _source(path: str) -> str:
    """Return the path of a module's source, given that of its compiled file. Return other paths unchanged."""
    if path.endswith(".pyc"):
        with suppress(ValueError):
            return source_from_cache(path)
    return path


@lru_cache(maxsize=1)
def _libraries() -> tuple[str, ...]:
    """Return the beginnings of the paths of files that are not dependencies: of Python, packages, and the system."""
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    paths = {sysconfig.get_path(name) for name in names} | {str(PACKAGE)}
    libraries = {os.path.join(form, "") for path in paths for form in (path, os.path.realpath(path))}
    compiled = os.path.join(gettempdir(), TEMPORARY)
    return (*libraries, compiled, "/proc/", "/sys/", "/dev/")


def _version(name: str) -> str:
    """Return the version of an installed package; "" if it is not installed."""
    try:
        return version(name)
    except (PackageNotFoundError, ValueError):  # ValueError: the name is empty
        return ""


def _digest_of(path: Path) -> str:
    """Return the digest of a file; "" if it cannot be read."""
    try:
        return blake2b(read_regular(path), digest_size=DIGEST).hexdigest()
    except OSError:
        return ""


@lru_cache(maxsize=1)
def package_digest() -> str:
    """Return the digest of the source files and data files of periph_sim, firmware included."""
    found = blake2b(digest_size=DIGEST)
    for folder, folders, files in os.walk(PACKAGE):
        folders[:] = sorted(name for name in folders if name not in ("compiled", "__pycache__"))
        for name in sorted(name for name in files if not name.endswith((".pyc", ".so", ".pyd"))):
            with open(os.path.join(folder, name), "rb") as file:
                found.update(os.path.relpath(folder, PACKAGE).encode() + name.encode() + b"\0" + file.read())
    return found.hexdigest()
