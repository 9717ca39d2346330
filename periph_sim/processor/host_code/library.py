"""A library of C sources that gcc compiles for the host, and that runs in this process.

sources --gcc -O0, thread-sanitizer hooks--> objects --+--> library, register structures at absolute addresses
runtime.c --gcc, no hooks----------------------------'

SIGINT (Ctrl-C) needs care while C code runs. Python calls the handler of a signal at the start of the next Python
function, which may be one that C code calls. An exception of the handler is then raised before the `try` of that
function, and ctypes would print and drop the exception. So a SIGINT that comes while C code runs is stored, and
`leave_c` calls the handler, which raises KeyboardInterrupt by default.
"""

from __future__ import annotations

import ctypes
import re
import shutil
import signal
import subprocess
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from threading import current_thread, main_thread
from types import FrameType

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection
from msgspec import Struct

from ...core.input_files import note_input, note_inputs_of
from ..image_files.debug_info import DebugInfo
from ..image_files.model import Image
from .register_layout import BYTES_A_WORD, COPIED, LARGEST, SYMBOLS

BYTES = 0x4_0000  # bytes of the host's memory for registers, 4 for each of 2 ** 16 words
READ, ANNOUNCED, WRITE, TOUCHED, TIME, ASSEMBLY, DELAY, ENDS = range(8)  # kinds of requests of runtime.c
UNWINDS, NO_PLACE, PROTECTED = -1, 0, 1  # replies to a request; a larger reply is the number of a place to write
ENDED, UNWOUND, FAULT, LOOPS = range(4)  # how a C function ended; LOOPS: it is in an endless empty loop

RequestHandler = Callable[[int, int, int, int, int, int], int]
REQUEST_HANDLER = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_int,
    ctypes.c_uint32,
    ctypes.c_uint32,
    ctypes.c_uint64,
    ctypes.c_uint64,
    ctypes.c_uint64,
)


