"""Compilation of the core: one library and a manifest from the Python sources marked `# core: compiled`.

python -m periph_sim.form.build [--hard] [PREFIX ...]

    core/kernel.py --declarations--> kernel.pxd --Cython--> C --compiler--> core.kernel.o --+--> compiled/core.SUFFIX
    core/wire.py --- ... ------------------------------------------------> core.wire.o ----+    compiled/manifest.json

The build needs Cython (the extra `core`) and a C compiler. It compiles each module with the line `# core: compiled`,
unless the last build has an object file that was made from the same source, declarations and options. With prefixes
("core", "f28335.i2c") it compiles only the modules whose names begin with one of them, and the modules they need.

--hard makes a separate build for tests, which stops at the first fault (see `HARD`). `python -m tests.hard` runs the
tests with it.

All modules are in one library, so that it is loaded once and the linker can sort the functions of all modules by name.
Sorting separates the C functions from the wrappers that only Python calls. The code that events run is then in few
pages of memory.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import redirect_stderr
from functools import cache
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from subprocess import run
from typing import NamedTuple

from . import BUILT, HARD_BUILT, LIBRARY, MANIFEST, PACKAGE, digest, source_of, stamps, symbol, usable
from .c_checks import CHECK, REFUSAL, arrays_of, never_none, with_index_checks, with_none_refused
from .compiled_class import BadDeclaration
from .declarations import declarations, used_by
from .directives import disobeyed
from .source_copy import declared, prepared, with_constants
from .sources import UNCHECKED, Sources, header_of

DIRECTIVES = {
    "annotation_typing": False,  # Cython takes types from the .pxd file instead of annotations
    "infer_types": True,
    "cdivision": False,  # integer division rounds down, as in Python
    "boundscheck": True,
    "binding": False,
    "auto_pickle": False,
    "allow_none_for_extension_args": False,  # None from Python for a typed argument raises TypeError
    "nonecheck": True,  # access to an attribute of None raises AttributeError, as in Python
}
# With `trashcan`, Python frees a long linked list of objects in a loop instead of by recursion.
# Cython documents `trashcan` only for single classes. `generate` adds it to the options, so it applies to all classes.
FOR_ALL_CLASSES = {"trashcan": True}
NEVER_NONE = "self"  # this argument is never None, because its caller has already checked the object
NOTHING_TO_DO = "all modules are built already"
# Functions begin at cache lines. Code inside functions is not aligned, so that an event's code is in few cache lines.
DENSE = ("-falign-functions=64", "-fno-align-jumps", "-fno-align-loops", "-fno-align-labels")
FLAGS = ("-c", "-O2", *DENSE, "-DNDEBUG", "-fPIC", "-fwrapv", "-fno-strict-aliasing", "-ffunction-sections", "-w")
SANITIZERS = "-fsanitize=address,undefined"  # `c_checks` checks the array indices that sanitizers miss


class BuildSettings(NamedTuple):
    """Settings of a build.

    directives: Cython directives that are added to DIRECTIVES or replace entries of DIRECTIVES.
    flags: flags of the C compiler. "{folder}" is replaced by the folder in which the compiler runs.
    link: flags of the linker.
    """

    directives: dict[str, bool]
    flags: tuple[str, ...]
    link: tuple[str, ...] = ()


NORMAL = BuildSettings({}, FLAGS)
# In a build with the settings HARD, every fault raises an exception or ends the process.
# Cython's code checks for None and for overflows. The sanitizers check for bad addresses and undefined behaviour of C.
# The flags `-fwrapv`, `-DNDEBUG` and `-w` are left out, because they would hide faults.
# `asan-stack=0` turns off the address sanitizer's checks of the stack, because greenlets copy their stacks.
HARD = BuildSettings(
    {"nonecheck": True, "overflowcheck": True},
    (
        *("-c", "-O0", "-g1", "-fPIC", "-fno-strict-aliasing", "-ffunction-sections", "-fno-omit-frame-pointer"),
        *(SANITIZERS, "-fno-sanitize-recover=all", "--param", "asan-stack=0", "-Werror"),
    ),
    (SANITIZERS,),
)
# The function that builds tracebacks becomes `cold`. The compiler then separates error handling from other code.
PROTOTYPE, COLD = re.compile(r"^static void __Pyx_AddTraceback\b", re.MULTILINE), r"__attribute__((cold)) \g<0>"
# PASSED_ON matches C code in which a C method is converted to a Python object, for example to be used as a callback.
PASSED_ON = re.compile(r"__Pyx_CFunc_\w+_to_py_\w*\([^;\n]*->(?:__pyx_base\.)*(\w+)\);")
SORTED = "-Wl,--sort-section=name"  # places the C functions of all modules before their Python wrappers
OBJECTS = "objects"


class NoBuild(Exception):
    """The core was not compiled. The message says why: what is missing or invalid, or what the compiler printed."""


def compiler() -> str:
    """Return the command of the C compiler. Raise NoBuild if the compiler, Cython or Python.h is missing."""
    if find_spec("Cython") is None:
        raise NoBuild("Cython is not installed; install the extra `core`: pip install 'periph-sim[core]'")
    name = os.environ.get("CC", "cc")
    if shutil.which(name.split()[0]) is None:
        raise NoBuild(f"there is no C compiler {name!r}; install one (gcc or clang), or name it in the variable CC")
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        raise NoBuild("Python.h is not installed; install Python's headers (the package python3-dev or the like)")
    return name


def jobs() -> int:
    """Return the number of parallel compilations: the variable JOBS, or else the number of cores.

    Raise NoBuild if JOBS is invalid.
    """
    said = os.environ.get("JOBS") or str(os.cpu_count() or 1)
    if not said.isdecimal() or int(said) < 1:
        raise NoBuild(f"JOBS={said}: expected a number of modules to compile at a time, 1 or more")
    return int(said)


def shadow(package: Path, sources: Sources, modules: Sequence[str], folder: Path) -> None:
    """Write the prepared sources that Cython compiles, and their .pxd files, into `folder`."""
    for module in modules:
        names = vars(import_module(f"{package.name}.{module}"))
        text = with_constants(prepared(sources[module]), names)
        copy = source_of(folder / package.name, module)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(text, "utf-8")
        copy.with_suffix(".pxd").write_text(declared(text, declarations(sources[module]).text), "utf-8")
    for room in [folder / package.name, *(path for path in (folder / package.name).rglob("*") if path.is_dir())]:
        (room / "__init__.py").touch()


def compile_one(
    module: str,
    used: Iterable[str],
    package: str,
    cc: str,
    kind: BuildSettings = NORMAL,
    always_set: Sequence[tuple[str, str]] = (),
) -> None:
    """Compile one module to an object file in the current directory.

    used: the module and all modules whose types it uses.
    always_set: pairs (class, attribute) of attributes whose setters must reject None.

    Raise NoBuild with the output of Cython or of the compiler if it fails, or if the C code does not pass
    `require_directives` or the checks of `c_checks` cannot be added to it.
    """
    c_file = generate(module, package, kind)
    require_directives(pxd_of(module, Path(package)), c_file)
    text = PROTOTYPE.sub(COLD, c_file.read_text("utf-8"), count=1)
    try:
        text = with_none_refused(text, always_set)
        text = with_index_checks(text, arrays_of(pxd_of(one, Path(package)) for one in used))
    except ValueError as why:
        raise NoBuild(f"{module} does not compile; {why}") from None
    c_file.write_text(text, "utf-8")
    begins = f"-DPyInit_{module.split('.')[-1]}=PyInit_{symbol(f'{package}.{module}')}"
    flags = [flag.format(folder=Path.cwd()) for flag in kind.flags]
    command = [*cc.split(), *flags, begins, f"-I{sysconfig.get_path('include')}", str(c_file), "-o", f"{module}.o"]
    done = run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NoBuild(f"{module} does not compile; {command[0]} says:\n{done.stderr or done.stdout}")
    c_file.unlink()


def require_directives(pxd: str, c_file: Path) -> None:
    """Raise NoBuild if the C code ignores a directive of the .pxd file, or converts a C method to a Python object."""
    text = c_file.read_text("utf-8")
    if passed_on := PASSED_ON.search(text):
        method = f"{c_file.stem}.py passes on the typed method {passed_on[1]}"
        raise NoBuild(f"{method}, which Cython calls with one argument less; pass on a function that calls it")
    if found := list(disobeyed(pxd, text)):
        raise NoBuild(f"{c_file.stem}.pxd: {'; '.join(found)}; write it where Cython {version('cython')} obeys it")


def generate(module: str, package: str, kind: BuildSettings = NORMAL) -> Path:
    """Write the C file of a module into the current directory, and return its path.

    Cython runs in this process, because starting another process takes as long as compiling a typical module.

    Raise NoBuild with Cython's output if Cython fails.
    """
    leave_out_checks_of_self()
    cython = import_module("Cython.Compiler.Main")
    c_file, source = Path(f"{module}.c"), source_of(Path(package), module)
    options = cython.CompilationOptions(
        output_file=str(c_file),
        module_name=f"{package}.{module}",
        language_level=3,
        compiler_directives=directives(source.read_text("utf-8"), kind),
    )
    options.compiler_directives.update(FOR_ALL_CLASSES)
    with redirect_stderr(StringIO()) as said:
        result = cython.compile_single(str(source), options, None)
    if result.num_errors:
        raise NoBuild(f"{module} does not compile; Cython says:\n{said.getvalue()}")
    return c_file


def directives(text: str, kind: BuildSettings = NORMAL) -> dict[str, bool]:
    """Return Cython's directives for a module. text: the source of the module."""
    return {**DIRECTIVES, "nonecheck": header_of(text) != UNCHECKED, **kind.directives}


