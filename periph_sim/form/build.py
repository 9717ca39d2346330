"""Compiles the core: Python sources and the .pxd files beside them go in; one library and a manifest come out.

python -m periph_sim.form.build

    core/kernel.py, core/kernel.pxd --Cython--> C --compiler--> objects/core.kernel.o --+--> compiled/core.SUFFIX
    core/wire.py, core/wire.pxd ------ ... -------------------> objects/core.wire.o ----+    compiled/manifest.json

Needs Cython (the extra `core`) and a C compiler. What is compiled: each module that has a .pxd file beside it, if its
object file is not in the last build already, made of the same.

One library instead of an extension module each: it is loaded once, and its functions lie sorted by name, so that those
that calculate are apart from what only Python calls, and an event goes through a fraction of the pages of memory.
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
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import redirect_stderr
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from subprocess import run

from . import BUILT, LIBRARY, MANIFEST, PACKAGE, digest, sources, symbol, usable
from .fold import declared, folded
from .freelists import with_freelists
from .functions import by_name, cimported, without_imports
from .members import with_members_bound
from .outcome import resultless, returning, telling

DIRECTIVES = {
    "annotation_typing": False,  # types are the .pxd's business: annotations are mypy's
    "infer_types": True,
    "cdivision": False,  # floor division, as Python's
    "boundscheck": True,
    "binding": False,
    "auto_pickle": False,
}
CLASS = re.compile(r"^cdef class (\w+)", re.MULTILINE)
CIMPORT = re.compile(r"^from (\.+)([\w.]*) cimport", re.MULTILINE)
NOTHING_TO_DO = "all modules are built already"
FLAGS = ("-c", "-O2", "-DNDEBUG", "-fPIC", "-fwrapv", "-fno-strict-aliasing", "-ffunction-sections", "-w")
# Code that leads to a traceback is cold: the compiler keeps it apart from the code of each event.
PROTOTYPE, COLD = re.compile(r"^static void __Pyx_AddTraceback\b", re.MULTILINE), r"__attribute__((cold)) \g<0>"
# Functions marked `# vectors` in a .pxd have a second body for wider vectors, which the CPU chooses as the library is
# loaded. A compiler that cannot make one, or is for another CPU, compiles them as any other.
MARKED = re.compile(r"^ *cp?def .*?(\w+)\([^()]*\).*# vectors$", re.MULTILINE)
WIDE = '-DPERIPH_SIM_VECTORS=__attribute__((target_clones("avx2","default")))'
SORTED = "-Wl,--sort-section=name"  # C functions of all modules first, then what wraps them for Python
OBJECTS = "objects"


class NoBuild(Exception):
    """The core cannot be compiled here; the message says what is missing, or what the compiler said."""


def modules_of(package: Path) -> list[str]:
    """The modules that have a .pxd file beside them."""
    return sorted(".".join(path.relative_to(package).with_suffix("").parts) for path in package.rglob("*.pxd"))


def compiler() -> str:
    """The C compiler's command. NoBuild if there is none, or no Cython."""
    if find_spec("Cython") is None:
        raise NoBuild("Cython is not installed; install the extra `core`: pip install 'periph-sim[core]'")
    name = os.environ.get("CC", "cc")
    if shutil.which(name.split()[0]) is None:
        raise NoBuild(f"there is no C compiler {name!r}; install one (gcc or clang), or name it in the variable CC")
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        raise NoBuild("Python.h is not installed; install Python's headers (the package python3-dev or the like)")
    return name


def jobs() -> int:
    """How many modules are compiled at a time: the variable JOBS, else as many as there are cores."""
    said = os.environ.get("JOBS") or str(os.cpu_count() or 1)
    if not said.isdecimal() or int(said) < 1:
        raise NoBuild(f"JOBS={said}: expected a number of modules to compile at a time, 1 or more")
    return int(said)


def shadow(package: Path, modules: list[str], folder: Path) -> None:
    """The sources as they are compiled, in `folder`: with their constants in place, and results that tell of errors."""
    for module in modules:
        names = vars(import_module(f"{package.name}.{module}"))
        source, types = sources(package, [module])
        pxd = types.read_text("utf-8")
        text = folded(source.read_text("utf-8"), names, CLASS.findall(pxd))
        text = returning(by_name(text, pxd), resultless(types_of(module, package).values()))
        text = with_members_bound(without_imports(text, cimported(pxd)), names)
        text = with_freelists(text, pxd)
        copy = folder / package.name / source.relative_to(package)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(text, "utf-8")
        copy.with_suffix(".pxd").write_text(telling(declared(text, pxd)), "utf-8")
    for room in [folder / package.name, *(path for path in (folder / package.name).rglob("*") if path.is_dir())]:
        (room / "__init__.py").touch()


def compile_one(module: str, package: str, cc: str) -> None:
    """One module, from its source to an object file in the present folder. NoBuild with what the compiler said."""
    c_file = generate(module, package)
    marked = MARKED.findall(Path(package, *module.split(".")).with_suffix(".pxd").read_text("utf-8"))
    text = PROTOTYPE.sub(COLD, c_file.read_text("utf-8"), count=1)
    c_file.write_text(with_vectors(text, marked), "utf-8")
    begins = f"-DPyInit_{module.split('.')[-1]}=PyInit_{symbol(f'{package}.{module}')}"
    command = [*cc.split(), *FLAGS, begins, f"-I{sysconfig.get_path('include')}", str(c_file), "-o", f"{module}.o"]
    for more in ([WIDE], ["-DPERIPH_SIM_VECTORS="])[not marked :]:
        done = run([*command, *more], capture_output=True, text=True, check=False)
        if not done.returncode:
            c_file.unlink()
            return
    raise NoBuild(f"{module} does not compile; {command[0]} says:\n{done.stderr or done.stdout}")