class Library:
    """A compiled library of C firmware, loaded into this process.

    memory: the bytes of register memory.
    """

    def __init__(self, path: Path, base: int, on_request: RequestHandler, blocks_at_once: int) -> None:
        """path: the file, which no other object has loaded. base: the host address of the chip's word 0.

        on_request: called for each request of runtime.c, with the parameters of `Run._on_request`.
        blocks_at_once: the number of basic blocks between requests.
        """
        self._path = path
        self._library = ctypes.CDLL(str(path))
        self._on_request = REQUEST_HANDLER(on_request)  # the reference keeps the object alive while C code can call it
        self._library.c28x_begin.argtypes = (ctypes.c_uint64, REQUEST_HANDLER, ctypes.c_uint64)
        self._library.c28x_run.argtypes = (ctypes.c_void_p,)
        if self._library.c28x_begin(base, self._on_request, blocks_at_once):
            raise OSError(f"the host cannot map registers at {base:#x}")
        self.memory = memoryview((ctypes.c_ubyte * BYTES).from_address(base)).cast("B")
        self._numbers = (ctypes.c_int * (BYTES * (LARGEST + 1))).in_dll(self._library, "c28x_numbers")

    def write_as_announced(self, at: int, size: int, place: int) -> None:
        """Make runtime.c treat each later write announced for these bytes as a write of the place with this number.

        Announcements of such writes then make no request.
        """
        self._numbers[at * (LARGEST + 1) + size] = place

    def answer(self, log: array[int]) -> ctypes.c_uint64:
        """Let runtime.c answer reads and requests for time from a log, as long as they equal the items of the log.

        runtime.c answers only while at least three items are left. So Python always handles the last item, the
        computation during which the log ends. Return the variable of runtime.c that has the index of the next item.
        """
        ctypes.c_uint64.in_dll(self._library, "c28x_log").value = log.buffer_info()[0]
        ctypes.c_uint64.in_dll(self._library, "c28x_log_end").value = max(len(log) - 1, 0)
        return ctypes.c_uint64.in_dll(self._library, "c28x_log_next")

    def run(self, address: int) -> int:
        """Call the function at a host address. Return how it ended: ENDED, UNWOUND, FAULT or LOOPS."""
        how: int = self._library.c28x_run(address)
        return how

    def fault(self) -> tuple[int, int, int]:
        """Return (signal, address of the access, address of the instruction) of a FAULT; unknown addresses are 0."""
        number = ctypes.c_int.in_dll(self._library, "c28x_signal").value
        at, pc = (ctypes.c_uint64.in_dll(self._library, f"c28x_fault_{name}").value for name in ("at", "pc"))
        return number, at, pc

    def address_of(self, name: str) -> int | None:
        """Return the host address of a function; None if no function has this name."""
        found = self._functions.get(name)
        return None if found is None else self.loaded_at + found

    def place_of(self, address: int) -> tuple[str, str, int]:
        """Return (function, file, line) of an instruction at a host address; unknown parts are "" and 0."""
        at = address - self.loaded_at
        file, line = self._debug.line_at(at) or ("", 0)
        by_address = self._by_address
        place = bisect_right(by_address, (at, "\uffff")) - 1
        return by_address[place][1] if place >= 0 else "", file, line

    def close(self, last: bool) -> None:
        """Free the memory for registers. The library stays loaded until the process ends.

        last: True if no other library runs.
        """
        self._library.c28x_end(int(last))

    # Addresses ----------------------------------------------------------------------

    @cached_property
    def loaded_at(self) -> int:
        runs = ctypes.cast(self._library.c28x_run, ctypes.c_void_p).value
        assert runs is not None
        return runs - self._functions["c28x_run"]

    @cached_property
    def _functions(self) -> dict[str, int]:
        with self._path.open("rb") as file:
            table = ELFFile(file).get_section_by_name(".symtab")
            assert isinstance(table, SymbolTableSection)
            return {
                symbol.name: symbol["st_value"]
                for symbol in table.iter_symbols()
                if symbol["st_info"]["type"] == "STT_FUNC" and symbol["st_shndx"] != "SHN_UNDEF"
            }

    @cached_property
    def _by_address(self) -> list[tuple[int, str]]:
        return sorted((address, name) for name, address in self._functions.items())

    @cached_property
    def _debug(self) -> DebugInfo:
        with self._path.open("rb") as file:
            sections = [one for one in ELFFile(file).iter_sections() if one.name.startswith(".debug")]
            return DebugInfo(Image("ELF", 0, (), debug={one.name: one.data() for one in sections}))


def contents_of(library: Path) -> bytes:
    """Return the code and initial data of a library, without debug information."""
    with library.open("rb") as file:
        sections = [one for one in ELFFile(file).iter_sections() if one["sh_flags"] & SH_FLAGS.SHF_ALLOC]
        return b"".join(one.data() for one in sections if one["sh_type"] == "SHT_PROGBITS")


_in_c = _kept = False
_programs = 0  # number of active `kept_in_c` blocks
_before: Callable[[int, FrameType | None], object] = signal.default_int_handler


def enter_c() -> None:
    """Mark that C code runs."""
    global _in_c
    _in_c = True


def leave_c() -> None:
    """Mark that Python code runs. If SIGINT came while C code ran, call its handler; see the head of this file."""
    global _in_c, _kept
    _in_c = False
    if _kept:
        _kept = False
        _before(signal.SIGINT, None)


@contextmanager
def kept_in_c() -> Iterator[None]:
    """Within the block, defer a SIGINT that comes while C code runs.

    Do nothing outside of the main thread, or if SIGINT has no handler in Python.
    """
    global _programs, _before
    before = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or not callable(before):
        yield
        return
    if not _programs:
        _before = before
        signal.signal(signal.SIGINT, _handle)
    _programs += 1
    try:
        yield
    finally:
        _programs -= 1
        if not _programs:
            signal.signal(signal.SIGINT, _before)