@cache
def leave_out_checks_of_self() -> None:
    """Patch Cython so that it does not check whether `self` is None at each access to an attribute."""
    nodes = import_module("Cython.Compiler.ExprNodes")
    usual = nodes.NameNode.may_be_none
    nodes.NameNode.may_be_none = lambda node: not (node.name == NEVER_NONE and node.entry.is_arg) and usual(node)


def link(modules: list[str], folder: Path, cc: str, kind: BuildSettings = NORMAL) -> None:
    """Link the object files in `folder` to one library. Raise NoBuild with the linker's output if linking fails."""
    names = ("-undefined", "dynamic_lookup") if sys.platform == "darwin" else ()  # finds Python's symbols at load time
    command = [*cc.split(), "-shared", *names, *kind.link, *(f"{module}.o" for module in modules), "-o", LIBRARY]
    for more in ([SORTED], []):  # the second attempt is for linkers that do not support SORTED
        done = run([*command, *more], cwd=folder, capture_output=True, text=True, check=False)
        if not done.returncode:
            return
    raise NoBuild(f"the compiled modules do not link; {command[0]} says:\n{done.stderr or done.stdout}")


def pxd_of(module: str, folder: Path) -> str:
    """Return the text of a module's .pxd file. folder: the folder of the prepared sources and their .pxd files."""
    return source_of(folder, module).with_suffix(".pxd").read_text("utf-8")


