"""Tests with the hard build of the core, which stops at the first fault.

    python -m tests.hard [--short] [PYTEST OPTIONS]

    make core HARD=1 --> build/hard --> pytest, in a process with the sanitizers loaded and a small stack

--short: builds the kernel and the wires only, and runs their tests. Without paths: the tests of what is
compiled. Address sanitizer watches the heap: of greenlets, which copy their stacks, it cannot watch those. Python's
objects are allocated one by one (PYTHONMALLOC), so that it sees each. Leaks are not looked for, since Python keeps
objects until it ends.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path

from periph_sim import form
from periph_sim.form import build

ROOT = Path(__file__).parents[1]
STACK = 2 << 20  # bytes; a usual one has 8 MB
SHORT_MODULES = ("core",)
SHORT_TESTS = ("tests/core", "tests/form/test_none.py", "tests/form/test_linked.py")
LONG_TESTS = (
    "tests/core",
    "tests/f28335",
    "tests/c28x",
    "tests/processor",
    "tests/scene",
    "tests/replay",
    "tests/form/test_none.py",
)


def environment() -> dict[str, str]:
    """Variables of a process that can load a library with the sanitizers in it. NoBuild without a sanitizer."""
    command = [*build.compiler().split(), "-print-file-name=libasan.so"]
    library = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    if not Path(library).is_file():
        raise build.NoBuild("the C compiler has no address sanitizer (libasan.so); install gcc's libasan")
    return {
        **os.environ,
        form.VARIABLE: form.HARD,
        "LD_PRELOAD": library,
        "PYTHONMALLOC": "malloc",
        "ASAN_OPTIONS": "detect_leaks=0:detect_stack_use_after_return=0:allocator_may_return_null=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    }


def small_stack() -> None:
    resource.setrlimit(resource.RLIMIT_STACK, (STACK, STACK))


def run_hard(command: list[str], variables: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """A command of this Python in such a process, with what it wrote."""
    return subprocess.run(
        [sys.executable, *command],
        cwd=ROOT,
        env={**environment(), **(variables or {})},
        preexec_fn=small_stack,
        capture_output=True,
        text=True,
        check=False,
    )


def main(options: list[str]) -> int:
    short = "--short" in options
    status = build.main(["--hard", *(SHORT_MODULES if short else ())])
    if status:
        return status
    others = [one for one in options if one != "--short"]
    paths = [] if any(one.startswith("tests") for one in others) else SHORT_TESTS if short else LONG_TESTS
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        *(["-m", "not long"] * short),
        *others,
        *paths,
    ]
    return subprocess.run(command, cwd=ROOT, env=environment(), preexec_fn=small_stack, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