def _handle(number: int, frame: FrameType | None) -> None:
    global _kept
    if _in_c:
        _kept = True
    else:
        _before(number, frame)


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
ABSENT = ": No such file or directory"
HEADER = re.compile(rf"gcc says: ([^/\\]+){ABSENT}$")
TWICE = re.compile(r"(?m)^(\S+?):\d+: multiple definition of [`']([^']+)'; \S+?:(\S+?):\d+: first defined")
MISSING = re.compile(r"undefined reference to [`']([^']+)'")
ENDING = ("exit", "_exit", "_Exit", "quick_exit", "abort", "__assert_fail")  # functions that runtime.c replaces
OWN_DECLARATIONS = "void c28x_assembly(const char *);"


class BadSources(ValueError):
    """Raised if C sources cannot be compiled for the host. The message is one sentence."""


class Sources(Struct, frozen=True):
    """The C sources of a program.

    files: the source files.
    folders: the folders of headers.
    defines: (name, value) of each macro.
    undefined: True to compile with UBSan, which reports undefined behaviour to stderr.
    """

    files: tuple[Path, ...]
    folders: tuple[Path, ...] = ()
    defines: tuple[tuple[str, str], ...] = ()
    undefined: bool = False


def compiled(sources: Sources, folder: Path) -> list[str]:
    """Compile the sources and runtime.c to objects in `folder`, and return the paths of the objects.

    Raise BadSources if gcc or a source file is missing, or if gcc fails.
    """
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
        # gcc -MMD writes a rule for make, which lists the headers.
        rule = Path(objects[-1]).with_suffix(".d").read_text(encoding="utf-8", errors="surrogateescape")
        names = re.split(r"(?<!\\)\s+", rule.partition(":")[2].replace("\\\n", " "))
        note_inputs_of(Path(name.replace("\\ ", " ")) for name in names)
    return [*objects, str(_make_runtime(folder))]


def _make_runtime(folder: Path) -> Path:
    """Write the object file of runtime.c to `folder`, and return its path. gcc is called once in each process."""
    global _runtime
    runtime = folder / "runtime.o"
    if _runtime is None:
        _run([GCC, "-std=gnu11", "-c", "-O1", "-fPIC", "-w", str(RUNTIME), "-o", str(runtime)])
        _runtime = runtime.read_bytes()
    else:
        runtime.write_bytes(_runtime)
    return runtime


_runtime: bytes | None = None  # the object file of runtime.c; None if this process has not compiled it yet


def linked(objects: Sequence[str], undefined: bool, base: int, library: Path) -> Path:
    """Link objects to the file `library`, and return its path. Raise BadSources if the linker fails.

    undefined: True to link UBSan, which reports undefined behaviour. base: the host address of the chip's word 0.
    """
    places = [f"-Wl,--defsym={name}={base + BYTES_A_WORD * address:#x}" for name, address in SYMBOLS.items()]
    places += [f"-Wl,--defsym={name}=0" for name in COPIED]
    replaced = [f"-Wl,--wrap={name}" for name in ENDING]
    checked = ["-fsanitize=undefined"] if undefined else []
    listed = library.with_suffix(".list")
    # These symbols are bound only when the library is loaded, so the linker keeps accesses to their addresses.
    listed.write_text(f"{{ {'; '.join(SYMBOLS)}; }};\n", encoding="utf-8")
    shared = ["-shared", f"-Wl,--dynamic-list={listed}", "-Wl,--no-relax", "-Wl,-z,defs", *replaced, *checked]
    _run([GCC, *shared, *places, *objects, "-o", str(library), "-lm"])
    return library


def _compile(command: Sequence[str], folders: Sequence[Path], aliases: Path) -> None:
    """Run gcc. If it does not find a header, make an alias for a file whose name differs only in case, and try again.

    Windows does not distinguish case in file names, so sources from Windows may have the wrong case.
    """
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
                hint = "; add it, or its folder to compile.include" if str(error).endswith(ABSENT) else ""
                raise BadSources(f"{error}{hint}") from None
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
    twice = TWICE.search(came.stderr)
    if twice:
        raise BadSources(f"{twice[1]} and {twice[3]} define {twice[2]!r}; leave one of them out")
    last = (came.stderr.strip().splitlines() or ["nothing"])[-1]
    raise BadSources(f"gcc cannot compile the sources; it says: {last}")