def fingerprint(
    module: str, used: Iterable[str], folder: Path, cc: str, kind: BuildSettings, always_set: Sequence[tuple[str, str]]
) -> str:
    """Return a digest of everything that determines a module's object file: source, declarations, options and tools.

    used: the module and all modules whose types it uses. folder: the folder of the prepared sources.
    """
    source = source_of(folder, module).read_text("utf-8")
    made_of = [
        source,
        [(one, pxd_of(one, folder)) for one in sorted(used)],
        directives(source, kind),
        NEVER_NONE,
        (REFUSAL, always_set),
        FOR_ALL_CLASSES,
        kind.flags,
        COLD,
        CHECK,
        version("cython"),
        cc,
        sys.version,
    ]
    return hashlib.sha256(json.dumps(made_of).encode()).hexdigest()


def last_build(built: Path) -> dict[str, str]:
    """Return the fingerprints of the object files in the existing build, by the names of their modules."""
    try:
        found = json.loads((built / MANIFEST).read_text("utf-8"))["modules"]
        return {module: made_of for module, made_of in found.items() if (built / OBJECTS / f"{module}.o").is_file()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}


def needed(prefixes: Sequence[str], sources: Sources) -> list[str]:
    """Return the compiled modules whose names begin with one of the prefixes, and the modules whose types they use.

    Without prefixes, return all compiled modules. Raise NoBuild if no name begins with any of the prefixes.
    """
    found = sources.compiled()
    chosen = [one for one in found if any(f"{one}.".startswith(f"{prefix}.") for prefix in prefixes)]
    if prefixes and not chosen:
        raise NoBuild(f"no compiled module's name begins with {' or '.join(map(repr, prefixes))}")
    return sorted({more for one in chosen for more in used_by(sources, one)}) if prefixes else found