def with_vectors(c_text: str, functions: list[str]) -> str:
    """The C file with PERIPH_SIM_VECTORS at the definitions of these functions."""
    for function in functions:
        define = re.compile(rf"^static (?=[^\n]*__pyx_f_\w*_{function}\([^\n]*\) {{$)", re.MULTILINE)
        c_text, found = define.subn("PERIPH_SIM_VECTORS static ", c_text)
        if found != 1:
            raise NoBuild(f"{function!r} is marked '# vectors', and is defined {found} times in C; expected once")
    return c_text


def generate(module: str, package: str) -> Path:
    """The C file of a module, in the present folder. NoBuild with what Cython said.

    In this process: it takes Cython as long to start as to compile a module of usual length.
    """
    cython = import_module("Cython.Compiler.Main")
    c_file = Path(f"{module}.c")
    options = cython.CompilationOptions(
        output_file=str(c_file),
        module_name=f"{package}.{module}",
        language_level=3,
        compiler_directives=dict(DIRECTIVES),
    )
    with redirect_stderr(StringIO()) as said:
        result = cython.compile(str(Path(package, *module.split(".")).with_suffix(".py")), options)
    if result.num_errors:
        raise NoBuild(f"{module} does not compile; Cython says:\n{said.getvalue()}")
    return c_file


def link(modules: list[str], folder: Path, cc: str) -> None:
    """All object files in `folder` to one library. NoBuild with what the linker said."""
    command = [*cc.split(), "-shared", *(f"{module}.o" for module in modules), "-o", LIBRARY]
    for more in ([SORTED], []):  # a linker that does not know the option can do without
        done = run([*command, *more], cwd=folder, capture_output=True, text=True, check=False)
        if not done.returncode:
            return
    raise NoBuild(f"the compiled modules do not link; {command[0]} says:\n{done.stderr or done.stdout}")


def types_of(module: str, folder: Path) -> dict[str, str]:
    """The .pxd files in `folder` that this module's depends on, its own included, by module."""
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        one = waiting.pop()
        if one not in found:
            found[one] = folder.joinpath(*one.split(".")).with_suffix(".pxd").read_text("utf-8")
            for dots, name in CIMPORT.findall(found[one]):
                waiting.append(".".join([*one.split(".")[: -len(dots)], name]))
    return found


def fingerprint(module: str, folder: Path, cc: str) -> str:
    """Equal for equal object files. folder: the package as it is compiled."""
    source = folder.joinpath(*module.split(".")).with_suffix(".py").read_text("utf-8")
    types = sorted(types_of(module, folder).items())
    made_of = [source, types, DIRECTIVES, FLAGS, COLD, version("cython"), cc, sys.version]
    if MARKED.search(dict(types)[module]):
        made_of.append(WIDE)
    return hashlib.sha256(json.dumps(made_of).encode()).hexdigest()


def last_build(built: Path) -> dict[str, str]:
    """The object files of the build that is there, by module, each with its fingerprint."""
    try:
        found = json.loads((built / MANIFEST).read_text("utf-8"))["modules"]
        return {module: made_of for module, made_of in found.items() if (built / OBJECTS / f"{module}.o").is_file()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}


def build(package: Path, built: Path, jobs: int) -> None:
    """Compile what has a .pxd file; `built` is replaced only when all of it is done, and left alone if it may run."""
    cc, modules, last = compiler(), modules_of(package), last_build(built)
    made_of = digest(package, modules)
    if usable(package, built)[0] == modules:
        print(NOTHING_TO_DO, flush=True)
        return
    with tempfile.TemporaryDirectory() as name, ProcessPoolExecutor(jobs, None, os.chdir, (name,)) as pool:
        folder = Path(name)
        shadow(package, modules, folder)
        prints = {module: fingerprint(module, folder / package.name, cc) for module in modules}
        anew = [module for module in modules if last.get(module) != prints[module]]
        for module in set(modules).difference(anew):
            shutil.copy(built / OBJECTS / f"{module}.o", folder)
        done = [pool.submit(compile_one, module, package.name, cc) for module in anew]
        for number, (module, one) in enumerate(zip(anew, done, strict=True), 1):
            try:
                one.result()
            except NoBuild:
                pool.shutdown(cancel_futures=True)
                raise
            print(f"{number}/{len(anew)} {module}", flush=True)
        if not anew:
            print(NOTHING_TO_DO, flush=True)
        link(modules, folder, cc)
        size = (folder / LIBRARY).stat().st_size
        (folder / MANIFEST).write_text(json.dumps({"digest": made_of, "size": size, "modules": prints}), "utf-8")
        shutil.rmtree(built, ignore_errors=True)
        (built / OBJECTS).mkdir(parents=True)
        for module in modules:
            shutil.copy(folder / f"{module}.o", built / OBJECTS)
        for name in (LIBRARY, MANIFEST):
            shutil.copy(folder / name, built)


def main() -> int:
    """Exit status: 0, or 1 where the core cannot be compiled; then runs are interpreted, as before."""
    try:
        build(PACKAGE, BUILT, jobs())
    except (NoBuild, OSError, BrokenExecutor) as why:  # the last: a process was killed, as where memory is short
        print(f"the core stays interpreted: {why}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
