"""Compile C sources for the host into a shared library.

sources --gcc -O0, thread-sanitizer hooks--> objects --+--> library, register structures at absolute addresses
runtime.c --gcc, no hooks----------------------------'
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from msgspec import Struct

from ...core.input_files import note_input, note_inputs_of
from .register_layout import BYTES_A_WORD, COPIED, SYMBOLS

GCC = "gcc"
RUNTIME = Path(__file__).with_name("runtime.c")
HOOKS = (
    "-fsanitize=thread",
    "--param=tsan-distinguish-volatile=1",
    "-fsanitize-coverage=trace-pc",
    "-fstrict-volatile-bitfields",  # a write of a bit field begins with a load
)
KEYWORDS = ("-Dinterrupt=", "-D__interrupt=", "-Dcregister=", "-Dfar=", "-Dasm(text)=c28x_assembly(text)")
UNDEFINED = ("-fsanitize=undefined", "-fno-sanitize=alignment")
COMPLAINT = re.compile(r"(?m)^(.+?):(\d+):(?:\d+:)? (?:fatal )?error: (.+)$")
HEADER = re.compile(r"gcc says: ([^/\\]+): No such file or directory$")
MISSING = re.compile(r"undefined reference to [`']([^']+)'")
ENDING = ("exit", "_exit", "_Exit", "quick_exit", "abort", "__assert_fail")  # runtime.c replaces them
OWN_DECLARATIONS = "void c28x_assembly(const char *);"


class BadSources(ValueError):
    """C sources cannot be compiled for the host; the message is one sentence."""


class Sources(Struct, frozen=True):
    """The C sources of a program.

    folders: the folders of headers. defines: macros with their values.
    undefined: True to compile with UBSan, which reports undefined behaviour to stderr.
    """

    files: tuple[Path, ...]
    folders: tuple[Path, ...] = ()
    defines: tuple[tuple[str, str], ...] = ()
    undefined: bool = False


def compiled(sources: Sources, folder: Path) -> list[str]:
    """Compile the sources to objects in `folder`. Raise BadSources if gcc fails."""
    if shutil.which(GCC) is None:
        raise BadSources("gcc, which compiles C sources for the host, is not found; install it, or run an image")
    for file in sources.files:
        if not note_input(file).is_file():
            what = f"{str(file)!r} is not a regular file" if file.exists() else f"there is no source file {str(file)!r}"
            raise BadSources(f"{what}; its path counts from the folder of the case")
    own = folder / "c28x_assembly.h"
    own.write_text(OWN_DECLARATIONS + "\n", encoding="utf-8")
    flags = [*HOOKS, *KEYWORDS, "-include", str(own), *(UNDEFINED if sources.undefined else ())]
    flags += [f"-I{path}" for path in sources.folders]
    flags += [f"-D{name}={value}" for name, value in sources.defines]
    aliases = folder / "aliases"
    aliases.mkdir()
    flags.append(f"-I{aliases}")
    objects = []
    for number, file in enumerate(sources.files):
        objects.append(str(folder / f"{number}.o"))
        command = [
            GCC,
            "-std=gnu99",
            "-c",
            "-O0",
            "-gdwarf-5",
            "-w",
            "-fPIC",
            *flags,
            str(file),
            "-o",
            objects[-1],
            "-MMD",
        ]
        _compile(command, (file.parent, *sources.folders), aliases)
        rule = Path(objects[-1]).with_suffix(".d").read_text(encoding="utf-8", errors="surrogateescape")  # for make
        names = re.split(r"(?<!\\)\s+", rule.partition(":")[2].replace("\\\n", " "))
        note_inputs_of(Path(name.replace("\\ ", " ")) for name in names)
    runtime = str(folder / "runtime.o")
    _run([GCC, "-std=gnu11", "-c", "-O1", "-fPIC", "-w", str(RUNTIME), "-o", runtime])
    return [*objects, runtime]


def linked(objects: Sequence[str], undefined: bool, base: int, library: Path) -> Path:
    """Link the library. base: host address of the chip's word 0. Raise BadSources if something is missing."""
    places = [f"-Wl,--defsym={name}={base + BYTES_A_WORD * address:#x}" for name, address in SYMBOLS.items()]
    places += [f"-Wl,--defsym={name}=0" for name in COPIED]
    replaced = [f"-Wl,--wrap={name}" for name in ENDING]
    checked = ["-fsanitize=undefined"] if undefined else []
    listed = library.with_suffix(".list")
    listed.write_text(f"{{ {'; '.join(SYMBOLS)}; }};\n", encoding="utf-8")  # bound at load time, so they stay
    shared = ["-shared", f"-Wl,--dynamic-list={listed}", "-Wl,--no-relax", "-Wl,-z,defs", *replaced, *checked]
    _run([GCC, *shared, *places, *objects, "-o", str(library), "-lm"])
    return library


def _compile(command: Sequence[str], folders: Sequence[Path], aliases: Path) -> None:
    """Run gcc; a header whose name differs only in case (fine on Windows) gets an alias."""
    while True:
        try:
            _run(command)
            return
        except BadSources as error:
            missing = HEADER.search(str(error))
            name = "" if missing is None else missing[1]
            alias = aliases / name
            found = [path for one in folders for path in one.glob("*") if path.name.lower() == name.lower()]
            if not found or alias.exists():
                raise
            alias.symlink_to(found[0].resolve())


def _run(command: Sequence[str]) -> None:
    came = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if not came.returncode:
        return
    complaint = COMPLAINT.search(came.stderr)
    if complaint:
        raise BadSources(f"{complaint[1]}, line {complaint[2]}: gcc says: {complaint[3]}")
    missing = MISSING.search(came.stderr)
    if missing:
        raise BadSources(f"no source defines {missing[1]!r}; add the file that does to sources")
    last = (came.stderr.strip().splitlines() or ["nothing"])[-1]
    raise BadSources(f"gcc cannot compile the sources; it says: {last}")