def note_stamps(built: Path, written: list[list[int]]) -> None:
    """Update the sources' sizes and times in the manifest, because a source may be saved again with equal content."""
    manifest = json.loads((built / MANIFEST).read_text("utf-8"))
    if manifest["stamps"] != written:
        anew = built / f"{MANIFEST}.new"
        anew.write_text(json.dumps({**manifest, "stamps": written}), "utf-8")
        anew.replace(built / MANIFEST)


def build(
    package: Path,
    built: Path,
    jobs: int,
    kind: BuildSettings = NORMAL,
    prefixes: Sequence[str] = (),
    *,
    keep: bool = True,
) -> None:
    """Compile the modules that `prefixes` select. If all succeed, replace the build in the folder `built`.

    keep: True to compile nothing if the folder has a build of the same modules that matches the sources.
    """
    sources = Sources(package)
    cc, modules, last = compiler(), needed(prefixes, sources), last_build(built)
    written, made_of = stamps(package, modules), digest(package, modules)
    if keep and usable(package, built)[0] == modules:
        note_stamps(built, written)
        print(NOTHING_TO_DO, flush=True)
        return
    with tempfile.TemporaryDirectory() as name, ProcessPoolExecutor(jobs, None, os.chdir, (name,)) as pool:
        folder = Path(name)
        shadow(package, sources, modules, folder)
        copied = folder / package.name
        used = {module: used_by(sources, module) for module in modules}
        always_set = {module: never_none(sources[module]) for module in modules}
        prints = {one: fingerprint(one, used[one], copied, cc, kind, always_set[one]) for one in modules}
        anew = [module for module in modules if last.get(module) != prints[module]]
        for module in set(modules).difference(anew):
            shutil.copy(built / OBJECTS / f"{module}.o", folder)
        done = [pool.submit(compile_one, one, used[one], package.name, cc, kind, always_set[one]) for one in anew]
        for number, (module, one) in enumerate(zip(anew, done, strict=True), 1):
            try:
                one.result()
            except (NoBuild, KeyboardInterrupt):
                pool.shutdown(cancel_futures=True)
                raise
            print(f"{number}/{len(anew)} {module}", flush=True)
        if not anew:
            print(NOTHING_TO_DO, flush=True)
        link(modules, folder, cc, kind)
        size = (folder / LIBRARY).stat().st_size
        manifest = {"digest": made_of, "stamps": written, "size": size, "modules": prints}
        (folder / MANIFEST).write_text(json.dumps(manifest), "utf-8")
        shutil.rmtree(built, ignore_errors=True)
        (built / OBJECTS).mkdir(parents=True)
        for module in modules:
            shutil.copy(folder / f"{module}.o", built / OBJECTS)
        for name in (LIBRARY, MANIFEST):
            shutil.copy(folder / name, built)


def main(options: Sequence[str] = ()) -> int:
    """Build the core. Return the exit status: 0, also if no module had to be compiled, or 1 if the build failed."""
    prefixes, hard = [one for one in options if one != "--hard"], "--hard" in options
    built, kind = (HARD_BUILT, HARD) if hard else (BUILT, NORMAL)
    return status_of(lambda: build(PACKAGE, built, jobs(), kind, prefixes), "the core stays interpreted")


def status_of(builds: Callable[[], None], failed: str) -> int:
    """Call a function that builds the core. Return the exit status: 0, or 1 if it fails.

    failed: the beginning of the message for a failure.
    """
    try:
        builds()
    except (
        NoBuild,
        BadDeclaration,
        OSError,
        BrokenExecutor,
    ) as why:  # BrokenExecutor: a worker process was killed, for example for lack of memory
        print(f"{failed}: {why}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped: the build is left as it was", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
